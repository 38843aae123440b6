# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Why the rates are what they are: one row a topic, with the border that holds its rate there."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum

from smarttestudo.domain.rate import Tier
from smarttestudo.optimizer.model import Model, Requirement
from smarttestudo.optimizer.quality import interval_hz, skipped_thresholds, tier_of
from smarttestudo.optimizer.rule_rates import SolvedSubproblem
from smarttestudo.optimizer.wording import hz_text, listed


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
    """The explanation of a subproblem that fits."""
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
