# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""HTTP servers of this process that keep the notices which they are sent."""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, HTTPServer


class Away(BaseHTTPRequestHandler):
    """A server that says 204 for each body, which it keeps."""

    def do_POST(self) -> None:
        body = self.rfile.read(int(self.headers["Content-Length"]))
        self.server.bodies.append(json.loads(body))  # type: ignore[attr-defined]
        self.send_response(self.server.status)  # type: ignore[attr-defined]
        self.end_headers()

    def log_message(self, *_: object) -> None:
        """Print nothing."""


@contextmanager
def served(port: int = 0, status: int = 204) -> Iterator[HTTPServer]:
    server = HTTPServer(("127.0.0.1", port), Away)
    server.bodies, server.status = [], status  # type: ignore[attr-defined]
    thread = threading.Thread(target=server.serve_forever, args=(0.01,), daemon=True)
    thread.start()
    try:
        yield server
    finally:
        server.shutdown()
        server.server_close()
        thread.join()


def ids(server: HTTPServer) -> list[object]:
    return [body["id"] for body in server.bodies]  # type: ignore[attr-defined]


def waited_for(server: HTTPServer, count: int) -> list[object]:
    end_s = time.monotonic() + 20
    while len(ids(server)) < count and time.monotonic() < end_s:
        time.sleep(0.02)
    return ids(server)
