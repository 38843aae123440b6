# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The exact answer for one budget: the most gain per KB first."""

from __future__ import annotations

import math
from collections.abc import Sequence

from smarttestudo.optimizer.problem import Allocation, Budget, Demand, fits

_SIGNIFICANT_DIGITS = 12

_Stretch = tuple[int, float, float, float]
"""The demand's index, the width in Hz, the cost in KB/s, the gain."""


class GreedySolver:
    """Fills the pieces of best gain per KB first; exact for concave worths and one budget.

    Pieces of equal gain per KB are filled by the same share, so neither names nor order decide.
    """

    def allocate(self, demands: Sequence[Demand], budgets: Sequence[Budget]) -> Allocation | None:
        """As ``Solver``; ``ValueError`` for other than one budget over all topics."""
        if len(budgets) != 1 or budgets[0].topics is not None:
            raise ValueError("the greedy solver takes one budget over all topics")
        return allocate(demands, budgets[0].limit_kb_per_s)


def allocate(demands: Sequence[Demand], budget_kb_per_s: float) -> Allocation | None:
    """The rates of the greatest gain with ``Σ size·rate`` within the budget, ``None`` where none fit."""
    least_kb_per_s = math.fsum(demand.size_kb * demand.least_hz for demand in demands)
    if not fits(least_kb_per_s, budget_kb_per_s):
        return None
    left = max(0.0, budget_kb_per_s - least_kb_per_s)
    rates = [demand.least_hz for demand in demands]
    gains: list[float] = []
    price = 0.0
    for density, stretches in _by_density(demands):
        cost = math.fsum(stretch[2] for stretch in stretches)
        share = 1.0 if fits(cost, left) else left / cost
        for index, width_hz, _, gain in stretches:
            rates[index] += share * width_hz
            gains.append(share * gain)
        left = max(0.0, left - cost)
        if share < 1.0:
            price = density
            break
    return Allocation(
        rates_hz={demand.topic: rate for demand, rate in zip(demands, rates, strict=True)},
        gain=math.fsum(gains),
        price=price,
    )


def _by_density(demands: Sequence[Demand]) -> list[tuple[float, list[_Stretch]]]:
    """The stretches worth filling by gain per KB, best first; equal ones together."""
    groups: dict[float, list[_Stretch]] = {}
    for index, demand in enumerate(demands):
        for piece in demand.pieces:
            if piece.gain_per_hz > 0 and piece.width_hz > 0:
                width_hz = piece.width_hz
                stretch = (index, width_hz, width_hz * demand.size_kb, width_hz * piece.gain_per_hz)
                groups.setdefault(_density(piece.gain_per_hz, demand.size_kb), []).append(stretch)
    return sorted(groups.items(), reverse=True)


def _density(gain_per_hz: float, size_kb: float) -> float:
    """Gain per KB, so rounded that equal quotients of different numbers are equal."""
    if size_kb <= 0:
        return math.inf
    return float(f"{gain_per_hz / size_kb:.{_SIGNIFICANT_DIGITS}g}")
