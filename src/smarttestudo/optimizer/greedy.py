# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The exact answer for one budget: the most gain per KB first."""

from __future__ import annotations

import math
from collections.abc import Sequence

from smarttestudo.optimizer.problem import Allocation, Demand, fits

_SIGNIFICANT_DIGITS = 12

Segment = tuple[float, int, float, float]
"""The gain for each KB, the index of the topic, the width in Hz, the cost in KB/s."""


def allocate(demands: Sequence[Demand], budget_kb_per_s: float) -> Allocation | None:
    """The rates of the greatest gain with ``Σ size·rate`` within the budget, ``None`` where none fit.

    It fills the pieces of best gain per KB first, which is exact for concave worths. Pieces of equal gain are
    filled by the same share, so neither names nor order decide.
    """
    least_kb_per_s = math.fsum([demand.size_kb * demand.least_hz for demand in demands])
    if not fits(least_kb_per_s, budget_kb_per_s):
        return None
    rates = [demand.least_hz for demand in demands]
    segments = [
        (_density(piece.gain_per_hz, demand.size_kb), index, piece.width_hz, piece.width_hz * demand.size_kb)
        for index, demand in enumerate(demands)
        for piece in demand.pieces
        if piece.gain_per_hz > 0 and piece.width_hz > 0
    ]
    price = fill(rates, segments, budget_kb_per_s - least_kb_per_s)
    return Allocation(
        rates_hz={demand.topic: rate for demand, rate in zip(demands, rates, strict=True)}, price=price
    )


def fill(rates_hz: list[float], segments: list[Segment], left_kb_per_s: float) -> float:
    """Raise ``rates_hz`` along ``segments`` while KB/s are left, best gain first, equal gains by one share.

    Returns the price: the gain of the next KB, 0 where all segments are filled.
    """
    groups: dict[float, list[Segment]] = {}
    for segment in segments:
        groups.setdefault(segment[0], []).append(segment)
    for density in sorted(groups, reverse=True):
        cost = math.fsum(segment[3] for segment in groups[density])
        share = 1.0 if cost <= 0 or fits(cost, left_kb_per_s) else max(0.0, left_kb_per_s) / cost
        for _, index, width_hz, _ in groups[density]:
            rates_hz[index] += share * width_hz
        if share < 1.0:
            return density
        # Below 0 by float noise once at most: it is not forgiven for each group anew.
        left_kb_per_s -= cost
    return 0.0


def _density(gain_per_hz: float, size_kb: float) -> float:
    """Gain per KB, so rounded that equal quotients of different numbers are equal."""
    if size_kb <= 0:
        return math.inf
    return float(f"{gain_per_hz / size_kb:.{_SIGNIFICANT_DIGITS}g}")
