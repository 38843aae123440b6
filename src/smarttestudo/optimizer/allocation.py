# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""From what a rule file asks to rates: one call for every model."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from smarttestudo.domain.tier import Tier
from smarttestudo.optimizer.maxmin import Ladder, level_out
from smarttestudo.optimizer.model import Ask, Model
from smarttestudo.optimizer.problem import Allocation, Budget, Solver

STEPS_PER_HZ = 1000


def best_rates(
    model: Model, asks: Sequence[Ask], budget_kb_per_s: float, solver: Solver
) -> Allocation | None:
    """The best rates in Hz under ``model``, not yet rounded; ``None`` where the asks do not fit together."""
    if model is Model.MAXMIN:
        return level_out([_ladder(ask) for ask in asks], budget_kb_per_s)
    demands = [ask.demand(model) for ask in asks]
    return solver.allocate(demands, [Budget(limit_kb_per_s=budget_kb_per_s)])


def rounded_down(rates_hz: Mapping[str, float], least_hz: Mapping[str, float]) -> dict[str, float]:
    """The rates rounded down to 0.001 Hz, but never below the lowest rate of their topic."""
    return {topic: max(round_down(rate), least_hz[topic]) for topic, rate in rates_hz.items()}


def round_down(rate_hz: float) -> float:
    """``rate_hz`` in whole steps of 0.001 Hz; what misses a step by float noise only has reached it."""
    steps = rate_hz * STEPS_PER_HZ
    nearest = round(steps)
    whole = nearest if math.isclose(steps, nearest, rel_tol=1e-12, abs_tol=1e-9) else math.floor(steps)
    return whole / STEPS_PER_HZ


def _ladder(ask: Ask) -> Ladder:
    least_hz, most_hz = ask.bounds_hz(Model.MAXMIN)
    # A topic with a written rate stands on one rung, whatever its tiers.
    tiers_hz = ask.needs.tiers_hz if isinstance(ask.wanted, Tier) else (least_hz,) * len(Tier)
    return Ladder(
        topic=ask.needs.topic,
        size_kb=ask.needs.size_kb,
        least_hz=least_hz,
        most_hz=most_hz,
        tiers_hz=tiers_hz,
    )
