# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The optimizer's answer for a draft: rates, loads and repairs."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from enum import Enum
from types import MappingProxyType

from msgspec import Struct

from smarttestudo.checks import CheckContext
from smarttestudo.domain.errors import ProfileError
from smarttestudo.domain.names import resolve_topic
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.rate import Rate, Tier
from smarttestudo.domain.signal import Signal, Value
from smarttestudo.editing import Document
from smarttestudo.language.evaluator import Evaluator
from smarttestudo.language.formatter import number_text
from smarttestudo.language.rule_set import RuleSet, compile_rules
from smarttestudo.language.syntax import (
    Block,
    SetFrequency,
)
from smarttestudo.language.syntax_walks import (
    sets_in,
)
from smarttestudo.optimizer.explanation import Change, Infeasibility, change_text
from smarttestudo.optimizer.joint import check_together, loads_of, missing_entries
from smarttestudo.optimizer.model import Model
from smarttestudo.optimizer.problem import fits
from smarttestudo.optimizer.rule_rates import Optimization, SolvedSubproblem
from smarttestudo.ruler.job import job
from smarttestudo.ruler.rules.document import CheckedText, Draft, Substitute, require_usable
from smarttestudo.ruler.rules.statement_trees import Utf16
from smarttestudo.rules.optimize import OptimizeOutcome, UsableText, optimize_text
from smarttestudo.rules.rule_sets import known_types

_TOPICS_NAMED = 3


@dataclass(frozen=True, slots=True, kw_only=True)
class OptimizedDraft:
    """A draft without errors, its profile, and the optimizer's answer."""

    checked: CheckedText
    profile: Profile
    outcome: OptimizeOutcome


class Repair(Struct, frozen=True, kw_only=True):
    """One way to make a part fit: edits of the rules' text, or a greater budget in KB/s.

    ``sentence`` is the full text, ``title`` a short one for a button.
    """

    title: str
    sentence: str
    edits: tuple[Substitute, ...] = ()
    budget_kb_per_s: float | None = None


def optimize_draft(draft: Draft, model: Model, *, only_named: bool) -> OptimizedDraft:
    """Solve ``draft``.

    Raises ``RefusedTextError`` for rules with errors, ``ProfileError`` for what the profile lacks.
    """
    checked = require_usable(draft)
    profile = draft.profile()
    if profile is None:
        raise ProfileError("there is no profile", remedy="enter the topics' sizes and levels first")
    outcome = optimize_text(
        UsableText(text=draft.text, file=checked.document.result.file),
        profile,
        model=model,
        only_named=only_named,
        profile_sha256=hashlib.sha256((draft.profile_text or "").encode()).hexdigest(),
    )
    return OptimizedDraft(checked=checked, profile=profile, outcome=outcome)


def repairs_of(optimized: OptimizedDraft, refused: Infeasibility) -> Iterator[Repair]:
    """Repairs that make a part fit: the smallest change, if statements can say it, and a greater budget."""
    change = refused.change
    if change is not None:
        edits = _edits(optimized, refused.solved, change)
        if len(edits) == len(change.reductions):
            title = change_text(change, named=_TOPICS_NAMED)
            yield Repair(title=title, sentence=change_text(change), edits=edits)
    budget = refused.remedies[-1]
    yield Repair(title=budget, sentence=budget, budget_kb_per_s=refused.solved.needs_kb_per_s)


def _edits(optimized: OptimizedDraft, solved: SolvedSubproblem, change: Change) -> tuple[Substitute, ...]:
    """The rates of the statements of ``solved`` as ``change`` wants them.

    The last place comes first, so that each edit finds its place after those before it.
    """
    statements = {resolve_topic(one.topic.text): one for one in _statements(optimized, solved)}
    edits = (
        _edit(optimized, statements[reduction.topic], reduction.wanted)
        for reduction in change.reductions
        if reduction.topic in statements
    )
    return tuple(sorted(edits, key=lambda edit: edit.offset, reverse=True))


def _edit(optimized: OptimizedDraft, statement: SetFrequency, wanted: Tier | float) -> Substitute:
    document = optimized.checked.document
    start, end = document.places.range(statement.highest.span)
    utf16 = Utf16(document.text)
    return Substitute(
        offset=utf16.offset(start),
        end_offset=utf16.offset(end),
        replacement=wanted.value if isinstance(wanted, Tier) else number_text(wanted),
    )


def _statements(optimized: OptimizedDraft, solved: SolvedSubproblem) -> tuple[SetFrequency, ...]:
    """The statements that a part was made of: the defaults, or one side of a block."""
    statements = optimized.checked.document.result.file.statements
    if solved.subproblem.label is None:
        return tuple(one for one in statements if isinstance(one, SetFrequency))
    block = next(one for one in statements if isinstance(one, Block) and one.span == solved.subproblem.span)
    # The label of an Else has that word behind it.
    return sets_in(block.then if solved.subproblem.label == block.label else block.otherwise)


class OptimizeRequest(Draft, frozen=True, kw_only=True):
    """A draft that needs rates; 409 with findings for rules with errors."""

    model: Model = Model.QUPER
    only_named: bool = False


class Refusal(Struct, frozen=True, kw_only=True):
    """Why a part does not fit; ``rule`` is the statement's id, null for the defaults."""

    rule: str | None
    message: str
    needs_kb_per_s: float
    repairs: tuple[Repair, ...]


class OptimizeAnswer(Struct, frozen=True, kw_only=True):
    """The rates, as loads; ``download_text`` is the rule file with numbers, null where not all fits."""

    feasible: bool
    budget_kb_per_s: float
    situations: tuple[SituationLoad, ...]
    refusals: tuple[Refusal, ...]
    download_text: str | None


@job("POST /api/optimize", reads=True)
def optimize(request: OptimizeRequest) -> OptimizeAnswer:
    """Rates, loads and repairs.

    Raises ``RefusedTextError`` for rules with errors, ``ProfileError`` for what the profile lacks.
    """
    optimized = optimize_draft(request, request.model, only_named=request.only_named)
    outcome = optimized.outcome
    return OptimizeAnswer(
        feasible=outcome.optimization.feasible,
        budget_kb_per_s=outcome.optimization.budget_kb_per_s,
        situations=tuple(situations_of(optimized)),
        refusals=tuple(_refusal(optimized, one) for one in outcome.infeasible),
        download_text=outcome.rewritten,
    )


def _refusal(optimized: OptimizedDraft, refused: Infeasibility) -> Refusal:
    part = refused.solved.subproblem
    return Refusal(
        rule=None if part.label is None else id_at(optimized.checked.document, part.span.line),
        message=refused.message,
        needs_kb_per_s=refused.solved.needs_kb_per_s,
        repairs=tuple(repairs_of(optimized, refused)),
    )


class SituationKind(Enum):
    """Which situation loads belong to; the value is its name in JSON."""

    DEFAULTS = "defaults"
    RULE = "rule"
    WORST = "worst"


class TopicLoad(Struct, frozen=True, kw_only=True):
    """Share of the link that one topic takes in one situation; ``rate_hz`` is null for Full."""

    topic: str
    rate_hz: float | None
    kb_per_s: float


class SituationLoad(Struct, frozen=True, kw_only=True):
    """The loads of all relayed topics: by default, in one rule's block, or in the worst case.

    ``rules`` are the ids of the statements that hold, ``state`` an example of values (``"/odom pose_x"``).
    """

    kind: SituationKind
    title: str
    rules: tuple[str, ...]
    state: dict[str, float | str]
    loads: tuple[TopicLoad, ...]
    kb_per_s: float
    feasible: bool


def situations_of(optimized: OptimizedDraft) -> Iterator[SituationLoad]:
    """The defaults, each side of each block, and, where everything fits by itself, the worst of all."""
    done = optimized.outcome.optimization
    base = dict(_rates_hz(done.defaults, done))
    sizes = _sizes_kb(done)
    for solved in done.subproblems:
        is_default = solved is done.defaults
        others = {} if is_default else solved.subproblem.without_its_topics(base)
        rates_hz = {**others, **dict(_rates_hz(solved, done))}
        loads = (_load(topic, Rate(rate_hz), sizes[topic] * rate_hz) for topic, rate_hz in rates_hz.items())
        yield _situation(
            SituationKind.DEFAULTS if is_default else SituationKind.RULE,
            solved.subproblem.label or "Defaults",
            loads,
            feasible=solved.feasible,
            rules=() if is_default else _ids_at(optimized, solved.subproblem.span.line),
        )
    if done.feasible:
        yield from _worst(optimized)


def _rates_hz(solved: SolvedSubproblem, done: Optimization) -> Iterator[tuple[str, float]]:
    """The rates of a part; where it does not fit, the least that was asked for."""
    for topic, requirement in solved.subproblem.requirements.items():
        rate_hz = requirement.bounds_hz(done.model)[0] if solved.rates_hz is None else solved.rates_hz[topic]
        yield topic, rate_hz


def _sizes_kb(done: Optimization) -> dict[str, float]:
    return {
        topic: requirement.needs.size_kb
        for solved in done.subproblems
        for topic, requirement in solved.subproblem.requirements.items()
    }


def _worst(optimized: OptimizedDraft) -> Iterator[SituationLoad]:
    """Nothing where the profile does not know every load, or the conditions are too complex."""
    done = optimized.outcome.optimization
    file = optimized.checked.document.result.file
    types = known_types(None, optimized.profile)
    rule_set = _with_appended(compile_rules([file], resolve_topic, done, types), done).over_states()
    loads = loads_of(rule_set, optimized.profile)
    if missing_entries(rule_set, loads):
        return
    domain = CheckContext(profile=optimized.profile).domain
    found = check_together(rule_set, loads, done.budget_kb_per_s, domain, max_situations=1)
    if found.unproven:
        return
    worst, evaluator = found.worst, Evaluator(rule_set)
    for signal, value in worst.state.items():
        evaluator.set(signal, value)
    planned = {topic: evaluator.request(topic) for topic in rule_set.relayed}
    yield _situation(
        SituationKind.WORST,
        "Worst case",
        (_load(topic, one.rate, loads.kb_per_s(topic, one)) for topic, one in planned.items()),
        feasible=fits(worst.kb_per_s, done.budget_kb_per_s),
        rules=_ids_at(optimized, *(block.line for block in worst.blocks)),
        state=worst.state,
    )


def _situation(
    kind: SituationKind,
    title: str,
    loads: Iterable[TopicLoad],
    *,
    feasible: bool,
    rules: tuple[str, ...],
    state: Mapping[Signal, Value] = MappingProxyType({}),
) -> SituationLoad:
    known = tuple(loads)
    return SituationLoad(
        kind=kind,
        title=title,
        rules=rules,
        state={str(signal): value for signal, value in state.items()},
        loads=known,
        kb_per_s=math.fsum(load.kb_per_s for load in known),
        feasible=feasible,
    )


def _load(topic: str, rate: Rate, kb_per_s: float) -> TopicLoad:
    return TopicLoad(topic=topic, rate_hz=rate.to_json(), kb_per_s=kb_per_s)


def _ids_at(optimized: OptimizedDraft, *lines: int) -> tuple[str, ...]:
    document = optimized.checked.document
    return tuple(filter(None, (id_at(document, line) for line in lines)))


def id_at(document: Document, line: int) -> str | None:
    """The statement that starts on ``line``; of several the first."""
    found = (one.id for one in document.entries if one.token_range.tokens[0].line == line)
    return next(found, None)


def _with_appended(rule_set: RuleSet, done: Optimization) -> RuleSet:
    """With the defaults that the optimizer adds for topics of the profile."""
    return replace(rule_set, defaults={**rule_set.defaults, **done.appended_rates})
