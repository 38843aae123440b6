# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The findings on a rule set and the profile's budget."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from smarttestudo.checks import wording
from smarttestudo.domain.errors import ProfileError
from smarttestudo.domain.finding import Finding, Severity, Span
from smarttestudo.domain.profile import Profile
from smarttestudo.language.boxes import Domain
from smarttestudo.language.known_types import KnownTypes
from smarttestudo.language.normal_form import Resolve
from smarttestudo.language.rule_set import RefusedTiers, RuleBlock, RuleSet, TierValues, compile_rules
from smarttestudo.language.syntax import Block, RuleFile
from smarttestudo.optimizer.joint import (
    JointCheck,
    Situation,
    Unproven,
    check_together,
    loads_of,
    missing_entries,
)
from smarttestudo.optimizer.problem import fits
from smarttestudo.optimizer.rule_rates import budget_of
from smarttestudo.optimizer.wording import enough_kb_text, kb_text
from smarttestudo.rules.optimize import infeasible_subproblems
from smarttestudo.rules.rule_sets import has_tiers
from smarttestudo.rules.tier_rates import optimize_tiers

_MISSING_NAMED = 3


def budget_findings(
    files: Sequence[RuleFile], profile: Profile, resolve: Resolve, domain: Domain, types: KnownTypes
) -> list[Finding]:
    """Findings on levels that do not fit, situations that break the budget, and the start-up.

    ``files`` have no errors; ``domain`` gives the possible values of a signal. A profile without a budget
    has nothing to be broken, so that only levels, which need one, get a finding.
    """
    if profile.budget_kb_per_s is None and not has_tiers(files):
        return []
    reporter = _Reporter(files, profile)
    tiers: TierValues = RefusedTiers()
    if has_tiers(files):
        try:
            done = optimize_tiers(files, profile, resolve, types)
        except ProfileError as error:
            return [reporter.incomplete(error)]
        if not done.feasible:
            return [infeasible_subproblem.finding() for infeasible_subproblem in infeasible_subproblems(done)]
        tiers = done
    rule_set = compile_rules(files, resolve, tiers, types).over_states()
    loads = loads_of(rule_set, profile)
    missing = missing_entries(rule_set, loads)
    if missing:
        return [reporter.unknown_loads(missing)]
    checked = check_together(rule_set, loads, budget_of(profile), domain)
    return list(reporter.joint(rule_set, checked))


class _Reporter:
    def __init__(self, files: Sequence[RuleFile], profile: Profile) -> None:
        self._profile = profile
        self._budget = profile.budget_kb_per_s or 0.0
        self._start = (files[0].path, files[0].statements[0].span if files[0].statements else _FIRST)
        self._spans: Mapping[tuple[str, int], Span] = {
            (file.path, statement.span.line): statement.span
            for file in reversed(files)
            for statement in reversed(file.statements)
            if isinstance(statement, Block)
        }

    def incomplete(self, error: ProfileError) -> Finding:
        hint = f"{error.remedy} ({self._profile.path})" if error.remedy else ""
        return self._finding("profile-incomplete", Severity.ERROR, error.cause, hint=hint)

    def unknown_loads(self, missing: Sequence[tuple[str, str]]) -> Finding:
        names = [f"{key} of {topic}" for topic, key in missing[:_MISSING_NAMED]]
        if len(missing) > _MISSING_NAMED:
            names.append(f"{len(missing) - _MISSING_NAMED} more")
        message = f"not proven to fit the budget: the profile lacks {wording.listed(names)}"
        hint = "testudo profile measures them in a recording"
        return self._finding("budget-not-proven", Severity.WARNING, message, hint=hint)

    def joint(self, rule_set: RuleSet, checked: JointCheck) -> Iterator[Finding]:
        yield from map(self._over_budget, checked.breaking)
        if checked.has_more:
            shown = len(checked.breaking)
            yield self._finding(
                "situation-over-budget",
                Severity.WARNING,
                f"more situations than the {shown} worst break the budget",
                hint="fix those first",
            )
        yield from (self._unproven(pair) for pair in checked.unproven)
        if not fits(checked.start_up_kb_per_s, self._budget):
            yield self._start_up(checked, rule_set)
        if not checked.breaking and not checked.unproven:
            yield self._fits(checked.worst)

    def _over_budget(self, situation: Situation) -> Finding:
        message = (
            f"{_blocks_hold(situation)}the topics take {enough_kb_text(situation.kb_per_s)} KB/s, "
            f"{self._over(situation.kb_per_s)}"
        )
        hint = "lower a rate, or run with --budget, which cuts rates by priority"
        return self._finding(
            "situation-over-budget", Severity.WARNING, message, hint=hint, blocks=situation.blocks
        )

    def _unproven(self, unproven: Unproven) -> Finding:
        reason = (
            "are too complex" if unproven.cells is None else f"make {unproven.cells} cells, more than 100 000"
        )
        count = len(unproven.blocks)
        subject = (
            "the conditions of this block"
            if count == 1
            else f"the conditions of {count} blocks that belong together"
        )
        message = f"not proven to fit the budget: {subject} {reason}"
        hint = "compare fewer properties with fewer numbers, or run with --budget"
        return self._finding(
            "budget-not-proven", Severity.WARNING, message, hint=hint, blocks=unproven.blocks
        )

    def _start_up(self, checked: JointCheck, rule_set: RuleSet) -> Finding:
        load = checked.start_up_kb_per_s
        cause = ", while nothing is known and every block may hold," if rule_set.blocks else ""
        message = f"at start-up{cause} the topics take {enough_kb_text(load)} KB/s, {self._over(load)}"
        hint = "run with --budget, which cuts rates by priority, or lower the highest rates"
        return self._finding("start-up-over-budget", Severity.WARNING, message, hint=hint)

    def _fits(self, worst: Situation) -> Finding:
        where = _blocks_hold(worst)
        message = (
            f"fits the budget in every situation: {where}the topics take at most "
            f"{kb_text(worst.kb_per_s)} of {kb_text(self._budget)} KB/s"
        )
        return self._finding("budget-fits", Severity.INFO, message, blocks=worst.blocks)

    def _over(self, kb_per_s: float) -> str:
        return f"{enough_kb_text(kb_per_s - self._budget)} more than the budget of {kb_text(self._budget)}"

    def _finding(
        self, code: str, severity: Severity, message: str, *, hint: str = "", blocks: Sequence[RuleBlock] = ()
    ) -> Finding:
        path, span = self._start
        if blocks:
            path, span = blocks[0].path, self._spans[blocks[0].path, blocks[0].line]
        return Finding(code=code, severity=severity, message=message, path=path, span=span, hint=hint)


_FIRST = Span(line=1, column=1, end_line=1, end_column=1)


def _blocks_hold(situation: Situation) -> str:
    """``where "A" (line 3) and "B" (line 9) hold, as at /odom pose_x = 3, ``."""
    if not situation.blocks:
        return "where no block holds, "
    names = [f'"{block.label}" (line {block.line})' for block in situation.blocks]
    state = wording.state(dict(sorted(situation.state.items())))
    verb = "holds" if len(names) == 1 else "hold"
    example = f", as at {state}" if state else ""
    return f"where {wording.listed(names)} {verb}{example}, "
