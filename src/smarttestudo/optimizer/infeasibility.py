# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Messages about a subproblem that does not fit."""

from __future__ import annotations

import math
from dataclasses import dataclass

from smarttestudo.domain.finding import Finding, Severity
from smarttestudo.optimizer.changes import Change, most_saved, reductions_of
from smarttestudo.optimizer.model import Model, Requirement
from smarttestudo.optimizer.problem import fits
from smarttestudo.optimizer.rule_rates import SolvedSubproblem
from smarttestudo.optimizer.wording import enough_kb_text, kb_text, listed, wanted_text

CODE = "infeasible"
_TOPICS_NAMED = 4


@dataclass(frozen=True, slots=True, kw_only=True)
class Infeasibility:
    """A subproblem that does not fit: what it lacks in a sentence, the smallest change, and what would do."""

    solved: SolvedSubproblem
    change: Change | None
    message: str
    remedies: tuple[str, ...]

    def finding(self) -> Finding:
        """In the checker's words."""
        return Finding(
            code=CODE,
            severity=Severity.ERROR,
            message=self.message,
            path=self.solved.subproblem.path,
            span=self.solved.subproblem.span,
            hint="; ".join(self.remedies),
        )


def infeasibility(
    solved: SolvedSubproblem,
    budget_kb_per_s: float,
    *,
    model: Model,
    change: Change | None = None,
    enough_kb_per_s: float | None = None,
) -> Infeasibility:
    """The words on ``solved``, which does not fit, and on what would do, as far as that was looked for.

    ``enough_kb_per_s`` is the budget that would do.
    """
    name = (
        f'"{solved.subproblem.label}" needs' if solved.subproblem.label is not None else "the defaults need"
    )
    over = solved.needs_kb_per_s - budget_kb_per_s
    message = (
        f"{name} at least {enough_kb_text(solved.needs_kb_per_s)} KB/s, "
        f"{enough_kb_text(over)} more than the budget of {kb_text(budget_kb_per_s)}: {_takers(solved, model)}"
    )
    remedies = [] if change is None else [change_text(change)]
    saved = most_saved(reductions_of(solved, budget_kb_per_s, model=model))
    if not fits(over, math.fsum(saved.values())):
        remedies.append("no lower levels of these topics fit")
    if enough_kb_per_s is not None:
        remedies.append(f"a budget of {enough_kb_text(enough_kb_per_s)} KB/s would do")
    return Infeasibility(solved=solved, change=change, message=message, remedies=tuple(remedies))


def _takers(solved: SolvedSubproblem, model: Model) -> str:
    """The KB/s that each topic takes, the largest first."""
    takes = {
        topic: _least_kb_per_s(requirement, model)
        for topic, requirement in solved.subproblem.requirements.items()
    }
    named = sorted((topic for topic in takes if takes[topic] > 0), key=lambda topic: (-takes[topic], topic))
    parts = [
        f"{topic} {wanted_text(solved.subproblem.requirements[topic].wanted)} takes {kb_text(takes[topic])}"
        for topic in named[:_TOPICS_NAMED]
    ]
    unnamed = sum(takes[topic] for topic in named[_TOPICS_NAMED:])
    if unnamed:
        parts.append(f"{len(named) - _TOPICS_NAMED} more take {kb_text(unnamed)}")
    if solved.others_kb_per_s > 0:
        parts.append(f"the other topics' defaults {kb_text(solved.others_kb_per_s)}")
    return listed(parts) if parts else "nothing is asked for"


def _least_kb_per_s(requirement: Requirement, model: Model) -> float:
    return requirement.needs.size_kb * requirement.bounds_hz(model)[0]


def change_text(change: Change, *, named: int | None = None) -> str:
    """The change as a sentence, with all of its topics, or about as many as ``named`` and how many more."""
    parts = [f"{one.topic} {wanted_text(one.wanted)}" for one in change.reductions]
    if named is not None and len(parts) > named + 1:
        parts[named:] = [f"{len(parts) - named} more"]
    names = listed(parts)
    verb = "fits" if len(change.reductions) == 1 else "together fit"
    return f"{names} {verb} with {kb_text(change.needs_kb_per_s)} KB/s"
