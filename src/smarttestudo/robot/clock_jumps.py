# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Jumps of a robot's clock, as where the network tells a machine the time that had none of its own."""

from __future__ import annotations

from smarttestudo.domain.robot import Instant, Robot
from smarttestudo.domain.units import NS_PER_MS, NS_PER_S

LEAST_NS = NS_PER_S // 20
"""A smaller jump counts as time that passed; a clock that is slewed runs by no more in so short a time."""
_PRECISE_NS = NS_PER_MS
_TRIES = 5


class ClockJumps:
    """Reads a robot's clock together with one that never jumps, and has its log say each jump.

    Simulated time goes as fast as it likes, so it never jumps.
    """

    __slots__ = ("_ahead_ns", "_clock_ns", "_robot", "_until_ns")

    def __init__(self, robot: Robot) -> None:
        self._robot = robot
        self._ahead_ns = 0
        """How far the clock was ahead of the steady one when it was followed last."""
        self._follow(self._read_precisely())

    def agrees(self, now_ns: int) -> bool:
        """Whether the clock shows so little more than when it was followed last that it did not jump far."""
        return self._clock_ns <= now_ns <= self._until_ns

    def read(self) -> Instant:
        """Now, on both clocks."""
        robot = self._robot
        now = Instant(robot.now_ns(), robot.steady_ns())
        if abs(now.clock_ns - now.steady_ns - self._ahead_ns) <= LEAST_NS or robot.is_time_simulated:
            return now
        return self._read_precisely()

    def follow(self, at: Instant) -> int:
        """How far the clock has jumped by then since the last call, back if negative; 0 if not far."""
        jumped_ns = self._follow(at)
        if abs(jumped_ns) <= LEAST_NS or self._robot.is_time_simulated:
            return 0
        log, by_s = self._robot.log, abs(jumped_ns) / NS_PER_S
        if jumped_ns > 0:
            log.warning(f"the clock jumped ahead by {by_s:.1f} s: rules and rates leave that out")
        else:
            log.warning(f"the clock was set back by {by_s:.1f} s: rules and rates go on from there")
        return jumped_ns

    def _follow(self, at: Instant) -> int:
        before_ns, self._ahead_ns = self._ahead_ns, at.clock_ns - at.steady_ns
        self._clock_ns, self._until_ns = at.clock_ns, at.clock_ns + LEAST_NS
        return self._ahead_ns - before_ns

    def _read_precisely(self) -> Instant:
        """Now, where what delays this process between the two clocks counts as no jump."""
        tries = []
        for _ in range(_TRIES):
            before_ns, clock_ns = self._robot.steady_ns(), self._robot.now_ns()
            tries.append((self._robot.steady_ns() - before_ns, Instant(clock_ns, before_ns)))
            if tries[-1][0] <= _PRECISE_NS:
                break
        return min(tries)[1]
