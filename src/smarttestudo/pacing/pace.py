# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A target rate as the times that a grid counts in."""

from __future__ import annotations

import math
from dataclasses import dataclass

from smarttestudo.domain.units import NS_PER_S

NEVER_NS = 1 << 96
"""A time after all others, in ns; the period of Off."""

SLACK_PERIODS = 2
SLACK_AT_LEAST_NS = NS_PER_S // 4


@dataclass(frozen=True, slots=True)
class Pace:
    """A period, and the slack: how much unused time counts as credit; both in ns.

    The period is rounded down, so that a target equal to its source never falls behind it. Full has a
    period and a slack of 0: the next message is always due, and nothing is saved up.
    """

    period_ns: int
    slack_ns: int

    @staticmethod
    def at(rate_hz: float) -> Pace:
        """The pace of ``rate_hz``: infinite is Full, 0 is Off; ValueError if negative or NaN."""
        if math.isnan(rate_hz) or rate_hz < 0:
            raise ValueError(f"a rate is not negative: {rate_hz}")
        if math.isinf(rate_hz):
            return Pace(0, 0)
        if rate_hz * NEVER_NS <= NS_PER_S:
            return Pace(NEVER_NS, 0)
        period_ns = int(NS_PER_S / rate_hz)
        return Pace(period_ns, max(SLACK_PERIODS * period_ns, SLACK_AT_LEAST_NS))

    @property
    def is_full(self) -> bool:
        """Whether every message passes."""
        return self.period_ns == 0

    @property
    def is_off(self) -> bool:
        """Whether nothing passes."""
        return self.period_ns == NEVER_NS
