# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The page's end of the web socket."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from websockets.sync.client import ClientConnection, connect

from ruler.ruler_server import TIMEOUT_S, Page

MESSAGES = 2000


class PageSocket:
    """What the server tells a page, message by message."""

    def __init__(self, connection: ClientConnection) -> None:
        self.connection = connection

    def next(self, kind: str, holds: Callable[[Any], bool] = lambda _: True) -> Any:
        """The next message of that kind for which ``holds``."""
        said: Any = None
        for _ in range(MESSAGES):
            message = json.loads(self.connection.recv(timeout=TIMEOUT_S))
            said = message if message["kind"] == kind else said
            if message["kind"] == kind and holds(message):
                return message
        raise AssertionError(f"not within {MESSAGES} messages; the last {kind}: {said}")

    def say(self, **message: object) -> None:
        self.connection.send(json.dumps(message))

    def watch(self, node: str | None, update_hz: float = 5.0) -> None:
        self.say(kind="watch", node=node, update_hz=update_hz)


@contextmanager
def open_socket(page: Page, *, origin: str | None = None) -> Iterator[PageSocket]:
    """An open page; of another site, with another ``origin``."""
    url = f"ws://127.0.0.1:{page.port}/ws"
    with connect(url, origin=origin or page.origin, proxy=None) as connection:  # type: ignore[call-overload]
        yield PageSocket(connection)
