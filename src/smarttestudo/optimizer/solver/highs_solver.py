# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Best rates for any number of budgets, and the smallest changes with which all fits, from HiGHS."""

from __future__ import annotations

import math
from collections.abc import Sequence

from smarttestudo.optimizer.changes import Reduction
from smarttestudo.optimizer.problem import Allocation, Budget, Demand, fits
from smarttestudo.optimizer.solver.linear_program import LinearProgram, Row, maximise


class HighsSolver:
    """The linear program as it stands: any number of budgets, each over any topics."""

    def allocate(self, demands: Sequence[Demand], budgets: Sequence[Budget]) -> Allocation | None:
        """As ``Solver``."""
        columns = [
            (index, piece)
            for index, demand in enumerate(demands)
            for piece in demand.pieces
            if piece.width_hz > 0
        ]
        limits = [_left_of(budget, demands) for budget in budgets]
        if any(left is None for left in limits):
            return None
        rows: list[Row] = [
            (
                {
                    column: demands[index].size_kb
                    for column, (index, _) in enumerate(columns)
                    if budget.covers(demands[index].topic)
                },
                -math.inf,
                left or 0.0,
            )
            for budget, left in zip(budgets, limits, strict=True)
        ]
        solved = maximise(
            LinearProgram(
                costs=[piece.gain_per_hz for _, piece in columns],
                upper=[piece.width_hz for _, piece in columns],
                rows=rows,
            )
        )
        if solved is None:
            return None
        rates = [demand.least_hz for demand in demands]
        for (index, _), value in zip(columns, solved.values, strict=True):
            rates[index] += max(0.0, value)
        return Allocation(
            rates_hz={demand.topic: rate for demand, rate in zip(demands, rates, strict=True)},
            price=max(0.0, solved.duals[0]) if solved.duals else 0.0,
        )


def _left_of(budget: Budget, demands: Sequence[Demand]) -> float | None:
    """The rest of a budget above everyone's lowest rate, ``None`` where it is broken already."""
    least = math.fsum(demand.least_kb_per_s for demand in demands if budget.covers(demand.topic))
    if not fits(least, budget.limit_kb_per_s):
        return None
    return max(0.0, budget.limit_kb_per_s - least)


class HighsChangeFinder:
    """The smallest changes by an integer program: one binary column for each reduction."""

    def smallest(
        self, reductions: Sequence[Reduction], excess_kb_per_s: float, count: int
    ) -> list[tuple[Reduction, ...]]:
        """As ``ChangeFinder``."""
        by_topic: dict[str, list[int]] = {}
        for column, reduction in enumerate(reductions):
            by_topic.setdefault(reduction.topic, []).append(column)
        saved = {column: one.saved_kb_per_s / excess_kb_per_s for column, one in enumerate(reductions)}
        rows: list[Row] = [(saved, 1.0, math.inf)]
        rows += [(dict.fromkeys(columns, 1.0), -math.inf, 1.0) for columns in by_topic.values()]
        # One topic more weighs more than the steepest reductions of all topics.
        topic_weight = 1 + len(by_topic) * max((one.steps**2 for one in reductions), default=0)
        costs = [-float(topic_weight + one.steps**2) for one in reductions]
        found: list[tuple[Reduction, ...]] = []
        while len(found) < count:
            solved = maximise(
                LinearProgram(costs=costs, upper=[1.0] * len(reductions), rows=rows, integral=True)
            )
            if solved is None:
                break
            chosen = tuple(one for one, value in zip(reductions, solved.values, strict=True) if value > 0.5)
            if fits(excess_kb_per_s, math.fsum(one.saved_kb_per_s for one in chosen)):
                found.append(chosen)
            forbidden = {column: 1.0 for one in chosen for column in by_topic[one.topic]}
            rows.append((forbidden, -math.inf, len(chosen) - 1.0))
        return found
