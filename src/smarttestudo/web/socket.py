# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the server tells open pages by itself."""

from __future__ import annotations

import contextlib

import msgspec
from starlette.websockets import WebSocket, WebSocketDisconnect

from smarttestudo import __version__
from smarttestudo.web.schemas import AnyPush, Hello


class Listeners:
    """The pages that are open now."""

    def __init__(self) -> None:
        self._open: set[WebSocket] = set()

    async def serve(self, socket: WebSocket) -> None:
        """Greet a page and keep it until it goes; what it says is not listened to."""
        await socket.accept()
        try:
            await _send(socket, Hello(version=__version__))
            self._open.add(socket)
            while True:
                await socket.receive_text()
        except (WebSocketDisconnect, KeyError):
            # A page that sends binary data has gone wrong: it is let go as well.
            return
        finally:
            self._open.discard(socket)

    async def tell(self, push: AnyPush) -> None:
        """Tell every open page."""
        for socket in tuple(self._open):
            with contextlib.suppress(WebSocketDisconnect, RuntimeError):
                await _send(socket, push)


async def _send(socket: WebSocket, push: AnyPush) -> None:
    await socket.send_text(msgspec.json.encode(push).decode())
