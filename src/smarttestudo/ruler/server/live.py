# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Messages of the server to open pages, and what they may request."""

from __future__ import annotations

import asyncio
import contextlib
import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from threading import Lock
from typing import Literal

import msgspec
from starlette.websockets import WebSocket, WebSocketDisconnect

from smarttestudo import __version__
from smarttestudo.ruler.job import Permission, answer_json
from smarttestudo.ruler.robots.link import RobotLink
from smarttestudo.ruler.robots.view import Live, RobotSummary, live_model, robot_summaries
from smarttestudo.ruler.robots.watch import SeenRobot
from smarttestudo.ruler.server.routes import noted_permission

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


_ROBOTS_PERIOD_S = 2.0
_POLLS_PER_PERIOD = 8


class LiveFeed:
    """Sends the pages of ``listeners`` what ``link`` receives; of several statuses at a time, the newest."""

    def __init__(self, link: RobotLink, listeners: Listeners) -> None:
        self._link = link
        self._listeners = listeners
        self._lock = Lock()
        self._news: dict[str, SeenRobot] = {}
        self._loop: asyncio.AbstractEventLoop | None = None
        self._told: object = None
        self._telling: asyncio.Task[None] | None = None
        link.news = self._heard
        listeners.changed = self._pages_changed

    async def close(self) -> None:
        """Tell nothing more, and leave the robots."""
        if self._telling is not None:
            self._telling.cancel()
        await asyncio.to_thread(self._link.close)

    def _pages_changed(self) -> None:
        """On the server's thread: a page came, went or watches something else."""
        self._loop = asyncio.get_running_loop()
        pages = self._listeners.pages
        if pages:
            self._link.begin()
        wanted_hz: dict[str, float] = {}
        for page in pages:
            if page.watched.node is not None:
                wanted_hz[page.watched.node] = max(
                    page.update_hz, wanted_hz.get(page.watched.node, page.update_hz)
                )
        self._link.watch(wanted_hz)
        if pages and (self._telling is None or self._telling.done()):
            self._telling = asyncio.ensure_future(self._keep_telling())
        elif pages:
            self._tell_robots()
        for seen in self._link.seen.values():
            self._tell_live(seen)

    def _heard(self, news: Sequence[SeenRobot]) -> None:
        """On the thread of the robots."""
        with self._lock:
            is_told = bool(self._news)
            self._news.update((one.status.robot_id, one) for one in news)
        loop = self._loop
        if loop is not None and not is_told:
            # A server that stops has no loop any more.
            with contextlib.suppress(RuntimeError):
                loop.call_soon_threadsafe(self._tell_news)

    def _tell_news(self) -> None:
        with self._lock:
            news, self._news = self._news, {}
        for seen in news.values():
            self._tell_live(seen)
        if self._summary(self._models()) != self._told:
            self._tell_robots()

    def _tell_live(self, seen: SeenRobot) -> None:
        watching = [page for page in self._listeners.pages if page.watched.node == seen.status.robot_id]
        due = [page for page in watching if page.may_tell_live()]
        if due:
            text = encoded(live_model(seen))
            for page in due:
                page.tell("live", text)

    def _models(self) -> tuple[RobotSummary, ...]:
        return robot_summaries(self._link.seen.values(), time.monotonic())

    def _tell_robots(self) -> None:
        models = self._models()
        self._told = self._summary(models)
        self._listeners.tell(Robots(problem=self._link.problem, robots=models))

    def _summary(self, models: Sequence[RobotSummary]) -> object:
        """Summary that is sent to pages at once when it changes."""
        return self._link.problem, [
            (
                *(one.node, one.is_heard, one.rules.sha256, one.rules.origin, one.topics),
                one.health and (one.health.level, one.is_heard and one.health.summary),
            )
            for one in models
        ]

    async def _keep_telling(self) -> None:
        """Every two seconds while there are pages, and soon after a robot was heard no more."""
        while self._listeners.pages:
            self._link.begin()
            self._tell_robots()
            heard = self._heard_robots()
            for _ in range(_POLLS_PER_PERIOD):
                await asyncio.sleep(_ROBOTS_PERIOD_S / _POLLS_PER_PERIOD)
                if self._heard_robots() != heard:
                    break

    def _heard_robots(self) -> list[str]:
        now_s = time.monotonic()
        return [one.status.robot_id for one in self._link.seen.values() if one.is_heard(now_s)]
