# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rates for a draft, and what to change where something does not fit."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from dataclasses import dataclass

from msgspec import Struct

from smarttestudo.domain.errors import ProfileError
from smarttestudo.domain.names import resolve_topic
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.rate import Tier
from smarttestudo.language.formatter import number_text
from smarttestudo.language.syntax import Block, SetFrequency, sets_in
from smarttestudo.optimizer.explanation import Change, Infeasibility, change_text
from smarttestudo.optimizer.model import Model
from smarttestudo.optimizer.rule_rates import SolvedSubproblem
from smarttestudo.ruler.rules.checked_text import CheckedText, Draft, require_usable
from smarttestudo.ruler.rules.documents import Substitute
from smarttestudo.ruler.rules.utf16 import Utf16
from smarttestudo.rules.optimize import OptimizeOutcome, UsableText, optimize_text

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
    start, end = document.places.range(statement.rate.span)
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
