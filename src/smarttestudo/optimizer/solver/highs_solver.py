# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Best rates for any number of budgets, and the smallest changes with which all fits, from HiGHS."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from collections.abc import Set as AbstractSet

import numpy as np
import numpy.typing as npt

from smarttestudo.optimizer.changes import Reduction
from smarttestudo.optimizer.problem import Allocation, Budget, Demand, fits
from smarttestudo.optimizer.solver.linear_program import LinearProgram, Row, maximise

Savings = npt.NDArray[np.float64]
"""KB/s by topic and steps."""


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
    """The smallest changes by integer programs: one binary column for each reduction that may matter."""

    def smallest(
        self, reductions: Sequence[Reduction], excess_kb_per_s: float, count: int
    ) -> list[tuple[Reduction, ...]]:
        """As ``ChangeFinder``."""
        search = _Search(reductions, excess_kb_per_s)
        tried: list[tuple[Reduction, ...]] = []
        found: list[tuple[Reduction, ...]] = []
        while len(found) < count:
            chosen = search.next_after([{one.topic for one in known} for known in tried])
            if chosen is None:
                break
            tried.append(chosen)
            if fits(excess_kb_per_s, math.fsum(one.saved_kb_per_s for one in chosen)):
                found.append(chosen)
        return found


class _Search:
    """Looks for the mildest reductions of as few topics as will do.

    How few is known without a solver, by what each topic saves at most. Among so many topics, one that
    others outdo at every step is needed only once those are taken, so the programs are small.
    """

    def __init__(self, reductions: Sequence[Reduction], excess_kb_per_s: float) -> None:
        self._reductions = reductions
        self._excess_kb_per_s = excess_kb_per_s
        self._most_saved: dict[str, float] = {}
        for one in reductions:
            self._most_saved[one.topic] = max(one.saved_kb_per_s, self._most_saved.get(one.topic, 0.0))
        self._rivals = dict(zip(self._most_saved, _rivals(self._savings()), strict=True))

    def next_after(self, known: Sequence[AbstractSet[str]]) -> tuple[Reduction, ...] | None:
        """The best reductions whose topics hold none of the ``known`` sets; ``None`` where there are none."""
        fewest = self._fewest(known)
        if fewest is None:
            return None
        counts = range(fewest, len(self._most_saved) + 1)
        return next(filter(None, (self._mildest(count, known) for count in counts)), None)

    def _fewest(self, known: Sequence[AbstractSet[str]]) -> int | None:
        """How many topics save enough, when one at least of each of the ``known`` sets is left out."""
        falling = sorted(self._most_saved, key=lambda topic: -self._most_saved[topic])
        # Of topics in the same sets, the one that saves least is the one to leave out.
        choices = [
            {tuple(topic in one for one in known): topic for topic in falling if topic in own}.values()
            for own in known
        ]
        counts = (self._enough(falling, {*left_out}) for left_out in itertools.product(*choices))
        return min((one for one in counts if one is not None), default=None)

    def _enough(self, falling: Sequence[str], left_out: AbstractSet[str]) -> int | None:
        saved = (self._most_saved[topic] for topic in falling if topic not in left_out)
        for count, sum_kb_per_s in enumerate(itertools.accumulate(saved), start=1):
            if fits(self._excess_kb_per_s, sum_kb_per_s):
                return count
        return None

    def _mildest(self, count: int, known: Sequence[AbstractSet[str]]) -> tuple[Reduction, ...] | None:
        """The least sum of squared steps of so many topics; ``None`` where so few do not save enough."""
        # Each known set rules out one exchange at most for a topic that is outdone.
        outdone = count + len(known)
        columns = [one for one in self._reductions if self._rivals[one.topic] < outdone]
        of_topics: dict[str, list[int]] = {}
        for column, one in enumerate(columns):
            of_topics.setdefault(one.topic, []).append(column)
        saved = {column: one.saved_kb_per_s / self._excess_kb_per_s for column, one in enumerate(columns)}
        rows: list[Row] = [(saved, 1.0, math.inf), (dict.fromkeys(saved, 1.0), count, count)]
        rows += [(dict.fromkeys(of_one, 1.0), -math.inf, 1.0) for of_one in of_topics.values()]
        for topics in known:
            own = [column for topic in topics for column in of_topics.get(topic, ())]
            rows.append((dict.fromkeys(own, 1.0), -math.inf, len(topics) - 1.0))
        costs = [-float(one.steps**2) for one in columns]
        solved = maximise(LinearProgram(costs=costs, upper=[1.0] * len(columns), rows=rows, integral=True))
        if solved is None:
            return None
        return tuple(one for one, value in zip(columns, solved.values, strict=True) if value > 0.5)

    def _savings(self) -> Savings:
        """Savings of each topic within so many steps, a row a topic."""
        rows = {topic: index for index, topic in enumerate(self._most_saved)}
        savings = np.zeros((len(rows), max((one.steps for one in self._reductions), default=0)))
        for one in self._reductions:
            savings[rows[one.topic], one.steps - 1] = one.saved_kb_per_s
        return np.maximum.accumulate(savings, axis=1)


def _rivals(savings: Savings) -> Iterator[int]:
    """How many topics save as much as each one at every step; of equal ones, those before it."""
    for index, own in enumerate(savings):
        as_much = (savings >= own).all(axis=1)
        equal = (savings[index:] == own).all(axis=1)
        yield int(as_much.sum() - equal.sum())
