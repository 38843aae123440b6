# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Why the rates are what they are, and where they do not fit, what would."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum

from smarttestudo.domain.finding import Finding, Severity
from smarttestudo.domain.rate import Tier
from smarttestudo.optimizer.model import BoundNeeds, Model, Requirement
from smarttestudo.optimizer.problem import fits, interval_hz, round_down, skipped_thresholds, tier_of
from smarttestudo.optimizer.rule_rates import SolvedSubproblem
from smarttestudo.optimizer.wording import enough_kb_text, hz_text, kb_text, listed, wanted_text

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
        topic: requirement.needs.size_kb * requirement.bounds_hz(model)[0]
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


def change_text(change: Change, *, named: int | None = None) -> str:
    """The change as a sentence, with all of its topics, or about as many as ``named`` and how many more."""
    parts = [f"{one.topic} {wanted_text(one.wanted)}" for one in change.reductions]
    if named is not None and len(parts) > named + 1:
        parts[named:] = [f"{len(parts) - named} more"]
    names = listed(parts)
    verb = "fits" if len(change.reductions) == 1 else "together fit"
    return f"{names} {verb} with {kb_text(change.needs_kb_per_s)} KB/s"


class Binding(Enum):
    """A reason that holds a rate where it is."""

    WRITTEN = "written as a number"
    FLOOR = "its floor"
    LEVEL_LOW = "the lower end of its level"
    LEVEL_HIGH = "the upper end of its level"
    CEILING = "its highest useful rate"
    WORTH = "a higher rate adds no quality"
    BUDGET = "the budget"


@dataclass(frozen=True, slots=True, kw_only=True)
class TopicRow:
    """One topic of a subproblem: required and given, its share of the budget, and what holds it there.

    ``level`` is that of the rate, ``None`` where the profile has no tiers. Of a bound with a level, ``topic``
    is followed by the property, and ``rate_hz`` is what ``bound`` needs.
    """

    topic: str
    wanted: Tier | float
    level: Tier | None
    rate_hz: float
    kb_per_s: float
    share: float
    binding: Binding
    bound: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class SubproblemExplanation:
    """A feasible part: its rows, largest first, and notes on the thresholds that its model passes over."""

    rows: tuple[TopicRow, ...]
    notes: tuple[str, ...]


def explain_subproblem(
    solved: SolvedSubproblem, budget_kb_per_s: float, *, model: Model
) -> SubproblemExplanation:
    rates_hz = solved.rates_hz
    if rates_hz is None:
        raise ValueError("only a part that fits has rates to explain")
    rows = [
        _row(requirement, rates_hz[topic], budget_kb_per_s, model, is_worth_more=solved.price > 0)
        for topic, requirement in solved.subproblem.requirements.items()
    ]
    return SubproblemExplanation(
        rows=tuple(sorted(rows, key=lambda row: (-row.kb_per_s, row.topic))),
        notes=tuple(_skipped(solved)) if model is Model.BENEFIT else (),
    )


def _row(
    requirement: Requirement, rate_hz: float, budget_kb_per_s: float, model: Model, *, is_worth_more: bool
) -> TopicRow:
    kb_per_s = requirement.needs.size_kb * rate_hz
    return TopicRow(
        topic=requirement.needs.name,
        wanted=requirement.wanted,
        level=_level(requirement, rate_hz) if requirement.needs.has_tiers else None,
        rate_hz=rate_hz,
        kb_per_s=kb_per_s,
        share=kb_per_s / budget_kb_per_s if budget_kb_per_s else math.nan,
        binding=_binding(requirement, rate_hz, model, is_worth_more=is_worth_more),
        bound=requirement.bound(rate_hz, model),
    )


def _level(requirement: Requirement, rate_hz: float) -> Tier:
    # A rate at the border of two levels is of the one that was asked for.
    if isinstance(requirement.wanted, Tier):
        low_hz, high_hz = interval_hz(requirement.wanted, requirement.needs.tiers_hz)
        if low_hz <= rate_hz <= high_hz:
            return requirement.wanted
    return tier_of(rate_hz, requirement.needs.tiers_hz)


def _binding(requirement: Requirement, rate_hz: float, model: Model, *, is_worth_more: bool) -> Binding:
    if not isinstance(requirement.wanted, Tier):
        return Binding.WRITTEN
    least_hz, most_hz = requirement.bounds_hz(model)
    if rate_hz >= most_hz > least_hz or rate_hz >= most_hz > requirement.needs.floor_hz:
        return Binding.CEILING if model in {Model.BUDGET, Model.PRIORITY} else Binding.LEVEL_HIGH
    if rate_hz <= least_hz and least_hz > 0:
        return Binding.FLOOR if least_hz == requirement.needs.floor_hz else Binding.LEVEL_LOW
    if model in {Model.BENEFIT, Model.MAXMIN} and rate_hz >= requirement.needs.tiers_hz[4]:
        return Binding.WORTH
    return Binding.BUDGET if is_worth_more else Binding.WORTH


def _skipped(solved: SolvedSubproblem) -> Iterator[str]:
    """The thresholds that the envelope passes over."""
    for topic, requirement in solved.subproblem.requirements.items():
        if isinstance(requirement.wanted, Tier):
            tiers_hz = requirement.needs.tiers_hz
            names = [f"τ{index} ({hz_text(tiers_hz[index])} Hz)" for index in skipped_thresholds(tiers_hz)]
            if names:
                yield f"{topic}: the envelope skips {listed(names)}; a Hz is worth the same on both sides."
