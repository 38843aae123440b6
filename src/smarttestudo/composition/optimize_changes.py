# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The smallest changes of what does not fit, where the solver for them is installed."""

from __future__ import annotations

from smarttestudo.optimizer.changes import Change, smallest_changes
from smarttestudo.optimizer.infeasibility import Infeasibility, infeasibility
from smarttestudo.optimizer.rule_rates import Optimization, SolvedPart


def infeasible_parts(done: Optimization) -> tuple[Infeasibility, ...]:
    """What does not fit, each with the smallest changes that would."""
    return tuple(
        infeasibility(solved, done.budget_kb_per_s, _changes(solved, done), model=done.model)
        for solved in done.parts
        if not solved.feasible
    )


def _changes(solved: SolvedPart, done: Optimization) -> list[Change] | None:
    # A robot has no HiGHS; that something does not fit, and by how much, is known without it.
    try:
        from smarttestudo.adapters.solver.highs_change_finder import HighsChangeFinder  # noqa: PLC0415
    except ModuleNotFoundError:
        return None
    return smallest_changes(solved, done.budget_kb_per_s, model=done.model, finder=HighsChangeFinder())
