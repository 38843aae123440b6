# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Waiting for robots, and asking one, on the command line."""

from __future__ import annotations

import argparse
import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager
from functools import partial
from typing import TYPE_CHECKING, TypeVar

from smarttestudo.cli.link_options import connect_options, warn
from smarttestudo.cli.terminal import stop_signals
from smarttestudo.domain.errors import RosError, TestudoError, UsageError
from smarttestudo.domain.parameter import ParameterValue, Refusals, SilentNodeError, Values

if TYPE_CHECKING:
    from smarttestudo.domain.remote_robots import RemoteRobots, Topics
    from smarttestudo.domain.status import RuntimeStatus

_Answer = TypeVar("_Answer")

WAIT_S = 0.1
_HEARD_WITHIN_S = 10.0
_SETTLED_S = 0.5
"""All are heard once no other was found for so long: discovery finds one after the other."""
_NAMED = 8
STATUS_WITHIN_S = 5.0
"""How long a further status is waited for; one comes each second."""


def add_robot(parser: argparse.ArgumentParser) -> None:
    """Add ``--robot``, where several robots may be heard."""
    parser.add_argument(
        "--robot", metavar="NAME", help="with --connect: which robot, where several are heard there"
    )


def wait_for_all(robots: RemoteRobots, stopped: Callable[[], bool], timeout_s: float) -> None:
    """Wait until each robot that is there was heard. Raises ``RosError`` where none was in ``timeout_s``."""
    end_s = time.monotonic() + timeout_s
    settled_s, heard = time.monotonic() + _SETTLED_S, 0
    while time.monotonic() < min(end_s, settled_s) and not stopped():
        robots.wait(WAIT_S)
        if not robots.has_heard_all or len(robots.heard) != heard:
            settled_s, heard = time.monotonic() + _SETTLED_S, len(robots.heard)
    if not robots.heard:
        cause = "no readable status was received" if robots.unreadable else "no status was received"
        problem = f" ({robots.problem})" if robots.problem else ""
        raise RosError(f"{cause} within {timeout_s:g} s{problem}", place=robots.place, remedy=robots.remedy)


def topics_of_robot(robots: RemoteRobots, name: str | None, stopped: Callable[[], bool]) -> Topics:
    """The types of what the own nodes of a robot publish. Raises ``TestudoError``.

    ``name`` is that on its link, or its id; it may be left out where there is one robot.
    """
    wait_for_all(robots, stopped, _HEARD_WITHIN_S)
    return _answer(robots, stopped, partial(robots.topics, _chosen(robots, name)))


def _answer(
    robots: RemoteRobots,
    stopped: Callable[[], bool],
    ask: Callable[[Callable[[_Answer | TestudoError], None]], None],
) -> _Answer:
    """The answer to what ``ask`` asks, once it came. Raises ``TestudoError``."""
    answers: list[_Answer | TestudoError] = []
    ask(answers.append)
    while not answers:
        if stopped():
            raise RosError("stopped before the robot answered", place=robots.place)
        robots.wait(WAIT_S)
    if isinstance(answers[0], TestudoError):
        raise answers[0]
    return answers[0]


class ChosenRobot:
    """The robot that a command line names, on its graph or over a link, with its parameters.

    ``get`` and ``set`` wait for the answer. Raises ``RosError``.
    """

    def __init__(self, robots: RemoteRobots, robot_id: str, stopped: Callable[[], bool]) -> None:
        self.robot_id = robot_id
        self.stopped = stopped
        self._robots = robots

    def status(self) -> RuntimeStatus:
        """Its last status. Raises ``RosError`` once it is known to be gone."""
        heard = self._robots.heard.get(self.robot_id)
        if heard is None or not heard.is_present:
            raise RosError("the robot has left", place=self.robot_id, remedy=self._robots.remedy)
        return heard.status

    def next_status(self) -> RuntimeStatus:
        """The status after the last one, which who comes late is told; that one where no other comes."""
        before, end_s = self.status(), time.monotonic() + STATUS_WITHIN_S
        while self.status().stamp_ns == before.stamp_ns and time.monotonic() < end_s and not self.stopped():
            self.wait()
        return self.status()

    def wait(self) -> None:
        """Receive what comes, for a moment."""
        self._robots.wait(WAIT_S)

    def get(self, node: str, names: Sequence[str]) -> Values:
        """The values of parameters; asked again once, since discovery may bring services after statuses."""
        try:
            return _answer(self._robots, self.stopped, partial(self._robots.get, node, names))
        except SilentNodeError:
            return _answer(self._robots, self.stopped, partial(self._robots.get, node, names))

    def set(self, node: str, values: Mapping[str, ParameterValue]) -> Refusals:
        """Set parameters; the reasons of those that were refused."""
        return _answer(self._robots, self.stopped, partial(self._robots.set, node, values))


def add_any_robot(parser: argparse.ArgumentParser) -> None:
    """Add ``--robot`` for robots of a graph and over a link."""
    parser.add_argument(
        "--robot",
        dest="robot_name",
        metavar="NAME",
        help="which robot or node, where several are heard, as testudo top calls it",
    )


def open_robots(arguments: argparse.Namespace, node: str) -> AbstractContextManager[RemoteRobots]:
    """The robots at ``--connect``, else those of the graph, where ours is ``node``. Raises ``RosError``."""
    from smarttestudo.link.zenoh import open_link_robots  # noqa: PLC0415  one of both is not needed
    from smarttestudo.robot.ros import open_graph_robots  # noqa: PLC0415

    options = connect_options(arguments)
    return open_graph_robots(node) if options is None else open_link_robots(options, warn)


@contextmanager
def open_chosen_robot(arguments: argparse.Namespace, node: str) -> Iterator[ChosenRobot]:
    """The robot of ``--robot`` at ``--connect``, else on the graph, once it was heard; ours is ``node``.

    Raises ``UsageError`` where several could be meant, ``RosError`` where none is heard in ``--timeout``.
    """
    with stop_signals() as stopped, open_robots(arguments, node) as robots:
        wait_for_all(robots, stopped, arguments.timeout)
        yield ChosenRobot(robots, _chosen(robots, arguments.robot_name), stopped)


def _chosen(robots: RemoteRobots, name: str | None) -> str:
    present = {robot_id: one.status for robot_id, one in robots.heard.items() if one.is_present}
    names_of = {robot_id: (robot_id, status.robot, status.node) for robot_id, status in present.items()}
    fitting = [robot_id for robot_id, names in names_of.items() if name is None or name in names]
    if len(fitting) == 1:
        return fitting[0]
    times = Counter(status.robot for status in present.values())
    # Several nodes may have one name on the link, or none; then their ids tell them apart.
    labels = sorted(
        status.robot if status.robot and times[status.robot] == 1 else robot_id
        for robot_id, status in present.items()
    )
    names = ", ".join(labels[:_NAMED])
    if fitting:
        cause, remedy = f"several robots are heard: {names}", "name one with --robot"
    elif present:
        cause, remedy = f"there is no robot {name!r}, but {names}", "name one of these with --robot"
    else:
        cause, remedy = "the robot has left", robots.remedy
    raise UsageError(cause, place=robots.place, remedy=remedy)
