# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rates and bounds of the quality levels in rule files, within the profile's budget."""

from __future__ import annotations

from collections.abc import Sequence

from smarttestudo.domain.errors import RuleFileError
from smarttestudo.domain.profile import Profile
from smarttestudo.language.known_types import KnownTypes
from smarttestudo.language.normal_form import Resolve
from smarttestudo.language.syntax import RuleFile
from smarttestudo.optimizer.explanation import infeasibility
from smarttestudo.optimizer.model import Model
from smarttestudo.optimizer.requirements import TopicsWithoutDefault
from smarttestudo.optimizer.rule_rates import Optimization, optimize_rules


def optimize_tiers(
    files: Sequence[RuleFile], profile: Profile, resolve: Resolve, types: KnownTypes
) -> Optimization:
    """The rates of the levels in ``files``, the same that ``testudo optimize`` writes.

    Topics of the profile that the files do not name count, too, as far as the profile has what that needs.
    """
    return optimize_rules(
        files,
        profile,
        resolve,
        model=Model.QUPER,
        without_default=TopicsWithoutDefault.COUNTED,
        types=types,
    )


def fitting_tiers(
    files: Sequence[RuleFile], profile: Profile, resolve: Resolve, types: KnownTypes
) -> Optimization:
    """The same, where everything fits. Raises ``RuleFileError`` for what does not."""
    done = optimize_tiers(files, profile, resolve, types)
    for solved in done.subproblems:
        if not solved.feasible:
            refused = infeasibility(solved, done.budget_kb_per_s, model=done.model)
            raise RuleFileError(
                refused.message,
                place=solved.subproblem.place,
                remedy="testudo optimize says which changes would fit",
            )
    return done
