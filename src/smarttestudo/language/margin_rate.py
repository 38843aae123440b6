# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A rate that goes by a value: what control engineers call gain scheduling."""

from __future__ import annotations

import math
from dataclasses import dataclass

from smarttestudo.domain.rate import Rate
from smarttestudo.domain.signal import Signal
from smarttestudo.language.region import Bound

STEPS = 5
"""Few, so that decisions stay few."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MarginRate:
    """From ``low`` where ``signal`` is ``low_at`` or beyond, to ``high`` where it is ``high_at`` or beyond.

    Between, it rises in five equal steps and is never below the straight line.
    """

    signal: Signal
    low: Rate
    high: Rate
    low_at: float
    high_at: float

    @property
    def rates(self) -> tuple[Rate, ...]:
        """The rate of each step, rising."""
        width_hz = self.high.hz - self.low.hz
        between = (Rate(self.low.hz + width_hz * step / STEPS) for step in range(1, STEPS))
        return self.low, *between, self.high

    @property
    def cuts(self) -> tuple[Bound, ...]:
        """Where the signal's value changes the step, rising."""
        width = self.high_at - self.low_at
        ends = [self.low_at + width * step / STEPS for step in range(STEPS)]
        side = 1 if width > 0 else -1
        return tuple(sorted((end, side) for end in ends))

    def step(self, value: float | None) -> int:
        """The place in ``rates`` of the rate for a value; the last for an unknown one."""
        if value is None or math.isnan(value):
            return STEPS
        passed = sum(cut < (value, 0) for cut in self.cuts)
        return passed if self.high_at > self.low_at else STEPS - passed
