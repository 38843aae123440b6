# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rates within one budget, by the model that is asked for."""

from __future__ import annotations

import bisect
import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from smarttestudo.domain.rate import Tier
from smarttestudo.optimizer.greedy import allocate
from smarttestudo.optimizer.model import Model, Requirement
from smarttestudo.optimizer.problem import Allocation, fits, round_down, used_kb_per_s

_LEVELS = 5


@dataclass(frozen=True, slots=True, kw_only=True)
class Ladder:
    """The rates that bring a topic from quality 0 to 5 (τ0 … τ4 are 1 … 5), within its bounds."""

    topic: str
    size_kb: float
    least_hz: float
    most_hz: float
    tiers_hz: Sequence[float]

    def rate_hz(self, quality: float) -> float:
        """The rate that brings ``quality``, or the nearest that the bounds allow."""
        level = min(int(quality), _LEVELS - 1)
        low_hz = self.tiers_hz[level - 1] if level else 0.0
        rate_hz = low_hz + (quality - level) * (self.tiers_hz[level] - low_hz)
        return min(max(rate_hz, self.least_hz), self.most_hz)

    def quality(self, rate_hz: float) -> float:
        """The quality that ``rate_hz`` brings."""
        level = bisect.bisect_right(self.tiers_hz, rate_hz, hi=_LEVELS)
        if level == _LEVELS:
            return float(_LEVELS)
        low_hz = self.tiers_hz[level - 1] if level else 0.0
        return level + (rate_hz - low_hz) / (self.tiers_hz[level] - low_hz)

    @property
    def corners(self) -> tuple[float, ...]:
        """The qualities at which the cost of a little more quality changes."""
        return (*range(_LEVELS + 1), self.quality(self.least_hz), self.quality(self.most_hz))


def level_out(ladders: Sequence[Ladder], budget_kb_per_s: float) -> Allocation | None:
    """The rates whose sorted qualities are the greatest, lowest first; ``None`` where none fit.

    With one budget and worths that rise with the rate, that is one common quality for all topics that have
    not reached a bound of their own. ``price`` is its rise for one KB/s more.
    """
    corners = sorted({corner for ladder in ladders for corner in ladder.corners} | {0.0, float(_LEVELS)})
    if not fits(_cost(ladders, 0.0), budget_kb_per_s):
        return None
    # The cost rises with the quality and the first corner fits: bisection finds the last one that does.
    too_much = bisect.bisect_left(corners, 1, key=lambda q: not fits(_cost(ladders, q), budget_kb_per_s))
    last = too_much - 1
    quality, price = corners[last], 0.0
    for low, high in itertools.islice(itertools.pairwise(corners), last, last + 1):
        start, end = _cost(ladders, low), _cost(ladders, high)
        quality += (high - low) * max(0.0, budget_kb_per_s - start) / (end - start)
        price = (high - low) / (end - start)
    rates_hz = {ladder.topic: ladder.rate_hz(quality) for ladder in ladders}
    return Allocation(rates_hz=rates_hz, price=price)


def _cost(ladders: Sequence[Ladder], quality: float) -> float:
    return math.fsum(ladder.size_kb * ladder.rate_hz(quality) for ladder in ladders)


_AMPLE = 1 - 1e-9
"""What takes no more than this share of a budget is far enough within it for any rounding of sums."""


def best_rates(
    model: Model,
    requirements: Sequence[Requirement],
    bounds_hz: Sequence[tuple[float, float]],
    budget_kb_per_s: float,
) -> Allocation | None:
    """The best rates in Hz under ``model``, not yet rounded; ``None`` where they do not fit together.

    ``bounds_hz`` are the lowest and highest rates of the ``requirements``.
    """
    asked = [*zip(requirements, bounds_hz, strict=True)]
    if model is Model.MAXMIN:
        return level_out([_ladder(one, *bounds) for one, bounds in asked], budget_kb_per_s)
    most_kb_per_s = used_kb_per_s([(one.needs.size_kb, most_hz) for one, (_, most_hz) in asked])
    if model.every_hz_counts and most_kb_per_s <= _AMPLE * budget_kb_per_s:
        rates_hz = {one.needs.name: least_hz + (most_hz - least_hz) for one, (least_hz, most_hz) in asked}
        return Allocation(rates_hz=rates_hz, price=0.0)
    demands = [one.demand(model, *bounds) for one, bounds in asked]
    return allocate(demands, budget_kb_per_s)


def rounded_down(rates_hz: Mapping[str, float], least_hz: Mapping[str, float]) -> dict[str, float]:
    """The rates rounded down to 0.001 Hz, but never below the lowest rate of their topic."""
    return {topic: max(round_down(rate), least_hz[topic]) for topic, rate in rates_hz.items()}


def _ladder(requirement: Requirement, least_hz: float, most_hz: float) -> Ladder:
    # A topic with a written rate stands on one rung, whatever its tiers.
    tiers_hz = requirement.needs.tiers_hz if isinstance(requirement.wanted, Tier) else (least_hz,) * len(Tier)
    return Ladder(
        topic=requirement.needs.name,
        size_kb=requirement.needs.size_kb,
        least_hz=least_hz,
        most_hz=most_hz,
        tiers_hz=tiers_hz,
    )
