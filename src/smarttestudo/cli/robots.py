# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Waiting for robots, and asking one, on the command line."""

from __future__ import annotations

import argparse
import time
from collections import Counter
from collections.abc import Callable
from typing import TYPE_CHECKING

from smarttestudo.domain.errors import RosError, TestudoError, UsageError

if TYPE_CHECKING:
    from smarttestudo.domain.remote_robots import RemoteRobots, Topics

WAIT_S = 0.1
_HEARD_WITHIN_S = 10.0
_SETTLED_S = 0.5
"""All are heard once no other was found for so long: discovery finds one after the other."""
_NAMED = 8


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
    answers: list[Topics | TestudoError] = []
    robots.topics(_chosen(robots, name), answers.append)
    while not answers:
        if stopped():
            raise RosError("stopped before the robot answered", place=robots.place)
        robots.wait(WAIT_S)
    if isinstance(answers[0], TestudoError):
        raise answers[0]
    return answers[0]


def _chosen(robots: RemoteRobots, name: str | None) -> str:
    present = {robot_id: one.status.robot for robot_id, one in robots.heard.items() if one.is_present}
    fitting = [robot_id for robot_id, robot in present.items() if name in (None, robot_id, robot)]
    if len(fitting) == 1:
        return fitting[0]
    times = Counter(present.values())
    # Several nodes may have one name on the link; then their ids tell them apart.
    labels = sorted(robot if times[robot] == 1 else robot_id for robot_id, robot in present.items())
    names = ", ".join(labels[:_NAMED])
    if fitting:
        cause, remedy = f"several robots are heard: {names}", "name one with --robot"
    elif present:
        cause, remedy = f"there is no robot {name!r}, but {names}", "name one of these with --robot"
    else:
        cause, remedy = "the robot has left", robots.remedy
    raise UsageError(cause, place=robots.place, remedy=remedy)
