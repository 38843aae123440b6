# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Why the rates are what they are: one row a topic, the price of bandwidth, and what-ifs solved anew."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from enum import Enum

from smarttestudo.domain.dataclass import dataclass
from smarttestudo.domain.rate import Tier
from smarttestudo.optimizer.model import Model, Requirement
from smarttestudo.optimizer.quality import interval_hz, skipped_thresholds, tier_of
from smarttestudo.optimizer.rule_rates import SolvedSubproblem
from smarttestudo.optimizer.wording import enough_kb_text, hz_text, kb_text, listed

KB_PER_MB = 1000.0
WHAT_IFS_SHOWN = 3
_TOPICS_NAMED = 3

Resolve = Callable[[dict[str, Requirement], float], SolvedSubproblem]
"""A subproblem solved anew with some requirements replaced and so much more budget in KB/s."""


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
    """A feasible part: its rows, largest first, and sentences."""

    rows: tuple[TopicRow, ...]
    price: str
    what_ifs: tuple[str, ...]
    notes: tuple[str, ...]


def explain_subproblem(
    solved: SolvedSubproblem, budget_kb_per_s: float, *, model: Model, solve_again: Resolve
) -> SubproblemExplanation:
    """The explanation of a subproblem that fits."""
    rates_hz = solved.rates_hz
    if rates_hz is None:
        raise ValueError("only a part that fits has rates to explain")
    rows = [
        _row(requirement, rates_hz[topic], budget_kb_per_s, model, is_worth_more=solved.price > 0)
        for topic, requirement in solved.subproblem.requirements.items()
    ]
    largest_first = sorted(rows, key=lambda row: (-row.kb_per_s, row.topic))
    what_ifs = (
        *_lower(solved, largest_first, solve_again),
        *_higher(solved, largest_first, budget_kb_per_s, model, solve_again),
    )
    return SubproblemExplanation(
        rows=tuple(largest_first),
        price=_price(solved, budget_kb_per_s, solve_again),
        what_ifs=what_ifs,
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


def _price(solved: SolvedSubproblem, budget_kb_per_s: float, solve_again: Resolve) -> str:
    """The gain of one MB/s more."""
    if solved.price <= 0:
        free = max(0.0, budget_kb_per_s - solved.used_kb_per_s)
        return f"More bandwidth would improve nothing: {kb_text(free)} KB/s of the budget stay unused."
    gains = _changes(solved, solve_again({}, KB_PER_MB))
    return (
        f"One MB/s more would raise {gains}." if gains else "One MB/s more would raise no rate by 0.001 Hz."
    )


def _lower(solved: SolvedSubproblem, rows: list[TopicRow], solve_again: Resolve) -> Iterator[str]:
    """One level less for the largest topics, and whom that would lift."""
    if solved.price <= 0:
        return
    lowerable = [row for row in rows if isinstance(row.wanted, Tier) and row.wanted.level]
    for row in lowerable[:WHAT_IFS_SHOWN]:
        requirement = solved.subproblem.requirements[row.topic]
        lower = (
            list(Tier)[requirement.wanted.level - 1]
            if isinstance(requirement.wanted, Tier)
            else Tier.UNACCEPTABLE
        )
        again = solve_again({row.topic: replace(requirement, wanted=lower)}, 0.0)
        gains = _changes(solved, again)
        if again.rates_hz is None or not gains:
            continue
        freed = requirement.needs.size_kb * (row.rate_hz - again.rates_hz[row.topic])
        yield f"{row.topic} {lower.value} would free {kb_text(freed)} KB/s and raise {gains}."


def _higher(
    solved: SolvedSubproblem,
    rows: list[TopicRow],
    budget_kb_per_s: float,
    model: Model,
    solve_again: Resolve,
) -> Iterator[str]:
    """The next level of the largest topics: what it would give, or what is missing."""
    if model in {Model.BUDGET, Model.PRIORITY}:
        return
    raisable = [row for row in rows if isinstance(row.wanted, Tier) and row.wanted is not Tier.EXCESSIVE]
    for row in raisable[:WHAT_IFS_SHOWN]:
        requirement = solved.subproblem.requirements[row.topic]
        higher = (
            list(Tier)[requirement.wanted.level + 1]
            if isinstance(requirement.wanted, Tier)
            else Tier.EXCESSIVE
        )
        again = solve_again({row.topic: replace(requirement, wanted=higher)}, 0.0)
        if again.rates_hz is None:
            missing = again.needs_kb_per_s - budget_kb_per_s
            yield f"{row.topic} {higher.value} would need {enough_kb_text(missing)} KB/s more."
        elif again.rates_hz[row.topic] > row.rate_hz:
            yield f"{row.topic} {higher.value} would fit, with {hz_text(again.rates_hz[row.topic])} Hz."


def _changes(before: SolvedSubproblem, after: SolvedSubproblem) -> str:
    """``/imu from 150 to 200 Hz and /scan …``: the rates that rise, those that rise most first."""
    if before.rates_hz is None or after.rates_hz is None:
        return ""
    rises = {
        topic: rate - before.rates_hz[topic]
        for topic, rate in after.rates_hz.items()
        if rate > before.rates_hz[topic]
    }
    named = sorted(rises, key=lambda topic: (-rises[topic], topic))[:_TOPICS_NAMED]
    parts = [
        f"{topic} from {hz_text(before.rates_hz[topic])} to {hz_text(after.rates_hz[topic])} Hz"
        for topic in named
    ]
    if len(rises) > len(named):
        parts.append(f"{len(rises) - len(named)} more")
    return listed(parts) if parts else ""


def _skipped(solved: SolvedSubproblem) -> Iterator[str]:
    """The thresholds that the envelope passes over."""
    for topic, requirement in solved.subproblem.requirements.items():
        if isinstance(requirement.wanted, Tier):
            tiers_hz = requirement.needs.tiers_hz
            names = [f"τ{index} ({hz_text(tiers_hz[index])} Hz)" for index in skipped_thresholds(tiers_hz)]
            if names:
                yield f"{topic}: the envelope skips {listed(names)}; a Hz is worth the same on both sides."
