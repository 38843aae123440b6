# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Real time that a simulated robot loses, because its machine slept or is too slow for it."""

from __future__ import annotations

from collections.abc import Callable

from smarttestudo.domain.robot import Robot
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.simulation.readings import TimedReading

_MOST_BEHIND_NS = NS_PER_S
_WARNING_NS = 10 * NS_PER_S


class LostTime:
    """Gives up time that is lost, so that what comes has the stamps of its time.

    ``skip`` has all that is to come happen so many ns later; ``why`` ends the warning.
    """

    def __init__(self, robot: Robot, skip: Callable[[int], None], why: str) -> None:
        self._robot = robot
        self._skip = skip
        self._why = why
        self._lost_ns = 0
        self._warned_ns: int | None = None

    def give_up(self, timed: TimedReading) -> None:
        """Compare the time of what comes next with that of the robot."""
        now_ns = self._robot.now_ns()
        behind_ns = now_ns - timed.time_ns
        if behind_ns <= _MOST_BEHIND_NS:
            return
        self._skip(behind_ns)
        self._lost_ns += behind_ns
        if self._warned_ns is None or now_ns - self._warned_ns >= _WARNING_NS:
            self._warned_ns = now_ns
            self._robot.log.warning(
                f"Lost {self._lost_ns / NS_PER_S:.1f} s of real time so far, in which the robot stood still: "
                f"{self._why}"
            )
