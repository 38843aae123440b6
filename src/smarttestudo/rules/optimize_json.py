# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The optimizer's answer as ``--json`` prints it."""

from __future__ import annotations

from smarttestudo.domain.rate import Tier
from smarttestudo.optimizer.changes import Change
from smarttestudo.optimizer.explanation import SubproblemExplanation, TopicRow
from smarttestudo.optimizer.infeasibility import Infeasibility
from smarttestudo.optimizer.rule_rates import SolvedSubproblem
from smarttestudo.rules.optimize import OptimizeOutcome

_DECIMALS = 6


def optimize_json(outcome: OptimizeOutcome) -> dict[str, object]:
    """One object: defaults and blocks with their rates, what they use, and why."""
    done = outcome.optimization
    explained = {id(solved): explanation for solved, explanation in outcome.explained()}
    refused = {id(one.solved): one for one in outcome.infeasible}
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
        "topics": {one.topic: _wanted(one.wanted) for one in change.reductions},
        "needs_kb_per_s": round(change.needs_kb_per_s, _DECIMALS),
    }


def _wanted(wanted: Tier | float) -> str | float:
    return wanted.value if isinstance(wanted, Tier) else wanted
