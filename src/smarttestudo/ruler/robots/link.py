# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The robots that the Ruler hears: one thread owns them, and requests of other threads wait for that."""

from __future__ import annotations

import contextlib
import math
import queue
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future
from concurrent.futures import TimeoutError as NoAnswerError
from contextlib import AbstractContextManager
from types import MappingProxyType
from typing import TypeVar

from msgspec import Struct

from smarttestudo.domain.errors import RosError, TestudoError
from smarttestudo.domain.parameter import ParameterValue, Refusals, Values
from smarttestudo.domain.remote_robots import RemoteRobots
from smarttestudo.ruler.job import RequestError, job
from smarttestudo.ruler.robots.checks import (
    RobotChecks,
    RobotChecksAnswer,
    RobotChecksRequest,
)
from smarttestudo.ruler.robots.history import KEPT_S, RobotHistory, RobotHistoryAnswer
from smarttestudo.ruler.robots.known import KnownRobots
from smarttestudo.ruler.robots.view import RobotStartAnswer, robot_start
from smarttestudo.ruler.robots.watch import RobotWatch, RuleWords, SeenRobot, seen_robot

_WAIT_S = 0.05
_PATIENCE_S = 15.0
_BEGIN_AGAIN_S = 5.0
_END_WITHIN_S = 3.0
# What was asked for on leaving is sent, and mostly answered, within this.
_FAREWELL_S = 0.3
_KEEP_EVERY_S = 30.0
_Answer = TypeVar("_Answer")
_Order = Callable[[RemoteRobots], None]
OpenRobots = Callable[[], AbstractContextManager[RemoteRobots]]
"""Entering it raises ``TestudoError`` where no robot can be heard."""
_STARTING = "the Ruler is still looking for robots"
_LEFT = "the Ruler listens to robots no more"


class RobotRequest(Struct, frozen=True, kw_only=True):
    """A robot by its node."""

    node: str


class RobotRemoved(Struct, frozen=True, kw_only=True):
    """The robot that is known no more, until it is heard again."""

    node: str


class UnknownRobotError(RosError):
    """A robot without any status so far."""

    status = 404


class RobotLink:
    """Hears all robots and talks to them, from the first ``begin`` on; threads may call at once.

    ``news`` is called on their thread with the robots of which a status came, and once that begins.
    """

    def __init__(self, open_robots: OpenRobots, known: KnownRobots) -> None:
        self.news: Callable[[Sequence[SeenRobot]], None] = lambda *_: None
        self._open_robots = open_robots
        self._removed: queue.SimpleQueue[str] = queue.SimpleQueue()
        self._orders: queue.SimpleQueue[_Order] = queue.SimpleQueue()
        self._wanted_hz: Mapping[str, float] = MappingProxyType({})
        self._known = known
        self._seen: Mapping[str, SeenRobot] = MappingProxyType(
            {name: seen_robot(one, RuleWords()) for name, one in known.read().items()}
        )
        self._kept_s = -math.inf
        self._histories: dict[str, RobotHistory] = {}
        self._checks: dict[str, RobotChecks] = {}
        self._problem: str | None = _STARTING
        self._remedy = ""
        self._thread: threading.Thread | None = None
        self._lock = threading.Lock()
        self._is_closing = threading.Event()
        self._began_s = 0.0
        self._is_up = threading.Event()

    @property
    def problem(self) -> str | None:
        """Why no robot can be reached; ``None`` if one could be."""
        return self._problem

    @property
    def seen(self) -> Mapping[str, SeenRobot]:
        """The robots by their ids."""
        return self._seen

    def history(self, node: str) -> RobotHistoryAnswer:
        """The history of a robot within the last hour; nothing of one that never spoke."""
        return self._histories.get(node, RobotHistory()).answer(time.monotonic())

    def checks(self, request: RobotChecksRequest) -> RobotChecksAnswer:
        """The values that a robot's checks read, and when its rules held; nothing of one that never spoke."""
        return self._checks.get(request.node, RobotChecks()).answer(request, time.monotonic())

    def begin(self) -> None:
        """Listen, if that was not done or did not work some time ago."""
        with self._lock:
            is_running = self._thread is not None and self._thread.is_alive()
            now_s = time.monotonic()
            if is_running or self._is_closing.is_set() or now_s < self._began_s:
                return
            self._began_s = now_s + _BEGIN_AGAIN_S
            self._thread = threading.Thread(target=self._run, name="robots", daemon=True)
            self._thread.start()

    def close(self) -> None:
        """Listen no more; for good."""
        with self._lock:
            self._is_closing.set()
            thread = self._thread
        if thread is not None:
            thread.join(_END_WITHIN_S)

    def watch(self, wanted_hz: Mapping[str, float]) -> None:
        """Have these robots watched, with so many statuses a second, and no others."""
        self._wanted_hz = wanted_hz

    def get(self, node: str, names: Sequence[str]) -> Values:
        """Parameters of a robot. Raises ``RosError``."""

        def order(robots: RemoteRobots, answer: Future[Values]) -> None:
            robots.get(node, names, lambda values: _settle(answer, values))

        return self._ask(order)

    def set(self, node: str, values: Mapping[str, ParameterValue]) -> Refusals:
        """Set parameters of a robot; the reasons of those that it refused. Raises ``RosError``."""

        def order(robots: RemoteRobots, answer: Future[Refusals]) -> None:
            robots.set(node, values, lambda refused: _settle(answer, refused))

        return self._ask(order)

    def remove(self, node: str) -> None:
        """Know a robot no more that is silent. Raises ``RequestError`` for one that is heard."""
        self.require_known(node)
        if self._seen[node].is_heard(time.monotonic()):
            raise RequestError(f"{node} is heard now", 409, remedy="end its testudo run first")
        self._removed.put(node)
        with self._lock:
            if self._thread is None or not self._thread.is_alive():
                self._remove()

    def _remove(self, watch: RobotWatch | None = None) -> None:
        """Forget what is to be removed, and keep those that are left."""
        with contextlib.suppress(queue.Empty):
            while True:
                node = self._removed.get_nowait()
                if watch is not None:
                    watch.remove(node)
                self._seen = MappingProxyType({name: one for name, one in self._seen.items() if name != node})
                self._kept_s = -math.inf
                self.news(())
        self._keep()

    def _keep(self) -> None:
        """Write the robots down, from time to time."""
        now_s = time.monotonic()
        if now_s < self._kept_s + _KEEP_EVERY_S:
            return
        self._kept_s = now_s
        # They are known in memory until the disk takes them.
        with contextlib.suppress(OSError, TestudoError):
            self._known.write(self._seen.values())

    def require_known(self, node: str) -> None:
        """Raise ``UnknownRobotError`` for a robot that never spoke, of which nothing is asked."""
        if node not in self._seen:
            raise UnknownRobotError(f"no status of {node} was received", remedy=self._problem or self._remedy)

    def topics(self) -> Mapping[str, str]:
        """The types of what robots publish, as far as they can be known now."""
        if not self._is_up.is_set():
            return {}
        relayed = {
            topic: status.type_name
            for seen in self._seen.values()
            for topic, status in seen.status.topics.items()
            if status.type_name is not None
        }
        try:
            return {**relayed, **self._published()}
        except TestudoError:
            # Words to suggest come from the files, too.
            return relayed

    def _published(self) -> Mapping[str, str]:

        def order(robots: RemoteRobots, answer: Future[Mapping[str, str]]) -> None:
            robots.topics(None, lambda topics: _settle(answer, topics))

        return self._ask(order)

    def _ask(self, order: Callable[[RemoteRobots, Future[_Answer]], None]) -> _Answer:
        answer: Future[_Answer] = Future()
        self._require_up()

        def taken(robots: RemoteRobots) -> None:
            try:
                order(robots, answer)
            except TestudoError as error:
                _settle(answer, error)

        self._orders.put(taken)
        try:
            return answer.result(_PATIENCE_S)
        except NoAnswerError as error:
            raise RosError("the robots do not answer", remedy="try again") from error

    def _require_up(self) -> None:
        self.begin()
        if not self._is_up.wait(_PATIENCE_S if self._problem == _STARTING else 0):
            raise RosError(self._problem or _STARTING)

    def _run(self) -> None:
        try:
            with self._open_robots() as robots:
                watch = RobotWatch(robots, time.monotonic, self._seen)
                self._problem = None
                self._remedy = robots.remedy
                self._is_up.set()
                self.news(())
                self._serve(robots, watch)
        except TestudoError as error:
            self._problem = f"{error.cause}; {error.remedy}" if error.remedy else error.cause
        finally:
            self._is_up.clear()
            self._problem = self._problem or _LEFT

    def _serve(self, robots: RemoteRobots, watch: RobotWatch) -> None:
        while not self._is_closing.is_set():
            self._obey(robots)
            watch.want(self._wanted_hz)
            self._problem = robots.problem
            robots.wait(_WAIT_S)
            news = watch.poll()
            for one in news:
                self._histories.setdefault(one.status.robot_id, RobotHistory()).add(one)
                self._checks.setdefault(one.status.robot_id, RobotChecks()).add(one)
            oldest_s = time.monotonic() - KEPT_S
            for node in [name for name in self._histories if not _is_within(watch.seen.get(name), oldest_s)]:
                del self._histories[node], self._checks[node]
            if news or len(watch.seen) < len(self._seen):
                # A robot that is new is written down at once.
                self._kept_s = self._kept_s if watch.seen.keys() <= self._seen.keys() else -math.inf
                self._seen = MappingProxyType(dict(watch.seen))
            self._remove(watch)
            if news:
                self.news(news)
        self._kept_s = -math.inf
        self._keep()
        watch.want({})
        end_s = time.monotonic() + _FAREWELL_S
        while time.monotonic() < end_s:
            robots.wait(_WAIT_S)

    def _obey(self, robots: RemoteRobots) -> None:
        with contextlib.suppress(queue.Empty):
            while True:
                self._orders.get_nowait()(robots)


def _is_within(seen: SeenRobot | None, oldest_s: float) -> bool:
    return seen is not None and seen.heard_s >= oldest_s


def _settle(answer: Future[_Answer], result: _Answer | TestudoError) -> None:
    if answer.done():
        return
    if isinstance(result, TestudoError):
        answer.set_exception(result)
    else:
        answer.set_result(result)


@job("POST /api/robot/history", reads=True)
def robot_history(request: RobotRequest, robots: RobotLink) -> RobotHistoryAnswer:
    """The last hour of a robot. Raises ``UnknownRobotError``."""
    robots.require_known(request.node)
    return robots.history(request.node)


@job("POST /api/robot/checks", reads=True)
def robot_checks(request: RobotChecksRequest, robots: RobotLink) -> RobotChecksAnswer:
    """The checks and rules of a robot over the last minutes. Raises ``UnknownRobotError``."""
    robots.require_known(request.node)
    return robots.checks(request)


@job("POST /api/robot/start", reads=True)
def start_from_robot(request: RobotRequest, robots: RobotLink) -> RobotStartAnswer:
    """A project from what a robot relays. Raises ``UnknownRobotError``."""
    robots.require_known(request.node)
    return robot_start(robots.seen[request.node].status)


@job("POST /api/robot/remove")
def remove_robot(request: RobotRequest, robots: RobotLink) -> RobotRemoved:
    """Remove a robot that is silent from the list. Raises ``UnknownRobotError`` and ``RequestError``."""
    robots.remove(request.node)
    return RobotRemoved(node=request.node)
