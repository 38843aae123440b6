# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A TCP connection that takes its time: what is sent arrives so much later, in either direction."""

from __future__ import annotations

import queue
import socket
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

from link.zenoh.ends import free_endpoint

_READ_BYTES = 65_536


@contextmanager
def slow_wire(endpoint: str, delay_s: float) -> Iterator[str]:
    """An endpoint from which all goes to ``endpoint`` and back, each way ``delay_s`` later."""
    place = free_endpoint()
    with socket.create_server(("127.0.0.1", _port(place))) as server:
        threading.Thread(target=_accept, args=(server, _port(endpoint), delay_s), daemon=True).start()
        yield place
        server.shutdown(socket.SHUT_RDWR)


def _port(endpoint: str) -> int:
    return int(endpoint.rpartition(":")[2])


def _accept(server: socket.socket, port: int, delay_s: float) -> None:
    while True:
        try:
            near, _ = server.accept()
        except OSError:
            return
        try:
            far = socket.create_connection(("127.0.0.1", port))
        except OSError:
            near.close()
            continue
        for source, sink in ((near, far), (far, near)):
            _carry(source, sink, delay_s)


def _carry(source: socket.socket, sink: socket.socket, delay_s: float) -> None:
    waiting: queue.SimpleQueue[tuple[float, bytes]] = queue.SimpleQueue()

    def read() -> None:
        data = b"first"
        while data:
            try:
                data = source.recv(_READ_BYTES)
            except OSError:
                data = b""
            waiting.put((time.monotonic() + delay_s, data))

    def write() -> None:
        data = b"first"
        with sink:
            while data:
                due_s, data = waiting.get()
                time.sleep(max(0.0, due_s - time.monotonic()))
                try:
                    sink.sendall(data)
                except OSError:
                    return

    for work in (read, write):
        threading.Thread(target=work, daemon=True).start()
