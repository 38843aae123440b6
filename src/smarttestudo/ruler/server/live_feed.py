# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""From the thread of the ROS node to the pages that watch robots."""

from __future__ import annotations

import asyncio
import contextlib
import time
from collections.abc import Sequence
from threading import Lock

from smarttestudo.ruler.robots.link import RobotLink
from smarttestudo.ruler.robots.view import RobotSummary, live_model, robot_summaries
from smarttestudo.ruler.robots.watch import SeenRobot
from smarttestudo.ruler.server.socket import Listeners, Robots, encoded

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
                one.link and one.link.is_connected,
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
