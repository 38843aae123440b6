# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The smallest change with which all fits, by an integer program of HiGHS."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence

import highspy
import numpy as np
import numpy.typing as npt

from smarttestudo.domain.errors import TestudoError
from smarttestudo.optimizer.explanation import Change, Reduction, most_saved, reductions_of
from smarttestudo.optimizer.model import Model
from smarttestudo.optimizer.problem import fits
from smarttestudo.optimizer.rule_rates import SolvedSubproblem

_FEASIBILITY_TOLERANCE = 1e-9

Row = tuple[Mapping[int, float], float, float]
"""Coefficients by column, lower and upper limit."""

Savings = npt.NDArray[np.float64]
"""KB/s by topic and steps."""


def smallest_change(solved: SolvedSubproblem, budget_kb_per_s: float, *, model: Model) -> Change | None:
    """The smallest change of requirements that makes one subproblem fit; ``None`` where none does."""
    excess = solved.needs_kb_per_s - budget_kb_per_s
    chosen = smallest(reductions_of(solved, budget_kb_per_s, model=model), excess)
    if chosen is None:
        return None
    needs = math.fsum([solved.needs_kb_per_s, *(-one.saved_kb_per_s for one in chosen)])
    return Change(reductions=chosen, needs_kb_per_s=needs)


def smallest(reductions: Sequence[Reduction], excess_kb_per_s: float) -> tuple[Reduction, ...] | None:
    """The reductions, at most one a topic, that save ``excess`` or more; ``None`` where none do.

    Fewest topics first, then the mildest: the least sum of squared steps. How few is known without a solver,
    by what each topic saves at most. Among so many topics, one that others outdo at every step is needed only
    once those are taken, so the programs are small.
    """
    saved = most_saved(reductions)
    falling = sorted(saved.values(), reverse=True)
    rivals = dict(zip(saved, _rivals(_savings(reductions, [*saved])), strict=True))
    for count, sum_kb_per_s in enumerate(itertools.accumulate(falling), start=1):
        if fits(excess_kb_per_s, sum_kb_per_s):
            columns = [one for one in reductions if rivals[one.topic] < count]
            chosen = _mildest(columns, count, excess_kb_per_s)
            if chosen is not None:
                return chosen
    return None


def _mildest(
    columns: Sequence[Reduction], count: int, excess_kb_per_s: float
) -> tuple[Reduction, ...] | None:
    """Of so many topics the least sum of squared steps; ``None`` where float noise leaves none."""
    of_topics: dict[str, list[int]] = {}
    for column, one in enumerate(columns):
        of_topics.setdefault(one.topic, []).append(column)
    saved = {column: one.saved_kb_per_s / excess_kb_per_s for column, one in enumerate(columns)}
    rows: list[Row] = [(saved, 1.0, math.inf), (dict.fromkeys(saved, 1.0), count, count)]
    rows += [(dict.fromkeys(of_one, 1.0), -math.inf, 1.0) for of_one in of_topics.values()]
    values = _least([float(one.steps**2) for one in columns], rows)
    if values is None:
        return None
    return tuple(one for one, value in zip(columns, values, strict=True) if value > 0.5)


def _savings(reductions: Sequence[Reduction], topics: Sequence[str]) -> Savings:
    """Savings of each of ``topics`` within so many steps, a row a topic."""
    rows = {topic: index for index, topic in enumerate(topics)}
    savings = np.zeros((len(rows), max((one.steps for one in reductions), default=0)))
    for one in reductions:
        savings[rows[one.topic], one.steps - 1] = one.saved_kb_per_s
    return np.maximum.accumulate(savings, axis=1)


def _rivals(savings: Savings) -> Iterator[int]:
    """How many topics save as much as each one at every step; of equal ones, those before it."""
    for index, own in enumerate(savings):
        as_much = (savings >= own).all(axis=1)
        equal = (savings[index:] == own).all(axis=1)
        yield int(as_much.sum() - equal.sum())


class _SilentHighs(highspy.Highs):
    """HiGHS that prints nothing: since 1.16 its constructor prints, before one could set an option."""

    def __init__(self) -> None:
        super().__init__()  # type: ignore[no-untyped-call]

    def enableCallbacks(self) -> None:  # noqa: N802 - the first of HiGHS's own methods that its constructor calls
        self.silent()
        super().enableCallbacks()  # type: ignore[no-untyped-call]


def _least(costs: Sequence[float], rows: Sequence[Row]) -> Sequence[float] | None:
    """The columns, each 0 or 1, of the least ``costs``; ``None`` where the rows contradict each other."""
    highs = _SilentHighs()
    highs.setOptionValue("primal_feasibility_tolerance", _FEASIBILITY_TOLERANCE)
    highs.setOptionValue("mip_feasibility_tolerance", _FEASIBILITY_TOLERANCE)
    highs.setOptionValue("mip_rel_gap", 0.0)
    highs.passModel(_highs_model(costs, rows))
    # The programs are small: a second thread would wait for work, and take a processor to do so.
    highs.setOptionValue("threads", 1)
    if highs.run() == highspy.HighsStatus.kError:
        # HiGHS keeps as many threads as this process first let it have.
        highs.setOptionValue("threads", 0)
        highs.run()
    status = highs.getModelStatus()
    if status == highspy.HighsModelStatus.kInfeasible:
        return None
    if status != highspy.HighsModelStatus.kOptimal:
        raise TestudoError(
            f"the solver stopped without an answer: {highs.modelStatusToString(status)}",
            remedy="look for sizes or rates in the profile that differ by many orders of magnitude",
        )
    return list(highs.getSolution().col_value)


def _highs_model(costs: Sequence[float], rows: Sequence[Row]) -> highspy.HighsLp:
    model = highspy.HighsLp()
    model.num_col_ = len(costs)
    model.num_row_ = len(rows)
    model.col_cost_ = np.array(costs)
    model.col_lower_ = np.zeros(len(costs))
    model.col_upper_ = np.ones(len(costs))
    model.row_lower_ = np.array([low for _, low, _ in rows])
    model.row_upper_ = np.array([high for _, _, high in rows])
    model.a_matrix_.format_ = highspy.MatrixFormat.kRowwise
    model.a_matrix_.start_ = np.cumsum([0, *(len(row) for row, _, _ in rows)])
    model.a_matrix_.index_ = np.array([column for row, _, _ in rows for column in row])
    model.a_matrix_.value_ = np.array([value for row, _, _ in rows for value in row.values()])
    model.integrality_ = [highspy.HighsVarType.kInteger] * len(costs)
    return model
