# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A rate that goes by a value: what control engineers call gain scheduling."""

from __future__ import annotations

import math
from bisect import bisect_left
from dataclasses import dataclass, field

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

    rates: tuple[Rate, ...] = field(init=False)
    """The rate of each step, rising."""
    cuts: tuple[Bound, ...] = field(init=False)
    """Where the signal's value changes the step, rising."""

    def __post_init__(self) -> None:
        """Compute once what each message of the signal needs."""
        width_hz, width = self.high.hz - self.low.hz, self.high_at - self.low_at
        between = (Rate(self.low.hz + width_hz * step / STEPS) for step in range(1, STEPS))
        object.__setattr__(self, "rates", (self.low, *between, self.high))
        side = 1 if width > 0 else -1
        ends = (self.low_at + width * step / STEPS for step in range(STEPS))
        object.__setattr__(self, "cuts", tuple(sorted((end, side) for end in ends)))

    def step(self, value: float | None) -> int:
        """The place in ``rates`` of the rate for a value; the last for an unknown one."""
        if value is None or math.isnan(value):
            return STEPS
        passed = bisect_left(self.cuts, (value, 0))
        return passed if self.high_at > self.low_at else STEPS - passed
