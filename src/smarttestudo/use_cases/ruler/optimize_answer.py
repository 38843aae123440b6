# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The optimizer's answer for a draft: rates, loads and repairs."""

from __future__ import annotations

from msgspec import Struct

from smarttestudo.optimizer.infeasibility import Infeasibility
from smarttestudo.optimizer.model import Model
from smarttestudo.use_cases.ruler.checked_text import Draft
from smarttestudo.use_cases.ruler.optimizing import OptimizedDraft, Repair, optimize_draft, repairs_of
from smarttestudo.use_cases.ruler.situations import SituationLoad, id_at, situations_of


class OptimizeRequest(Draft, frozen=True, kw_only=True):
    """``POST /api/optimize`` → ``OptimizeAnswer``; 409 with findings for rules with errors."""

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
    part = refused.solved.part
    return Refusal(
        rule=None if part.label is None else id_at(optimized.checked.document, part.span.line),
        message=refused.message,
        needs_kb_per_s=refused.solved.needs_kb_per_s,
        repairs=tuple(repairs_of(optimized, refused)),
    )
