# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The accuracies of quality levels, and the rates that they were measured to need."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum

from smarttestudo.domain.rate import Tier


class LevelledProperty(Enum):
    """A property whose accuracy can have quality levels; the value is its name in a rule file."""

    POSITION = "position"
    ORIENTATION = "orientation"
    POSITIONS = "positions"

    @property
    def unit(self) -> str:
        """As a profile's keys spell it: m, deg or rad."""
        return {"position": "m", "orientation": "deg", "positions": "rad"}[self.value]

    @property
    def tiers_key(self) -> str:
        """The profile's key of the accuracies."""
        return f"tiers_{self.unit}"

    @property
    def needs_key(self) -> str:
        """The profile's key of the rates that they need."""
        return f"{self.tiers_key}_need_hz"


@dataclass(frozen=True, slots=True, kw_only=True)
class AccuracyTiers:
    """Six accuracies α0 … α5 of one property that do not rise, and what they need.

    ``bounds`` are in the property's unit. ``needs_hz`` are the mean rates, which do not fall, that keeping
    within each of them was measured to need; ``None`` where it was not.
    """

    bounds: tuple[float, ...]
    needs_hz: tuple[float, ...] | None = None

    def interval(self, tier: Tier) -> tuple[float, float]:
        """The loosest and the tightest bound of a level.

        Unacceptable is α0 and Excessive α5, since beyond them nothing is said.
        """
        level = tier.level
        if tier in {Tier.UNACCEPTABLE, Tier.EXCESSIVE}:
            return self.bounds[level], self.bounds[level]
        return self.bounds[level - 1], self.bounds[level]

    def needed_hz(self, bound: float) -> float:
        """The rate that ``bound`` needs.

        Between two accuracies it is on the line between theirs, from α0 on that of α0; infinite where a
        tighter bound than α5 is asked for, or nothing was measured.
        """
        if self.needs_hz is None:
            return math.inf
        if bound >= self.bounds[0]:
            return self.needs_hz[0]
        for (loose, low_hz), (tight, high_hz) in self._segments():
            if tight <= bound < loose:
                return high_hz + (low_hz - high_hz) * (bound - tight) / (loose - tight)
        return math.inf

    def tightest_within(self, rate_hz: float) -> float:
        """The tightest bound that ``rate_hz`` keeps, α0 where it keeps none; ``needs_hz`` must be known."""
        tightest = self.bounds[0]
        for (loose, low_hz), (tight, high_hz) in self._segments():
            if high_hz <= rate_hz:
                tightest = tight
            elif low_hz < rate_hz:
                return loose + (tight - loose) * (rate_hz - low_hz) / (high_hz - low_hz)
        return tightest

    def _segments(self) -> Iterator[tuple[tuple[float, float], tuple[float, float]]]:
        return itertools.pairwise(zip(self.bounds, self.needs_hz or (), strict=True))


_DIGITS = 4
_NOISE = 1e-12


def rounded_up(bound: float) -> float:
    """``bound`` in four significant digits, never tighter than it was but for float noise."""
    if not 0 < bound < math.inf:
        return bound
    step = 10.0 ** (math.floor(math.log10(bound)) + 1 - _DIGITS)
    near = float(f"{bound:.{_DIGITS}g}")
    return near if near >= bound * (1 - _NOISE) else float(f"{near + step:.{_DIGITS}g}")
