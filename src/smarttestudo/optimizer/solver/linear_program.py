# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Linear and integer programs, solved by HiGHS."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import highspy
import numpy as np

from smarttestudo.domain.dataclass import dataclass
from smarttestudo.domain.errors import TestudoError

_FEASIBILITY_TOLERANCE = 1e-9

Row = tuple[Mapping[int, float], float, float]
"""Coefficients by column, lower and upper limit."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LinearProgram:
    """Maximise ``costs`` · x with 0 <= x <= ``upper`` and the rows."""

    costs: Sequence[float]
    upper: Sequence[float]
    rows: Sequence[Row]
    integral: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Optimum:
    """The best values by column, the worth of one more unit by row, and the greatest cost · x."""

    values: Sequence[float]
    duals: Sequence[float]
    objective: float


class _SilentHighs(highspy.Highs):
    """HiGHS that prints nothing: since 1.16 its constructor prints, before one could set an option."""

    def __init__(self) -> None:
        super().__init__()  # type: ignore[no-untyped-call]

    def enableCallbacks(self) -> None:  # noqa: N802 - the first of HiGHS's own methods that its constructor calls
        self.silent()
        super().enableCallbacks()  # type: ignore[no-untyped-call]


def maximise(program: LinearProgram) -> Optimum | None:
    """The optimum, or ``None`` where the rows contradict each other."""
    if not program.costs:
        possible = all(low <= 0.0 <= high for _, low, high in program.rows)
        return Optimum(values=[], duals=[0.0] * len(program.rows), objective=0.0) if possible else None
    highs = _SilentHighs()
    highs.setOptionValue("primal_feasibility_tolerance", _FEASIBILITY_TOLERANCE)
    highs.setOptionValue("mip_feasibility_tolerance", _FEASIBILITY_TOLERANCE)
    highs.setOptionValue("mip_rel_gap", 0.0)
    highs.passModel(_highs_model(program))
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
    solution = highs.getSolution()
    return Optimum(
        values=list(solution.col_value),
        duals=list(solution.row_dual),
        objective=highs.getInfo().objective_function_value,
    )


def _highs_model(program: LinearProgram) -> highspy.HighsLp:
    model = highspy.HighsLp()
    model.sense_ = highspy.ObjSense.kMaximize
    model.num_col_ = len(program.costs)
    model.num_row_ = len(program.rows)
    model.col_cost_ = np.array(program.costs)
    model.col_lower_ = np.zeros(len(program.costs))
    model.col_upper_ = np.array(program.upper)
    model.row_lower_ = np.array([low for _, low, _ in program.rows])
    model.row_upper_ = np.array([high for _, _, high in program.rows])
    model.a_matrix_.format_ = highspy.MatrixFormat.kRowwise
    model.a_matrix_.start_ = np.cumsum([0, *(len(row) for row, _, _ in program.rows)])
    model.a_matrix_.index_ = np.array([column for row, _, _ in program.rows for column in row])
    model.a_matrix_.value_ = np.array([value for row, _, _ in program.rows for value in row.values()])
    if program.integral:
        model.integrality_ = [highspy.HighsVarType.kInteger] * len(program.costs)
    return model
