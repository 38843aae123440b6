# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Jumps of a robot's clock, as where the network tells a machine the time that had none of its own."""

from __future__ import annotations

from smarttestudo.domain.robot import Robot
from smarttestudo.domain.units import NS_PER_S

LEAST_NS = NS_PER_S // 2
"""A smaller jump counts as time that passed."""


class ClockJumps:
    """Finds jumps by a clock that has none, and has the robot's log say them.

    Simulated time goes as fast as it likes, so it never jumps ahead.
    """

    __slots__ = ("_clock_ns", "_robot", "_steady_ns", "_until_ns")

    def __init__(self, robot: Robot) -> None:
        self._robot = robot
        self._compare()

    def agrees(self, now_ns: int) -> bool:
        """Whether the clock cannot have jumped far by ``now_ns``, as it was asked a moment ago."""
        return self._clock_ns <= now_ns <= self._until_ns

    def ahead_ns(self, now_ns: int) -> int:
        """How far the clock, which shows ``now_ns``, has jumped ahead since the last call; 0 if not far."""
        # What delays this process between two readings makes a jump seem less, never more.
        jumped_ns = now_ns - self._clock_ns - (self._robot.steady_ns() - self._steady_ns)
        was_set_back, log = now_ns < self._clock_ns, self._robot.log
        self._compare()
        if self._robot.is_time_simulated:
            return 0
        if jumped_ns > LEAST_NS:
            ahead_s = jumped_ns / NS_PER_S
            log.warning(f"the clock jumped ahead by {ahead_s:.1f} s: rules and rates leave that out")
            return jumped_ns
        if was_set_back and jumped_ns < -LEAST_NS:
            back_s = -jumped_ns / NS_PER_S
            log.warning(f"the clock was set back by {back_s:.1f} s: rules and rates go on from there")
        return 0

    def _compare(self) -> None:
        self._steady_ns = self._robot.steady_ns()
        self._clock_ns = self._robot.now_ns()
        self._until_ns = self._clock_ns + LEAST_NS
