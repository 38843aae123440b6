# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Reductions of what topics are asked for, with which everything fits."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from smarttestudo.domain.rate import Tier
from smarttestudo.optimizer.model import BoundNeeds, Model, Requirement
from smarttestudo.optimizer.problem import round_down
from smarttestudo.optimizer.rule_rates import SolvedSubproblem

_NUMBER_STEPS = 5


@dataclass(frozen=True, slots=True, kw_only=True)
class Reduction:
    """One topic asked for less: at ``wanted``, ``steps`` levels (or fifths of a number) lower."""

    topic: str
    wanted: Tier | float
    steps: int
    saved_kb_per_s: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Change:
    """Reductions that fit together, and the least that all topics can then do with."""

    reductions: tuple[Reduction, ...]
    needs_kb_per_s: float


def reductions_of(solved: SolvedSubproblem, budget_kb_per_s: float, *, model: Model) -> Sequence[Reduction]:
    """All that can be asked of the topics of ``solved``, which is above the budget."""
    excess = solved.needs_kb_per_s - budget_kb_per_s
    return [
        reduction
        for topic in sorted(solved.subproblem.requirements)
        for reduction in _reductions(solved.subproblem.requirements[topic], excess, model)
    ]


def most_saved(reductions: Sequence[Reduction]) -> Mapping[str, float]:
    """The KB/s that each topic saves at most."""
    saved: dict[str, float] = {}
    for one in reductions:
        saved[one.topic] = max(one.saved_kb_per_s, saved.get(one.topic, 0.0))
    return saved


def _reductions(requirement: Requirement, excess_kb_per_s: float, model: Model) -> Iterator[Reduction]:
    """Lower requirements of one topic that save anything, the smallest first; none of a written bound."""
    if isinstance(requirement.needs, BoundNeeds) and not isinstance(requirement.wanted, Tier):
        return
    size_kb = requirement.needs.size_kb
    asked_hz = requirement.bounds_hz(model)[0]
    for steps, wanted in enumerate(_lower(requirement.wanted, excess_kb_per_s / size_kb), start=1):
        lower_hz = Requirement(needs=requirement.needs, wanted=wanted).bounds_hz(model)[0]
        if requirement.needs.floor_hz <= lower_hz < asked_hz:
            saved = size_kb * (asked_hz - lower_hz)
            yield Reduction(topic=requirement.needs.name, wanted=wanted, steps=steps, saved_kb_per_s=saved)


def _lower(wanted: Tier | float, excess_hz: float) -> Iterator[Tier | float]:
    if isinstance(wanted, Tier):
        yield from reversed(list(Tier)[: wanted.level])
        return
    enough = round_down(wanted - excess_hz)
    for fifths in range(_NUMBER_STEPS - 1, 0, -1):
        lower, higher = wanted * fifths / _NUMBER_STEPS, wanted * (fifths + 1) / _NUMBER_STEPS
        # Where less than a whole step is enough, the rate that just fits stands for the step.
        yield enough if lower <= enough < higher else round_down(lower)
