# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A connection that is reset again and again: what was missed, and nothing else, is kept."""

from __future__ import annotations

import itertools
import socket
import struct
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress

import pytest

from link.zenoh.ends import ODOM, Reader, free_endpoint, operator_end, robot_end, until
from smarttestudo.domain.link import MessageOrigin

pytestmark = pytest.mark.full
_RESET = struct.pack("ii", 1, 0)
RESETS = 2


class Wire:
    """Carries TCP connections to ``port``, until they are reset."""

    def __init__(self, server: socket.socket, port: int) -> None:
        self._server = server
        self._port = port
        self._sockets: list[socket.socket] = []
        threading.Thread(target=self._accept, daemon=True).start()

    def reset(self) -> None:
        """Cut what is connected; another connection may be made at once."""
        sockets, self._sockets = self._sockets, []
        for one in sockets:
            # The other end may have closed it already.
            with one, suppress(OSError):
                one.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, _RESET)
                one.shutdown(socket.SHUT_RDWR)

    def _accept(self) -> None:
        with suppress(OSError):
            while True:
                near, _ = self._server.accept()
                far = socket.create_connection(("127.0.0.1", self._port))
                self._sockets += [near, far]
                for source, sink in ((near, far), (far, near)):
                    threading.Thread(target=self._carry, args=(source, sink), daemon=True).start()

    @staticmethod
    def _carry(source: socket.socket, sink: socket.socket) -> None:
        with suppress(OSError):
            while data := source.recv(65_536):
                sink.sendall(data)


@contextmanager
def wire_to(endpoint: str) -> Iterator[tuple[str, Wire]]:
    """An endpoint from which all goes to ``endpoint``."""
    place = free_endpoint()
    with socket.create_server(("127.0.0.1", int(place.rpartition(":")[2]))) as server:
        wire = Wire(server, int(endpoint.rpartition(":")[2]))
        yield place, wire
        wire.reset()
        server.shutdown(socket.SHUT_RDWR)


def test_after_resets_each_message_was_received_missed_or_replaced_and_none_was_both() -> None:
    endpoint = free_endpoint()
    with (
        operator_end(endpoint) as operator,
        wire_to(endpoint) as (place, wire),
        robot_end(place, warn=lambda _: None) as robot,
    ):
        numbers = itertools.count(1)
        origin: MessageOrigin | None = None
        robot.keep_missed(lambda: origin)
        reader, publisher = Reader(operator), robot.advertise(ODOM)
        sent = list[bytes]()

        def publish() -> None:
            nonlocal origin
            number = next(numbers)
            origin = MessageOrigin(topic="/odom", stamp_ns=number)
            sent.append(number.to_bytes(4, "big"))
            publisher.publish(sent[-1])

        until(lambda: bool(reader.payloads()), publish)
        first = sent.index(reader.payloads()[0])
        for _ in range(RESETS):
            sessions = robot.state.sessions
            wire.reset()
            until(lambda: robot.state.sessions > sessions, publish)  # noqa: B023
            before = len(reader.payloads())
            until(lambda: len(reader.payloads()) > before + 3, publish)  # noqa: B023
        until(lambda: reader.payloads()[-1] == sent[-1])
        received, missed = reader.payloads(), list[bytes]()

        def is_known() -> bool:
            """Whether it is known of each message that was sent what became of it."""
            missed.extend(one.payload for one in robot.take_missed())
            counts = robot.counts().get("/odom")
            return counts is not None and counts.sent <= len(received) + len(missed)

        until(is_known)
        assert {*received} & {*missed} == set()
        assert len(received) == len({*received})
        assert {*received, *missed} <= {*sent[first:]}
        # As ever, a newer message takes the place of one that has not begun while the window is full.
        gave_way = {*sent[first:]} - {*received} - {*missed}
        assert len(gave_way) <= robot.counts()["/odom"].replaced
