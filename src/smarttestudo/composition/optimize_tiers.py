# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Tiers of rule files as rates, for whoever compiles rules with a profile at hand."""

from __future__ import annotations

from collections.abc import Sequence

from smarttestudo.adirf.normal_form import Resolve
from smarttestudo.adirf.rule_set import TierRates, refuse_tier
from smarttestudo.adirf.syntax import Block, RuleFile
from smarttestudo.domain.errors import RuleFileError
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.tier import Tier
from smarttestudo.optimizer.greedy import GreedySolver
from smarttestudo.optimizer.infeasibility import infeasibility
from smarttestudo.optimizer.model import Model
from smarttestudo.optimizer.rule_asks import Undecided
from smarttestudo.optimizer.rule_rates import Optimization, optimize_rules


def has_tiers(files: Sequence[RuleFile]) -> bool:
    """Whether any statement of ``files`` names a quality level."""
    return any(
        isinstance(one.rate.value, Tier)
        for file in files
        for statement in file.statements
        for one in ((*statement.then, *statement.otherwise) if isinstance(statement, Block) else (statement,))
    )


def optimize_tiers(files: Sequence[RuleFile], profile: Profile, resolve: Resolve) -> Optimization:
    """The rates of the levels in ``files``, the same that ``testudo optimize`` writes.

    Topics of the profile that the files do not name count, too, as far as the profile has what that needs.
    """
    return optimize_rules(
        files, profile, resolve, model=Model.QUPER, solver=GreedySolver(), undecided=Undecided.COUNTED
    )


def tier_rates_for(files: Sequence[RuleFile], profile: Profile | None, resolve: Resolve) -> TierRates:
    """The rates of the levels in ``files``, for ``compile_rules``; without a profile every level is refused.

    Raises ``RuleFileError`` for what does not fit, ``ProfileError`` for what the profile lacks.
    """
    if profile is None or not has_tiers(files):
        return refuse_tier
    done = optimize_tiers(files, profile, resolve)
    for part in done.parts:
        if not part.feasible:
            refused = infeasibility(part, done.budget_kb_per_s, None, model=done.model)
            raise RuleFileError(
                refused.message,
                place=part.part.place,
                remedy="testudo optimize says which changes would fit",
            )
    return done.tier_rate
