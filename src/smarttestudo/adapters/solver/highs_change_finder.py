# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The smallest changes that make everything fit."""

from __future__ import annotations

import math
from collections.abc import Sequence

from smarttestudo.adapters.solver.linear_program import LinearProgram, Row, maximise
from smarttestudo.optimizer.changes import Reduction
from smarttestudo.optimizer.problem import fits


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
