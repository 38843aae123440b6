# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How often a live run tells what it does."""

from __future__ import annotations

from smarttestudo.composition.live_status import STATUS_HZ
from smarttestudo.composition.status_announcer import STATUS_TOPIC
from smarttestudo.domain.robot import Robot
from smarttestudo.domain.units import NS_PER_S

# Telling is worth a fifth of a core at most: messages come first.
_TIMES_ITS_COST = 5
# A period of one second is met by timers that are a little early.
_DIAGNOSIS_AFTER_NS = NS_PER_S * 9 // 10


class StatusPulse:
    """Once a second, or ``asked_hz`` times while somebody listens; diagnostics once a second in any case.

    So what an operator asked for ends with the operator.
    """

    def __init__(self, robot: Robot) -> None:
        self.asked_hz = STATUS_HZ
        self._robot = robot
        self._diagnosed_ns: int | None = None

    @property
    def period_s(self) -> float:
        """The time from one status to the next."""
        return 1 / self.status_hz

    @property
    def status_hz(self) -> float:
        """How often a status comes now."""
        if self.asked_hz > STATUS_HZ and not self._robot.subscriber_count(STATUS_TOPIC):
            return STATUS_HZ
        return self.asked_hz

    def is_diagnosis_due(self, steady_ns: int) -> bool:
        """Whether the status of now is one for diagnostics, too; asked once for each."""
        if self._diagnosed_ns is not None and steady_ns < self._diagnosed_ns + _DIAGNOSIS_AFTER_NS:
            return False
        self._diagnosed_ns = steady_ns
        return True

    def next_s(self, cost_ns: int) -> float:
        """In how many seconds to tell again, where telling took ``cost_ns`` of CPU time."""
        return max(self.period_s, min(cost_ns * _TIMES_ITS_COST / NS_PER_S, 1 / STATUS_HZ))
