# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""OBI over rule files: the defaults once, then each block's topics with the others at their default."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from smarttestudo.domain.profile import Profile
from smarttestudo.domain.rate import Rate
from smarttestudo.language.normal_form import Resolve
from smarttestudo.language.syntax import KeepWithin, RuleFile, SetFrequency, bound_span
from smarttestudo.optimizer.allocation import best_rates, rounded_down
from smarttestudo.optimizer.model import MissingEntryError, Model
from smarttestudo.optimizer.problem import Solver, fits, used_kb_per_s
from smarttestudo.optimizer.rule_asks import Part, RuleAsks, StatementKey, Undecided, collect_asks


@dataclass(frozen=True, slots=True, kw_only=True)
class SolvedPart:
    """The rates of one part in Hz by the names of its asks, ``None`` where it does not fit.

    ``others_kb_per_s`` is what the other topics take at their default, ``needs_kb_per_s`` the least that all
    topics together can do with, ``used_kb_per_s`` what they take (where nothing fits: the same least).
    ``price`` is what one KB/s more would gain in the model's own unit, 0 where it would gain nothing.
    """

    part: Part
    rates_hz: Mapping[str, float] | None
    others_kb_per_s: float
    needs_kb_per_s: float
    used_kb_per_s: float
    model: Model
    price: float = 0.0

    @property
    def feasible(self) -> bool:
        """Whether the part fits."""
        return self.rates_hz is not None

    @property
    def topic_rates_hz(self) -> dict[str, float]:
        """The rates of topics that count by them."""
        asks = self.part.asks
        return {name: hz for name, hz in (self.rates_hz or {}).items() if name == asks[name].needs.topic}

    @property
    def bounds(self) -> dict[str, float]:
        """The bounds of levels, by the names of their asks."""
        found = {
            name: self.part.asks[name].bound(hz, self.model) for name, hz in (self.rates_hz or {}).items()
        }
        return {name: bound for name, bound in found.items() if bound is not None}


@dataclass(frozen=True, slots=True, kw_only=True)
class Optimization:
    """The result for one rule set; where the defaults do not fit, blocks are solved beside their least."""

    model: Model
    budget_kb_per_s: float
    defaults: SolvedPart
    blocks: tuple[SolvedPart, ...]
    appended: tuple[str, ...]
    tier_rates_hz: Mapping[StatementKey, float] = field(default_factory=dict)
    tier_bounds: Mapping[StatementKey, float] = field(default_factory=dict)

    @property
    def feasible(self) -> bool:
        """Whether every part fits."""
        return all(part.feasible for part in self.parts)

    @property
    def parts(self) -> tuple[SolvedPart, ...]:
        """The defaults and the blocks."""
        return (self.defaults, *self.blocks)

    def tier_rate(self, statement: SetFrequency, path: str, /) -> Rate:
        """As ``TierValues``; ``KeyError`` for a part that does not fit."""
        return Rate(self.tier_rates_hz[path, statement.rate.span])

    def tier_bound(self, statement: KeepWithin, path: str, /) -> float:
        """As ``TierValues``; ``KeyError`` for a part that does not fit."""
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
    solver: Solver,
    undecided: Undecided = Undecided.APPENDED,
) -> Optimization:
    """The value of every level in ``files``, which have no errors; ``ProfileError`` for what is missing."""
    asks = collect_asks(files, profile, resolve, undecided)
    return solve_asks(asks, budget_of(profile), model=model, solver=solver)


def solve_asks(asks: RuleAsks, budget_kb_per_s: float, *, model: Model, solver: Solver) -> Optimization:
    """The defaults, then each block's topics with all others at their default."""
    defaults = solve_part(asks.defaults, 0.0, budget_kb_per_s, model=model, solver=solver)
    rates_hz = defaults.rates_hz or {
        name: ask.bounds_hz(model)[0] for name, ask in asks.defaults.asks.items()
    }
    blocks: list[SolvedPart] = []
    for part in asks.blocks:
        others = used_kb_per_s(
            (asks.defaults.asks[name].needs.size_kb, rate_hz)
            for name, rate_hz in part.without_its_topics(rates_hz).items()
        )
        blocks.append(solve_part(part, others, budget_kb_per_s, model=model, solver=solver))
    solved = [one for one in (defaults, *blocks) if one.rates_hz is not None]
    return Optimization(
        model=model,
        budget_kb_per_s=budget_kb_per_s,
        defaults=defaults,
        blocks=tuple(blocks),
        appended=asks.appended,
        tier_rates_hz={key: hz for one in solved for key, hz in _tier_rates_hz(one)},
        tier_bounds={key: bound for one in solved for key, bound in _tier_bounds(one)},
    )


def _tier_rates_hz(solved: SolvedPart) -> Iterator[tuple[StatementKey, float]]:
    yield from solved.part.ceilings_hz
    rates_hz = solved.topic_rates_hz
    yield from ((key, rates_hz[name]) for key, name in solved.part.tier_statements if name in rates_hz)


def _tier_bounds(solved: SolvedPart) -> Iterator[tuple[StatementKey, float]]:
    yield from solved.part.unmeasured_bounds
    bounds = solved.bounds
    yield from ((key, bounds[name]) for key, name in solved.part.tier_statements if name in bounds)


def solve_part(
    part: Part, others_kb_per_s: float, budget_kb_per_s: float, *, model: Model, solver: Solver
) -> SolvedPart:
    """The rates of one part, where all other topics take ``others_kb_per_s`` of the budget."""
    asks = part.asks
    least_hz = {topic: ask.bounds_hz(model)[0] for topic, ask in asks.items()}
    own_least = used_kb_per_s((ask.needs.size_kb, least_hz[topic]) for topic, ask in asks.items())
    needs = others_kb_per_s + own_least
    found = None
    if fits(needs, budget_kb_per_s):
        # What is left may be below the least by float noise, which must not make it infeasible.
        own_budget = max(budget_kb_per_s - others_kb_per_s, own_least)
        found = best_rates(model, list(asks.values()), own_budget, solver)
    if found is None:
        return SolvedPart(
            part=part,
            model=model,
            rates_hz=None,
            others_kb_per_s=others_kb_per_s,
            needs_kb_per_s=needs,
            used_kb_per_s=needs,
        )
    rates_hz = rounded_down(found.rates_hz, least_hz)
    own = used_kb_per_s((ask.needs.size_kb, rates_hz[topic]) for topic, ask in asks.items())
    return SolvedPart(
        part=part,
        model=model,
        rates_hz=rates_hz,
        others_kb_per_s=others_kb_per_s,
        needs_kb_per_s=needs,
        used_kb_per_s=others_kb_per_s + own,
        price=found.price,
    )
