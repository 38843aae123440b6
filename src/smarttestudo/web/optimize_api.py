# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the page asks of the optimizer."""

from __future__ import annotations

from smarttestudo.adirf.document import Document
from smarttestudo.composition.optimize_json import optimize_json
from smarttestudo.composition.ruler.checked_text import Draft
from smarttestudo.composition.ruler.optimizing import OptimizedDraft, Repair, optimize_draft, repairs_of
from smarttestudo.composition.ruler.situations import LoadedSituation, situations_of
from smarttestudo.optimizer.infeasibility import Infeasibility
from smarttestudo.web import schemas as schema
from smarttestudo.web.utf16 import Utf16


def optimize(request: schema.OptimizeRequest) -> schema.OptimizeAnswer:
    """Rates, loads and repairs."""
    draft = Draft(
        text=request.text,
        name=request.name,
        profile_text=request.profile_text,
        profile_name=request.profile_name,
    )
    optimized = optimize_draft(draft, request.model, only_named=request.only_named)
    outcome, document = optimized.outcome, optimized.checked.document
    return schema.OptimizeAnswer(
        feasible=outcome.optimization.feasible,
        budget_kb_per_s=outcome.optimization.budget_kb_per_s,
        situations=tuple(_situation(one, document) for one in situations_of(optimized)),
        refusals=tuple(_refusal(optimized, one) for one in outcome.infeasible),
        download_text=outcome.rewritten,
        result=optimize_json(outcome),
    )


def _situation(situation: LoadedSituation, document: Document) -> schema.SituationModel:
    return schema.SituationModel(
        kind=situation.kind.value,
        title=situation.title,
        rules=tuple(filter(None, (_id_at(document, line) for line in situation.lines))),
        state={str(signal): value for signal, value in situation.state.items()},
        loads=tuple(
            schema.TopicLoad(topic=load.topic, rate_hz=load.rate.to_json(), kb_per_s=load.kb_per_s)
            for load in situation.loads
        ),
        kb_per_s=situation.kb_per_s,
        feasible=situation.feasible,
    )


def _refusal(optimized: OptimizedDraft, refused: Infeasibility) -> schema.Refusal:
    document, part = optimized.checked.document, refused.solved.part
    utf16 = Utf16(document.text)
    return schema.Refusal(
        rule=None if part.label is None else _id_at(document, part.span.line),
        message=refused.message,
        needs_kb_per_s=refused.solved.needs_kb_per_s,
        repairs=tuple(_repair(one, utf16) for one in repairs_of(optimized, refused)),
    )


def _repair(repair: Repair, utf16: Utf16) -> schema.Repair:
    return schema.Repair(
        title=repair.title,
        edits=tuple(
            schema.RepairEdit(
                offset=utf16.offset(one.start), end_offset=utf16.offset(one.end), replacement=one.replacement
            )
            for one in repair.splices
        ),
        budget_kb_per_s=repair.budget_kb_per_s,
    )


def _id_at(document: Document, line: int) -> str | None:
    """The statement that starts on ``line``; of several the first."""
    found = (one.id for one in document.entries if one.stretch.tokens[0].line == line)
    return next(found, None)
