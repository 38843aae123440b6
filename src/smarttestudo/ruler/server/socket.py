# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Messages of the server to open pages, and what they may request."""

from __future__ import annotations

import asyncio
import contextlib
import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import msgspec
from starlette.websockets import WebSocket, WebSocketDisconnect

from smarttestudo import __version__
from smarttestudo.ruler.answer_json import answer_json
from smarttestudo.ruler.robots.view import Live, RobotSummary
from smarttestudo.ruler.server.permission import Permission, noted_permission

PROTOCOL_VERSION = 2
MAX_UPDATE_HZ = 20.0
_MAX_ASKED_BYTES = 10_000
# A page is told a little early rather than not at all: statuses come when they come.
_EARLY = 0.75


class Hello(msgspec.Struct, frozen=True, kw_only=True, tag_field="kind", tag="hello"):
    """The first message on ``/ws``; a page that knows another protocol asks to be reloaded.

    ``only_watches`` is whether the page may change neither files nor robots.
    """

    version: str
    only_watches: bool
    protocol: int = PROTOCOL_VERSION


class Progress(msgspec.Struct, frozen=True, kw_only=True, tag_field="kind", tag="progress"):
    """How far the work ``run`` is, 0 … 1."""

    run: str
    share: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Robots:
    """The robots, when something changes and every two seconds.

    ``problem`` is why ROS cannot be reached, null if it can.
    """

    kind: Literal["robots"] = "robots"
    problem: str | None
    robots: tuple[RobotSummary, ...]


Push = Hello | Progress | Robots | Live
"""What the server sends without a request."""


class Watch(msgspec.Struct, frozen=True, kw_only=True, tag_field="kind", tag="watch"):
    """The page asks for ``Live`` of one robot; null ends that. At most 20 a second."""

    node: str | None
    update_hz: float = 5.0


class OpenPage:
    """A page with what is still to be sent to it: of each kind only the newest, however slow it reads."""

    def __init__(self, socket: WebSocket) -> None:
        self.watched: Watch = Watch(node=None)
        self._socket = socket
        self._untold: dict[str, str] = {}
        self._has_some = asyncio.Event()
        self._live_due_s = -math.inf

    @property
    def update_hz(self) -> float:
        """How many updates a second it wants of the robot that it watches."""
        return min(max(self.watched.update_hz, 1.0), MAX_UPDATE_HZ)

    def tell(self, kind: str, text: str) -> None:
        """Send ``text`` as soon as the page takes it, in the place of what waits of that kind."""
        self._untold[kind] = text
        self._has_some.set()

    def may_tell_live(self) -> bool:
        """Whether the page wants another update by now; asked once for each that there is."""
        now_s, period_s = time.monotonic(), 1 / self.update_hz
        if now_s < self._live_due_s - _EARLY * period_s:
            return False
        self._live_due_s = max(self._live_due_s, now_s - period_s) + period_s
        return True

    async def keep_telling(self) -> None:
        """Until the page goes, or this is cancelled."""
        while True:
            await self._has_some.wait()
            self._has_some.clear()
            while self._untold:
                kind = next(iter(self._untold))
                await self._socket.send_text(self._untold.pop(kind))

    async def next_asked(self) -> Watch | None:
        """The next request of the page; ``None`` for what is not understood.

        Raises ``WebSocketDisconnect`` once the page was closed.
        """
        message = await self._socket.receive()
        if message["type"] == "websocket.disconnect":
            raise WebSocketDisconnect
        text = message.get("text")
        if text is None or len(text) > _MAX_ASKED_BYTES:
            return None
        with contextlib.suppress(msgspec.DecodeError, UnicodeError, RecursionError):
            return msgspec.json.decode(text, type=Watch)
        return None


class Listeners:
    """The pages that are open now; ``changed`` is called when one comes, goes or watches something else."""

    def __init__(self) -> None:
        self.changed: Callable[[], None] = lambda: None
        self.pages: set[OpenPage] = set()

    async def serve(self, socket: WebSocket) -> None:
        """Greet a page, and keep it until it goes."""
        await socket.accept()
        page = OpenPage(socket)
        only_watches = noted_permission(socket.scope) is Permission.WATCH
        page.tell("hello", encoded(Hello(version=__version__, only_watches=only_watches)))
        telling = asyncio.ensure_future(page.keep_telling())
        self.pages.add(page)
        self.changed()
        try:
            while True:
                asked = await page.next_asked()
                if asked is not None:
                    page.watched = asked
                    self.changed()
        except WebSocketDisconnect:
            return
        finally:
            self.pages.discard(page)
            telling.cancel()
            await asyncio.gather(telling, return_exceptions=True)
            self.changed()

    def tell(self, push: Progress | Robots) -> None:
        """Tell every open page."""
        kind = f"progress {push.run}" if isinstance(push, Progress) else "robots"
        text = encoded(push)
        for page in self.pages:
            page.tell(kind, text)


def encoded(push: Push) -> str:
    """A message as text."""
    return answer_json(push).decode()
