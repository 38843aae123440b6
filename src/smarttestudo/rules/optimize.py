# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rates for the quality levels in rule files, as text, rules and JSON."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from smarttestudo.checks import CheckContext, check_rules
from smarttestudo.domain.errors import TestudoError
from smarttestudo.domain.finding import Finding, Severity
from smarttestudo.domain.names import resolve_topic
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.rate import Tier
from smarttestudo.language.parser import parse
from smarttestudo.language.syntax import RuleFile
from smarttestudo.optimizer.explanation import (
    Change,
    Infeasibility,
    SubproblemExplanation,
    TopicRow,
    explain_subproblem,
    infeasibility,
)
from smarttestudo.optimizer.model import Model
from smarttestudo.optimizer.requirements import TopicsWithoutDefault
from smarttestudo.optimizer.rewriting import rewrite
from smarttestudo.optimizer.rule_rates import Optimization, SolvedSubproblem, enough_kb_per_s, optimize_rules
from smarttestudo.optimizer.wording import kb_text
from smarttestudo.rules.profile_file import load_profile
from smarttestudo.rules.rule_files import read_rule_text, sha256_of
from smarttestudo.rules.rule_sets import known_types


@dataclass(frozen=True, slots=True, kw_only=True)
class OptimizeCommand:
    """One call of ``testudo optimize``; ``only_named`` leaves out what only the profile names.

    ``budget_kb_per_s`` replaces the profile's budget.
    """

    rules: Path
    profile: Path
    model: Model = Model.QUPER
    only_named: bool = False
    budget_kb_per_s: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class OptimizeOutcome:
    """The rates, and the rule file with them: ``rewritten`` is ``None`` where not everything fits."""

    optimization: Optimization
    infeasible: tuple[Infeasibility, ...]
    rewritten: str | None

    def explained(self) -> list[tuple[SolvedSubproblem, SubproblemExplanation]]:
        """Every subproblem that fits, with its explanation."""
        done = self.optimization
        return [
            (solved, explain_subproblem(solved, done.budget_kb_per_s, model=done.model))
            for solved in done.subproblems
            if solved.feasible
        ]


class RefusedRulesError(TestudoError):
    """A rule file with errors, which are in ``findings``."""

    def __init__(self, findings: Sequence[Finding]) -> None:
        super().__init__("the rule file has errors", place=findings[0].path, remedy="fix them first")
        self.findings = tuple(findings)


def optimize(request: OptimizeCommand) -> OptimizeOutcome:
    """Solve ``request``.

    Raises ``RefusedRulesError`` for a file with errors, other ``TestudoError`` for files that cannot be read
    and for what the profile lacks.
    """
    text = read_rule_text(request.rules)
    profile = load_profile(request.profile)
    if request.budget_kb_per_s is not None:
        profile = replace(profile, budget_kb_per_s=request.budget_kb_per_s)
    result = parse(text, str(request.rules))
    findings = check_rules([result], CheckContext(profile=profile, types=known_types(None, profile)))
    errors = [finding for finding in findings if finding.severity is Severity.ERROR]
    if errors:
        raise RefusedRulesError(errors)
    return optimize_text(
        UsableText(text=text, file=result.file),
        profile,
        model=request.model,
        only_named=request.only_named,
        profile_sha256=sha256_of(request.profile),
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class UsableText:
    """A rule file without errors: its text and what that parsed to."""

    text: str
    file: RuleFile


def optimize_text(
    rules: UsableText, profile: Profile, *, model: Model, only_named: bool, profile_sha256: str
) -> OptimizeOutcome:
    """Solve ``rules``; ``profile_sha256`` goes into the rewritten file's first line.

    Raises ``ProfileError`` for what the profile lacks.
    """
    done = optimize_rules(
        [rules.file],
        profile,
        resolve_topic,
        model=model,
        without_default=TopicsWithoutDefault.LEFT_OUT if only_named else TopicsWithoutDefault.APPENDED,
        types=known_types(None, profile),
    )
    rewritten = None
    if done.feasible:
        provenance = (
            f"model {model.value}, budget {kb_text(done.budget_kb_per_s)} KB/s, "
            f"profile {Path(profile.path).name} (sha256 {profile_sha256})"
        )
        rewritten = rewrite(rules.text, rules.file, done, provenance=provenance)
    return OptimizeOutcome(optimization=done, infeasible=infeasible_subproblems(done), rewritten=rewritten)


def infeasible_subproblems(done: Optimization) -> tuple[Infeasibility, ...]:
    """Parts that do not fit, each with the smallest change with which it would.

    If the defaults do not fit, they must be changed first, and only they are named.
    """
    subproblems = done.blocks if done.defaults.feasible else (done.defaults,)
    return tuple(
        infeasibility(
            solved,
            done.budget_kb_per_s,
            model=done.model,
            change=_smallest_change(solved, done),
            enough_kb_per_s=enough_kb_per_s(solved, done),
        )
        for solved in subproblems
        if not solved.feasible
    )


def _smallest_change(solved: SolvedSubproblem, done: Optimization) -> Change | None:
    # A robot has no HiGHS; that something does not fit, and by how much, is known without it.
    try:
        from smarttestudo.optimizer.solver import smallest_change  # noqa: PLC0415
    except ModuleNotFoundError:
        return None
    return smallest_change(solved, done.budget_kb_per_s, model=done.model)


_DECIMALS = 6


def optimize_json(outcome: OptimizeOutcome) -> dict[str, object]:
    """One object: defaults and blocks with their rates, what they use, and why."""
    done = outcome.optimization
    explained = {id(solved): explanation for solved, explanation in outcome.explained()}
    refused = {id(infeasible.solved): infeasible for infeasible in outcome.infeasible}
    defaults, *blocks = (
        _subproblem(solved, explained.get(id(solved)), refused.get(id(solved))) for solved in done.subproblems
    )
    return {
        "model": done.model.value,
        "budget_kb_per_s": done.budget_kb_per_s,
        "feasible": done.feasible,
        "defaults": defaults["rates"],
        "appended": list(done.appended),
        "defaults_part": defaults,
        "blocks": [
            {"rule": solved.subproblem.label, "line": solved.subproblem.span.line, **block}
            for solved, block in zip(done.blocks, blocks, strict=True)
        ],
    }


def _subproblem(
    solved: SolvedSubproblem, explanation: SubproblemExplanation | None, refused: Infeasibility | None
) -> dict[str, object]:
    record: dict[str, object] = {
        "rates": None if solved.rates_hz is None else solved.topic_rates_hz,
        "used_kb_per_s": round(solved.used_kb_per_s, _DECIMALS),
        "needs_kb_per_s": round(solved.needs_kb_per_s, _DECIMALS),
        "feasible": solved.feasible,
    }
    if solved.bounds:
        record["bounds"] = solved.bounds
    if explanation is not None:
        record["price_per_kb_per_s"] = solved.price
        record["topics"] = {row.topic: _row(row) for row in explanation.rows}
        record["notes"] = list(explanation.notes)
    if refused is not None:
        record["message"] = refused.message
        record["remedies"] = list(refused.remedies)
        record["changes"] = [] if refused.change is None else [_change(refused.change)]
    return record


def _row(row: TopicRow) -> dict[str, object]:
    bound = {} if row.bound is None else {"within": row.bound}
    return {
        **bound,
        "wanted": _wanted(row.wanted),
        "level": None if row.level is None else row.level.value,
        "rate_hz": row.rate_hz,
        "kb_per_s": round(row.kb_per_s, _DECIMALS),
        "share": row.share if row.share == row.share else None,
        "held_by": row.binding.value,
    }


def _change(change: Change) -> dict[str, object]:
    return {
        "topics": {reduction.topic: _wanted(reduction.wanted) for reduction in change.reductions},
        "needs_kb_per_s": round(change.needs_kb_per_s, _DECIMALS),
    }


def _wanted(wanted: Tier | float) -> str | float:
    return wanted.value if isinstance(wanted, Tier) else wanted
