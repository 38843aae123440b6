# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Jumps of a robot's clock, as where the network tells a machine the time that had none of its own."""

from __future__ import annotations

from smarttestudo.domain.robot import Robot
from smarttestudo.domain.units import NS_PER_MS, NS_PER_S

LEAST_NS = NS_PER_S // 20
"""A smaller jump counts as time that passed; a clock that is slewed runs by no more in so short a time."""
_PRECISE_NS = NS_PER_MS
_TRIES = 5


class ClockJumps:
    """Finds jumps by a clock that has none, and has the robot's log say them.

    Simulated time goes as fast as it likes, so it never jumps.
    """

    __slots__ = ("_clock_ns", "_robot", "_steady_ns", "_until_ns")

    def __init__(self, robot: Robot) -> None:
        self._robot = robot
        self._compare()

    def agrees(self, now_ns: int) -> bool:
        """Whether the clock cannot have jumped far by ``now_ns``, as it was asked a moment ago."""
        return self._clock_ns <= now_ns <= self._until_ns

    def jump_ns(self) -> int:
        """How far the clock has jumped since the last call, back if that is negative; 0 if not far."""
        clock_ns, steady_ns = self._clock_ns, self._steady_ns
        self._compare()
        jumped_ns = self._clock_ns - clock_ns - (self._steady_ns - steady_ns)
        if self._robot.is_time_simulated or abs(jumped_ns) <= LEAST_NS:
            return 0
        log, by_s = self._robot.log, abs(jumped_ns) / NS_PER_S
        if jumped_ns > 0:
            log.warning(f"the clock jumped ahead by {by_s:.1f} s: rules and rates leave that out")
        else:
            log.warning(f"the clock was set back by {by_s:.1f} s: rules and rates go on from there")
        return jumped_ns

    def _compare(self) -> None:
        """Read both clocks as one: what delays this process in between would be a jump."""
        best_ns = None
        for _ in range(_TRIES):
            before_ns, clock_ns = self._robot.steady_ns(), self._robot.now_ns()
            took_ns = self._robot.steady_ns() - before_ns
            if best_ns is None or took_ns < best_ns:
                best_ns, self._steady_ns, self._clock_ns = took_ns, before_ns, clock_ns
            if took_ns <= _PRECISE_NS:
                break
        self._until_ns = self._clock_ns + LEAST_NS
