# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What to change where something does not fit, if the solver for that is installed."""

from __future__ import annotations

from collections.abc import Mapping

from smarttestudo.adirf.rule_set import RuleSet
from smarttestudo.domain.profile import Profile
from smarttestudo.optimizer.changes import Change, smallest_changes
from smarttestudo.optimizer.infeasibility import Infeasibility, infeasibility
from smarttestudo.optimizer.joint.check import JointCheck
from smarttestudo.optimizer.joint.loads import Loads
from smarttestudo.optimizer.joint.mending import Setting, lowered_rates
from smarttestudo.optimizer.rule_rates import Optimization, SolvedPart, budget_of


def infeasible_parts(done: Optimization) -> tuple[Infeasibility, ...]:
    """What does not fit, each with the smallest changes that would.

    Where the defaults do not fit, they are to be mended first, and only they are named.
    """
    parts = done.blocks if done.defaults.feasible else (done.defaults,)
    return tuple(
        infeasibility(solved, done.budget_kb_per_s, _changes(solved, done), model=done.model)
        for solved in parts
        if not solved.feasible
    )


def lowered_where_too_much(
    rule_set: RuleSet, loads: Loads, checked: JointCheck, profile: Profile
) -> Mapping[Setting, float]:
    """Lower rates with which every situation fits; empty where none are needed, possible or looked for."""
    if not checked.breaking or checked.has_more:
        return {}
    try:
        from smarttestudo.adapters.solver.highs_solver import HighsSolver  # noqa: PLC0415
    except ModuleNotFoundError:
        return {}
    left_out = {topic for one in checked.unproven for block in one.blocks for topic in block.rates}
    lowered = lowered_rates(
        rule_set,
        loads,
        checked.breaking,
        [topic for topic in rule_set.relayed if topic not in left_out],
        budget_of(profile),
        priorities={topic: entry.priority for topic, entry in profile.topics.items()},
        solver=HighsSolver(),
    )
    return lowered or {}


def _changes(solved: SolvedPart, done: Optimization) -> list[Change] | None:
    # A robot has no HiGHS; that something does not fit, and by how much, is known without it.
    try:
        from smarttestudo.adapters.solver.highs_change_finder import HighsChangeFinder  # noqa: PLC0415
    except ModuleNotFoundError:
        return None
    return smallest_changes(solved, done.budget_kb_per_s, model=done.model, finder=HighsChangeFinder())
