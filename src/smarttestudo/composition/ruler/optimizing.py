# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rates for a draft, and what to change where something does not fit."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from dataclasses import dataclass

from smarttestudo.adirf.document import Splice
from smarttestudo.adirf.formatter.values import number_text
from smarttestudo.adirf.syntax import Block, SetFrequency
from smarttestudo.composition.optimize import OptimizeOutcome, UsableText, optimize_text
from smarttestudo.composition.ruler.checked_text import CheckedText, Draft, require_usable
from smarttestudo.domain.errors import ProfileError
from smarttestudo.domain.names import resolve_topic
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.tier import Tier
from smarttestudo.optimizer.changes import Change
from smarttestudo.optimizer.infeasibility import Infeasibility
from smarttestudo.optimizer.model import Model
from smarttestudo.optimizer.rule_rates import SolvedPart


@dataclass(frozen=True, slots=True, kw_only=True)
class OptimizedDraft:
    """A draft without errors, its profile, and the optimizer's answer."""

    checked: CheckedText
    profile: Profile
    outcome: OptimizeOutcome


@dataclass(frozen=True, slots=True, kw_only=True)
class Repair:
    """One way to make a part fit: changes of the rules' text, or a greater budget in KB/s."""

    title: str
    splices: tuple[Splice, ...] = ()
    budget_kb_per_s: float | None = None


def optimize_draft(draft: Draft, model: Model, *, only_named: bool) -> OptimizedDraft:
    """Solve ``draft``.

    Raises ``RefusedTextError`` for rules with errors, ``ProfileError`` for what the profile lacks.
    """
    checked = require_usable(draft)
    profile = draft.profile()
    if profile is None:
        raise ProfileError("there is no profile", remedy="enter the topics' sizes and tiers first")
    outcome = optimize_text(
        UsableText(text=draft.text, file=checked.document.result.file),
        profile,
        model=model,
        only_named=only_named,
        profile_sha256=hashlib.sha256((draft.profile_text or "").encode()).hexdigest(),
    )
    return OptimizedDraft(checked=checked, profile=profile, outcome=outcome)


def repairs_of(optimized: OptimizedDraft, refused: Infeasibility) -> Iterator[Repair]:
    """What would make a part fit, the smallest change first, a greater budget last."""
    changes = zip(refused.changes, refused.remedies, strict=False)
    for change, sentence in changes:
        splices = tuple(_splices(optimized, refused.solved, change))
        if len(splices) == len(change.reductions):
            yield Repair(title=sentence, splices=splices)
    yield Repair(title=refused.remedies[-1], budget_kb_per_s=refused.solved.needs_kb_per_s)


def _splices(optimized: OptimizedDraft, solved: SolvedPart, change: Change) -> Iterator[Splice]:
    """The rates of the statements of ``solved`` as ``change`` wants them."""
    statements = {resolve_topic(one.topic.text): one for one in _statements(optimized, solved)}
    places = optimized.checked.document.places
    for reduction in change.reductions:
        statement = statements.get(reduction.topic)
        if statement is not None:
            wanted = reduction.wanted
            text = wanted.value if isinstance(wanted, Tier) else number_text(wanted)
            yield Splice(*places.range(statement.rate.span), text)


def _statements(optimized: OptimizedDraft, solved: SolvedPart) -> tuple[SetFrequency, ...]:
    """The statements that a part was made of: the defaults, or one side of a block."""
    statements = optimized.checked.document.result.file.statements
    if solved.part.label is None:
        return tuple(one for one in statements if isinstance(one, SetFrequency))
    block = next(one for one in statements if isinstance(one, Block) and one.span == solved.part.span)
    topics = {resolve_topic(one.topic.text) for one in block.then}
    is_then = solved.part.label == block.label and topics == set(solved.part.asks)
    return block.then if is_then else block.otherwise
