# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The Ruler's ROS node: one thread owns it, and requests of other threads wait for that."""

from __future__ import annotations

import contextlib
import os
import queue
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future
from concurrent.futures import TimeoutError as NoAnswerError
from contextlib import AbstractContextManager
from types import MappingProxyType
from typing import TypeVar

from smarttestudo.adapters.ros import open_robot
from smarttestudo.domain.errors import RosError, TestudoError
from smarttestudo.domain.parameter import ParameterValue, Refusals, Values
from smarttestudo.domain.robot import DataPathKind, Robot
from smarttestudo.use_cases.live.visible_topics import visible_topics
from smarttestudo.use_cases.ruler.robot_watch import RobotWatch, SeenRobot


def ruler_node() -> AbstractContextManager[Robot]:
    """A node that publishes nothing of its own; entering it raises ``TestudoError`` where ROS is missing.

    It takes a few messages a second, so it goes without librcl's path and its self-test.
    """
    return open_robot(name=f"testudo_ruler_{os.getpid()}", data_path=DataPathKind.RCLPY)


_WAIT_S = 0.05
_PATIENCE_S = 15.0
_BEGIN_AGAIN_S = 5.0
_END_WITHIN_S = 3.0
# What was asked for on leaving is sent, and mostly answered, within this.
_FAREWELL_S = 0.3
_Answer = TypeVar("_Answer")
_Order = Callable[[Robot], None]
_STARTING = "the Ruler is still joining the ROS graph"
_LEFT = "the Ruler has left the ROS graph"


class RobotLink:
    """Hears all SmartTestudo nodes and talks to them, from the first ``begin`` on; threads may call at once.

    ``news`` is called on the thread of the node with the robots of which a status came, and once it is there.
    """

    def __init__(self, open_node: Callable[[], AbstractContextManager[Robot]]) -> None:
        self.news: Callable[[Sequence[SeenRobot]], None] = _nobody
        self._open_node = open_node
        self._orders: queue.SimpleQueue[_Order] = queue.SimpleQueue()
        self._wanted_hz: Mapping[str, float] = MappingProxyType({})
        self._seen: Mapping[str, SeenRobot] = MappingProxyType({})
        self._problem: str | None = _STARTING
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
        """The robots by node."""
        return self._seen

    @property
    def is_up(self) -> bool:
        """Whether the node is there."""
        return self._is_up.is_set()

    def begin(self) -> None:
        """Join the graph, if that was not done or did not work some time ago."""
        with self._lock:
            is_running = self._thread is not None and self._thread.is_alive()
            now_s = time.monotonic()
            if is_running or self._is_closing.is_set() or now_s < self._began_s:
                return
            self._began_s = now_s + _BEGIN_AGAIN_S
            self._thread = threading.Thread(target=self._run, name="robots", daemon=True)
            self._thread.start()

    def close(self) -> None:
        """Leave the graph; for good."""
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

        def order(robot: Robot, answer: Future[Values]) -> None:
            robot.remote_parameters.get(node, names, lambda values: _settle(answer, values))

        return self._ask(order)

    def set(self, node: str, values: Mapping[str, ParameterValue]) -> Refusals:
        """Set parameters of a robot; the reasons of those that it refused. Raises ``RosError``."""

        def order(robot: Robot, answer: Future[Refusals]) -> None:
            robot.remote_parameters.set(node, values, lambda refused: _settle(answer, refused))

        return self._ask(order)

    def topics(self) -> Mapping[str, str]:
        """The types of what the robots' own nodes publish. Raises ``RosError``."""

        def order(robot: Robot, answer: Future[Mapping[str, str]]) -> None:
            found = visible_topics(robot).items()
            _settle(answer, {topic: publishers[0].type_name for topic, publishers in found})

        return self._ask(order)

    def _ask(self, order: Callable[[Robot, Future[_Answer]], None]) -> _Answer:
        answer: Future[_Answer] = Future()
        self._require_up()

        def taken(robot: Robot) -> None:
            try:
                order(robot, answer)
            except TestudoError as error:
                _settle(answer, error)

        self._orders.put(taken)
        try:
            return answer.result(_PATIENCE_S)
        except NoAnswerError as error:
            raise RosError("the ROS graph does not answer", remedy="try again") from error

    def _require_up(self) -> None:
        self.begin()
        if not self._is_up.wait(_PATIENCE_S if self._problem == _STARTING else 0):
            raise RosError(self._problem or _STARTING)

    def _run(self) -> None:
        try:
            with self._open_node() as robot:
                watch = RobotWatch(robot, time.monotonic)
                self._problem = None
                self._is_up.set()
                self.news(())
                self._serve(robot, watch)
        except TestudoError as error:
            self._problem = f"{error.cause}; {error.remedy}" if error.remedy else error.cause
        finally:
            self._is_up.clear()
            self._problem = self._problem or _LEFT

    def _serve(self, robot: Robot, watch: RobotWatch) -> None:
        while not self._is_closing.is_set():
            self._obey(robot)
            watch.want(self._wanted_hz)
            robot.wait(None, _WAIT_S)
            news = watch.look()
            if news or len(watch.seen) < len(self._seen):
                self._seen = MappingProxyType(dict(watch.seen))
            if news:
                self.news(news)
        watch.want({})
        end_s = time.monotonic() + _FAREWELL_S
        while time.monotonic() < end_s:
            robot.wait(None, _WAIT_S)

    def _obey(self, robot: Robot) -> None:
        with contextlib.suppress(queue.Empty):
            while True:
                self._orders.get_nowait()(robot)


def _settle(answer: Future[_Answer], result: _Answer | TestudoError) -> None:
    if answer.done():
        return
    if isinstance(result, TestudoError):
        answer.set_exception(result)
    else:
        answer.set_result(result)


def _nobody(_news: Sequence[SeenRobot]) -> None:
    """Nobody wants to know."""
