# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""OBI over rule files: the defaults once, then each block's topics with the others at their default."""

from __future__ import annotations

import bisect
import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from smarttestudo.domain.profile import Profile
from smarttestudo.domain.rate import Rate, Tier
from smarttestudo.language.known_types import NO_TYPES, KnownTypes
from smarttestudo.language.normal_form import Resolve
from smarttestudo.language.syntax import (
    KeepWithin,
    RuleFile,
    SetFrequency,
)
from smarttestudo.language.syntax_walks import (
    bound_span,
)
from smarttestudo.optimizer.model import MissingEntryError, Model, Requirement
from smarttestudo.optimizer.problem import Allocation, allocate, exact_sum, fits, round_down, used_kb_per_s
from smarttestudo.optimizer.requirements import (
    RuleRequirements,
    StatementKey,
    Subproblem,
    TopicsWithoutDefault,
    collect_requirements,
    topic_of,
)

_LEVELS = 5


@dataclass(frozen=True, slots=True, kw_only=True)
class Ladder:
    """The rates that bring a topic from quality 0 to 5 (τ0 … τ4 are 1 … 5), within its bounds."""

    topic: str
    size_kb: float
    least_hz: float
    most_hz: float
    tiers_hz: Sequence[float]

    def rate_hz(self, quality: float) -> float:
        """The rate that brings ``quality``, or the nearest that the bounds allow."""
        level = min(int(quality), _LEVELS - 1)
        low_hz = self.tiers_hz[level - 1] if level else 0.0
        rate_hz = low_hz + (quality - level) * (self.tiers_hz[level] - low_hz)
        return min(max(rate_hz, self.least_hz), self.most_hz)

    def quality(self, rate_hz: float) -> float:
        """The quality that ``rate_hz`` brings."""
        level = bisect.bisect_right(self.tiers_hz, rate_hz, hi=_LEVELS)
        if level == _LEVELS:
            return float(_LEVELS)
        low_hz = self.tiers_hz[level - 1] if level else 0.0
        return level + (rate_hz - low_hz) / (self.tiers_hz[level] - low_hz)

    @property
    def corners(self) -> tuple[float, ...]:
        """The qualities at which the cost of a little more quality changes."""
        return (*range(_LEVELS + 1), self.quality(self.least_hz), self.quality(self.most_hz))


def level_out(ladders: Sequence[Ladder], budget_kb_per_s: float) -> Allocation | None:
    """The rates whose sorted qualities are the greatest, lowest first; ``None`` where none fit.

    With one budget and worths that rise with the rate, that is one common quality for all topics that have
    not reached a bound of their own. ``price`` is its rise for one KB/s more.
    """
    corners = sorted({corner for ladder in ladders for corner in ladder.corners} | {0.0, float(_LEVELS)})
    if not fits(_cost(ladders, 0.0), budget_kb_per_s):
        return None
    # The cost rises with the quality and the first corner fits: bisection finds the last one that does.
    too_much = bisect.bisect_left(corners, 1, key=lambda q: not fits(_cost(ladders, q), budget_kb_per_s))
    last = too_much - 1
    quality, price = corners[last], 0.0
    for low, high in itertools.islice(itertools.pairwise(corners), last, last + 1):
        start, end = _cost(ladders, low), _cost(ladders, high)
        quality += (high - low) * max(0.0, budget_kb_per_s - start) / (end - start)
        price = (high - low) / (end - start)
    rates_hz = {ladder.topic: ladder.rate_hz(quality) for ladder in ladders}
    return Allocation(rates_hz=rates_hz, price=price)


def _cost(ladders: Sequence[Ladder], quality: float) -> float:
    return math.fsum(ladder.size_kb * ladder.rate_hz(quality) for ladder in ladders)


_AMPLE = 1 - 1e-9
"""What takes no more than this share of a budget is far enough within it for any rounding of sums."""


def best_rates(
    model: Model,
    requirements: Sequence[Requirement],
    bounds_hz: Sequence[tuple[float, float]],
    budget_kb_per_s: float,
) -> Allocation | None:
    """The best rates in Hz under ``model``, not yet rounded; ``None`` where they do not fit together.

    ``bounds_hz`` are the lowest and highest rates of the ``requirements``.
    """
    asked = [*zip(requirements, bounds_hz, strict=True)]
    if model is Model.MAXMIN:
        return level_out([_ladder(one, *bounds) for one, bounds in asked], budget_kb_per_s)
    most_kb_per_s = used_kb_per_s([(one.needs.size_kb, most_hz) for one, (_, most_hz) in asked])
    if model.every_hz_counts and most_kb_per_s <= _AMPLE * budget_kb_per_s:
        rates_hz = {one.needs.name: least_hz + (most_hz - least_hz) for one, (least_hz, most_hz) in asked}
        return Allocation(rates_hz=rates_hz, price=0.0)
    demands = [one.demand(model, *bounds) for one, bounds in asked]
    return allocate(demands, budget_kb_per_s)


def rounded_down(rates_hz: Mapping[str, float], least_hz: Mapping[str, float]) -> dict[str, float]:
    """The rates rounded down to 0.001 Hz, but never below the lowest rate of their topic."""
    return {topic: max(round_down(rate), least_hz[topic]) for topic, rate in rates_hz.items()}


def _ladder(requirement: Requirement, least_hz: float, most_hz: float) -> Ladder:
    # A topic with a written rate stands on one rung, whatever its tiers.
    tiers_hz = requirement.needs.tiers_hz if isinstance(requirement.wanted, Tier) else (least_hz,) * len(Tier)
    return Ladder(
        topic=requirement.needs.name,
        size_kb=requirement.needs.size_kb,
        least_hz=least_hz,
        most_hz=most_hz,
        tiers_hz=tiers_hz,
    )


_BUDGET_STEP_KB_PER_S = 0.005


@dataclass(frozen=True, slots=True, kw_only=True)
class SolvedSubproblem:
    """The rates of one subproblem in Hz by the names of its requirements, ``None`` where it does not fit.

    ``others_kb_per_s`` is what the other topics take at their default, ``needs_kb_per_s`` the least that all
    topics together can do with, ``used_kb_per_s`` what they take (where nothing fits: the same least).
    ``price`` is what one KB/s more would gain in the model's own unit, 0 where it would gain nothing.
    """

    subproblem: Subproblem
    rates_hz: Mapping[str, float] | None
    others_kb_per_s: float
    needs_kb_per_s: float
    used_kb_per_s: float
    model: Model
    price: float = 0.0

    @property
    def feasible(self) -> bool:
        return self.rates_hz is not None

    @property
    def topic_rates_hz(self) -> dict[str, float]:
        """The rates of topics that count by them."""
        requirements = self.subproblem.requirements
        return {
            name: hz for name, hz in (self.rates_hz or {}).items() if name == requirements[name].needs.topic
        }

    @property
    def bounds(self) -> dict[str, float]:
        """The bounds of levels, by the names of their requirements."""
        found = {
            name: self.subproblem.requirements[name].bound(hz, self.model)
            for name, hz in (self.rates_hz or {}).items()
        }
        return {name: bound for name, bound in found.items() if bound is not None}


@dataclass(frozen=True, slots=True, kw_only=True)
class Optimization:
    """The result for one rule set; where the defaults do not fit, blocks are solved beside their least."""

    model: Model
    budget_kb_per_s: float
    defaults: SolvedSubproblem
    blocks: tuple[SolvedSubproblem, ...]
    appended: tuple[str, ...]
    tier_rates_hz: Mapping[StatementKey, float] = field(default_factory=dict)
    tier_bounds: Mapping[StatementKey, float] = field(default_factory=dict)

    @property
    def feasible(self) -> bool:
        return all(subproblem.feasible for subproblem in self.subproblems)

    @property
    def subproblems(self) -> tuple[SolvedSubproblem, ...]:
        return (self.defaults, *self.blocks)

    @property
    def appended_rates(self) -> dict[str, Rate]:
        """The rates of the appended topics: Full where they have no levels; none where they do not fit."""
        requirements, rates_hz = self.defaults.subproblem.requirements, self.defaults.rates_hz or {}
        return {
            topic: Rate(rates_hz[topic]) if isinstance(requirements[topic].wanted, Tier) else Rate.full()
            for topic in self.appended
            if topic in rates_hz
        }

    def tier_rate(self, statement: SetFrequency, path: str, /) -> Rate:
        """As ``TierValues``; ``KeyError`` for a subproblem that does not fit."""
        return Rate(self.tier_rates_hz[path, statement.rate.span])

    def tier_bound(self, statement: KeepWithin, path: str, /) -> float:
        """As ``TierValues``; ``KeyError`` for a subproblem that does not fit."""
        return self.tier_bounds[path, bound_span(statement)]


def budget_of(profile: Profile) -> float:
    """The profile's budget in KB/s; ``MissingEntryError`` where it has none."""
    if profile.budget_kb_per_s is None:
        raise MissingEntryError(
            "the profile has no budget_kb_per_s",
            path=profile.path,
            remedy="add budget_kb_per_s, what the link carries in KB/s",
            topic=None,
            key="budget_kb_per_s",
        )
    return profile.budget_kb_per_s


def optimize_rules(
    files: Sequence[RuleFile],
    profile: Profile,
    resolve: Resolve,
    *,
    model: Model,
    without_default: TopicsWithoutDefault = TopicsWithoutDefault.APPENDED,
    types: KnownTypes = NO_TYPES,
) -> Optimization:
    """The value of every level in ``files``, which have no errors; ``ProfileError`` for what is missing."""
    requirements = collect_requirements(files, profile, resolve, without_default, types)
    return solve_requirements(requirements, budget_of(profile), model=model)


def solve_requirements(
    requirements: RuleRequirements, budget_kb_per_s: float, *, model: Model
) -> Optimization:
    """The defaults, then each block's topics with all others at their default."""
    defaults = solve_subproblem(requirements.defaults, 0.0, budget_kb_per_s, model=model)
    rates_hz = defaults.rates_hz or {
        name: requirement.bounds_hz(model)[0]
        for name, requirement in requirements.defaults.requirements.items()
    }
    loads = _DefaultLoads(requirements.defaults, rates_hz)
    blocks = [
        solve_subproblem(subproblem.limited(rates_hz), loads.beside(subproblem), budget_kb_per_s, model=model)
        for subproblem in requirements.blocks
    ]
    solved = [one for one in (defaults, *blocks) if one.rates_hz is not None]
    return Optimization(
        model=model,
        budget_kb_per_s=budget_kb_per_s,
        defaults=defaults,
        blocks=tuple(blocks),
        appended=requirements.appended,
        tier_rates_hz={key: hz for one in solved for key, hz in _tier_rates_hz(one)},
        tier_bounds={key: bound for one in solved for key, bound in _tier_bounds(one)},
    )


def _tier_rates_hz(solved: SolvedSubproblem) -> Iterator[tuple[StatementKey, float]]:
    yield from solved.subproblem.ceilings_hz
    for key, requirement, rate_hz in _tiers(solved):
        if requirement.needs.name == requirement.needs.topic:
            yield key, rate_hz


def _tier_bounds(solved: SolvedSubproblem) -> Iterator[tuple[StatementKey, float]]:
    yield from solved.subproblem.unmeasured_bounds
    for key, requirement, rate_hz in _tiers(solved):
        bound = requirement.bound(rate_hz, solved.model)
        if bound is not None:
            yield key, bound


def _tiers(solved: SolvedSubproblem) -> Iterator[tuple[StatementKey, Requirement, float]]:
    """The statements that name a level, with what they require and the rate that it got."""
    requirements, rates_hz = solved.subproblem.requirements, solved.rates_hz or {}
    for key, name in solved.subproblem.tier_statements:
        if name in rates_hz:
            yield key, requirements[name], rates_hz[name]


class _DefaultLoads:
    """Loads of topics at their default, in KB/s, so that a block looks at its own topics only.

    The sum of all is kept without rounding: what is left without some of them is rounded once, as if the
    others had been added.
    """

    def __init__(self, defaults: Subproblem, rates_hz: Mapping[str, float]) -> None:
        self._rates_hz = rates_hz
        self._sizes_kb = {name: one.needs.size_kb for name, one in defaults.requirements.items()}
        taken = {name: self._sizes_kb[name] * rate_hz for name, rate_hz in rates_hz.items()}
        self._all = exact_sum(taken.values())
        self._without: dict[str, list[float]] = {}
        for name, kb_per_s in taken.items():
            self._without.setdefault(topic_of(name), []).append(-kb_per_s)

    def beside(self, subproblem: Subproblem) -> float:
        """Sum of all topics that ``subproblem`` leaves as they are, and of what it keeps of its own."""
        topics = {topic_of(name) for name in (*subproblem.requirements, *subproblem.kept)}
        own = [less for topic in topics for less in self._without.get(topic, ())]
        kept = [
            self._sizes_kb[name] * min(self._rates_hz[name], limit_hz)
            for name, limit_hz in subproblem.kept.items()
        ]
        return math.fsum((*self._all, *own, *kept))


def enough_kb_per_s(solved: SolvedSubproblem, done: Optimization) -> float:
    """The least budget with which ``solved`` of ``done`` would fit, at most 0.005 KB/s above it.

    Of a greater budget, the defaults beside a block take more, too.
    """
    low = solved.needs_kb_per_s
    if solved.subproblem.label is None:
        return low
    defaults = done.defaults.subproblem

    def needed(rates_hz: Mapping[str, float]) -> float:
        own = solved.subproblem.limited(rates_hz)
        least = [(one.needs.size_kb, one.bounds_hz(done.model)[0]) for one in own.requirements.values()]
        return _DefaultLoads(defaults, rates_hz).beside(own) + used_kb_per_s(least)

    def is_enough(budget: float) -> bool:
        found = solve_subproblem(defaults, 0.0, budget, model=done.model)
        return found.rates_hz is not None and fits(needed(found.rates_hz), budget)

    if is_enough(low):
        return low
    high = needed({name: one.bounds_hz(done.model)[1] for name, one in defaults.requirements.items()})
    while high - low > _BUDGET_STEP_KB_PER_S:
        middle = (low + high) / 2
        low, high = (low, middle) if is_enough(middle) else (middle, high)
    return high


def solve_subproblem(
    subproblem: Subproblem, others_kb_per_s: float, budget_kb_per_s: float, *, model: Model
) -> SolvedSubproblem:
    """The rates of one subproblem, where all other topics take ``others_kb_per_s`` of the budget."""
    requirements = [*subproblem.requirements.values()]
    bounds_hz = [one.bounds_hz(model) for one in requirements]
    least_hz = [least for least, _ in bounds_hz]
    sizes_kb = [one.needs.size_kb for one in requirements]
    own_least = used_kb_per_s(zip(sizes_kb, least_hz, strict=True))
    needs = others_kb_per_s + own_least
    found = None
    if fits(needs, budget_kb_per_s):
        # What is left may be below the least by float noise, which must not make it infeasible.
        own_budget = max(budget_kb_per_s - others_kb_per_s, own_least)
        found = best_rates(model, requirements, bounds_hz, own_budget)
    if found is None:
        return SolvedSubproblem(
            subproblem=subproblem,
            model=model,
            rates_hz=None,
            others_kb_per_s=others_kb_per_s,
            needs_kb_per_s=needs,
            used_kb_per_s=needs,
        )
    rates_hz = rounded_down(found.rates_hz, dict(zip(subproblem.requirements, least_hz, strict=True)))
    own = used_kb_per_s(zip(sizes_kb, [rates_hz[name] for name in subproblem.requirements], strict=True))
    return SolvedSubproblem(
        subproblem=subproblem,
        model=model,
        rates_hz=rates_hz,
        others_kb_per_s=others_kb_per_s,
        needs_kb_per_s=needs,
        used_kb_per_s=others_kb_per_s + own,
        price=found.price,
    )
