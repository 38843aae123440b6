# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Numbered datagrams through a link, each with the time it took."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from thin_link.network_namespaces import OPERATOR_ADDRESS, OPERATOR_ADDRESS_V6, ThinLink, in_namespace

HEADERS_BYTES = {OPERATOR_ADDRESS: 28, OPERATOR_ADDRESS_V6: 48}
"""Of IP and UDP, by the address that is sent to."""
_RECEIVE = """
import json, select, socket, sys, time
listener = socket.socket(socket.AF_INET6, socket.SOCK_DGRAM)
listener.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_V6ONLY, 0)
listener.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4_000_000)
listener.bind(("::", 5001))
print("listening", flush=True)
arrived = []
while True:
    ready, _, _ = select.select([listener, sys.stdin], [], [])
    if listener in ready:
        data, (host, port, *_) = listener.recvfrom(65536)
        arrived.append((int.from_bytes(data[:8], "little"), time.monotonic_ns(), host, port))
    elif sys.stdin in ready:
        break
print(json.dumps(arrived), flush=True)
"""
_SEND = """
import json, socket, sys, time
address, size, period, count, first = sys.argv[1], *map(float, sys.argv[2:])
family = socket.AF_INET6 if ":" in address else socket.AF_INET
sender = socket.socket(family, socket.SOCK_DGRAM)
sender.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 4_000_000)
start, sent = time.monotonic(), []
for number in range(int(first), int(first + count)):
    time.sleep(max(0, start + (number - first) * period - time.monotonic()))
    sent.append(time.monotonic_ns())
    try:
        sender.sendto(number.to_bytes(8, "little") + bytes(int(size) - 8), (address, 5001))
    except OSError as error:
        # Larger than the device takes.
        assert error.errno == 90, error
print(json.dumps(sent))
"""

_SEND_ON_REQUEST = """
import socket, sys
sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
for number, _ in enumerate(sys.stdin):
    sender.sendto(number.to_bytes(8, "little"), (sys.argv[1], 5001))
    print("sent", flush=True)
"""


@dataclass(frozen=True, kw_only=True)
class Arrived:
    """A datagram that arrived, when, and from where."""

    number: int
    at_ns: int
    host: str
    port: int


def send(
    link: ThinLink,
    count: int,
    *,
    size_bytes: int = 1_000,
    period_s: float = 0.005,
    to: str = OPERATOR_ADDRESS,
    first: int = 0,
) -> list[int]:
    """Send datagrams with payloads of so many bytes from the robot; when each was sent."""
    arguments = (to, str(size_bytes), str(period_s), str(count), str(first))
    command = in_namespace(link.robot, [sys.executable, "-c", _SEND, *arguments])
    said = subprocess.run(command, capture_output=True, text=True, check=True)
    sent: list[int] = json.loads(said.stdout)
    return sent


@contextmanager
def sender(link: ThinLink) -> Iterator[Callable[[], None]]:
    """A socket of the robot that sends the next datagram whenever it is asked to."""
    command = in_namespace(link.robot, [sys.executable, "-c", _SEND_ON_REQUEST, OPERATOR_ADDRESS])
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdin is not None
        assert process.stdout is not None
        stdin, stdout = process.stdin, process.stdout

        def send_next() -> None:
            stdin.write("\n")
            stdin.flush()
            stdout.readline()

        yield send_next


@contextmanager
def receiver(link: ThinLink) -> Iterator[Callable[[], list[Arrived]]]:
    """A process of the operator that receives datagrams until it is asked for them."""
    command = in_namespace(link.operator, [sys.executable, "-c", _RECEIVE])
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdin is not None
        assert process.stdout is not None
        stdin, stdout = process.stdin, process.stdout
        stdout.readline()

        def arrived() -> list[Arrived]:
            stdin.write("\n")
            stdin.flush()
            return [
                Arrived(number=number, at_ns=at_ns, host=host, port=port)
                for number, at_ns, host, port in json.loads(stdout.readline())
            ]

        try:
            yield arrived
        finally:
            process.terminate()
