# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rates and bounds within a budget while the robot runs."""

from __future__ import annotations

import itertools
import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

from smarttestudo.domain.profile import TopicProfile, rounded_up
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.optimizer.problem import Segment, fill, fits, round_down, used_kb_per_s

Within = Mapping[str, float]
"""The bounds of one topic, by property."""


def can_widen(entry: TopicProfile, within: Within) -> bool:
    """Whether it is known of every bound, and there are any, what it needs as it gets wider."""
    return bool(within) and all(
        bound > 0 and entry.needed_hz({name: math.inf}) < math.inf for name, bound in within.items()
    )


def widest(entry: TopicProfile, within: Within) -> dict[str, float]:
    """As wide as bounds may get: α0 of each, unless it is wider already. There must be measured levels."""
    loosest = {name: entry.accuracy(name) for name in within}
    return {
        name: bound if (tiers := loosest[name]) is None else max(bound, tiers.bounds[0])
        for name, bound in within.items()
    }


def widened(entry: TopicProfile, within: Within, rate_hz: float) -> dict[str, float]:
    """All of ``within`` times the least factor with which they need at most ``rate_hz``, in four digits.

    No bound gets wider than in ``widest``, even if that needs more.
    """
    limits = widest(entry, within)

    def at(factor: float) -> dict[str, float]:
        return {name: min(factor * bound, limits[name]) for name, bound in within.items()}

    factor = _least_factor(entry, within, rate_hz)
    return {
        name: within[name] if factor == 1.0 else min(rounded_up(bound), limits[name])
        for name, bound in at(factor).items()
    }


def _least_factor(entry: TopicProfile, within: Within, rate_hz: float) -> float:
    """Between two factors that bring some bound to an accuracy of its levels, the need falls on a line."""

    def needed_hz(factor: float) -> float:
        return entry.needed_hz({name: factor * bound for name, bound in within.items()})

    corners = {1.0}
    for name, bound in within.items():
        tiers = entry.accuracy(name)
        corners.update(_factor(bound, one) for one in (() if tiers is None else tiers.bounds) if one > bound)
    if needed_hz(1.0) <= rate_hz:
        return 1.0
    for low, high in itertools.pairwise(sorted(corners)):
        start_hz, between = needed_hz(low), (low + high) / 2
        fall_hz = start_hz - needed_hz(between)
        # Below α5 nothing is known (infinite), and at two equal accuracies the need falls at once.
        if start_hz < math.inf and fall_hz > 0:
            factor = low + (start_hz - rate_hz) / fall_hz * (between - low)
            if factor < high:
                return factor
        if needed_hz(high) <= rate_hz:
            return high
    return max(corners)


def _factor(bound: float, wider: float) -> float:
    """The factor from ``bound`` to ``wider``, or no less by float noise: that may need infinitely more."""
    factor = wider / bound
    return factor if factor * bound >= wider else math.nextafter(factor, math.inf)


REPLAN_AFTER_NS = NS_PER_S
LOWEST_USE = 0.9
SMALL_SHARE, LARGE_SHARE = 1 / 20, 1 / 16
"""A topic is small if those of its priority that take no more than it, and it, take so much of the budget."""


@dataclass(slots=True)
class TopicRequest:
    """The load of one topic: the rate that the rules ask for, and what was measured.

    ``requested_hz`` is infinite for Full. No cut goes below ``floor_hz``. ``source_hz`` is the source's rate,
    beyond which a request costs nothing; ``size_kb`` the mean message size in KB. Where messages name
    streams, rates are those of a stream, and the size is that of one message of each.
    """

    topic: str
    requested_hz: float
    floor_hz: float
    priority: float
    size_kb: float
    source_hz: float

    @property
    def wanted_hz(self) -> float:
        """The rate that the request would really have."""
        return min(self.requested_hz, self.source_hz)


@dataclass(frozen=True, slots=True, kw_only=True)
class BudgetPlan:
    """The rates in Hz of the topics that are cut; not ``floors_fit`` where the floors alone are too much."""

    cut_hz: Mapping[str, float]
    floors_fit: bool


def plan_within(loads: Sequence[TopicRequest], budget_kb_per_s: float) -> BudgetPlan:
    """Cut rates until ``Σ size·rate`` is within the budget; floors win over the budget.

    A KB delivered is worth its topic's priority, so a topic is cut only once all of lower priority are at
    their floors. Of one priority, small topics give way last: the smallest ones that together take no more
    than ``SMALL_SHARE`` of the budget. The others lose the same share of what lies above their floors.
    """
    wanted_hz = [load.wanted_hz for load in loads]
    least_hz = [min(load.floor_hz, wanted) for load, wanted in zip(loads, wanted_hz, strict=True)]
    least = used_kb_per_s((load.size_kb, rate) for load, rate in zip(loads, least_hz, strict=True))
    small_hz = _small_hz(loads, wanted_hz, budget_kb_per_s)
    ranks = {priority: 2 * place for place, priority in enumerate(sorted({load.priority for load in loads}))}
    segments: list[Segment] = []
    for index, load in enumerate(loads):
        low_hz, high_hz = least_hz[index], wanted_hz[index]
        kept_hz, rank = max(low_hz, small_hz[index]), ranks[load.priority]
        if kept_hz > low_hz:
            segments.append((rank + 1, index, kept_hz - low_hz, load.size_kb * (kept_hz - low_hz)))
        if high_hz > kept_hz:
            segments.append((rank, index, high_hz - kept_hz, load.size_kb * (high_hz - kept_hz)))
    rates_hz = list(least_hz)
    floors_fit = fits(least, budget_kb_per_s)
    if floors_fit:
        fill(rates_hz, segments, budget_kb_per_s - least)
    # A rate that float noise alone keeps from its request is not cut.
    cut_hz = {
        load.topic: max(round_down(rate), floor)
        for load, rate, wanted, floor in zip(loads, rates_hz, wanted_hz, least_hz, strict=True)
        if rate < wanted * (1 - 1e-9)
    }
    return BudgetPlan(cut_hz=cut_hz, floors_fit=floors_fit)


def _small_hz(
    loads: Sequence[TopicRequest], wanted_hz: Sequence[float], budget_kb_per_s: float
) -> list[float]:
    """The part of each wanted rate that gives way last: all of a small topic, nothing of a large one."""
    alike: dict[tuple[float, float], list[int]] = {}
    for index, (load, rate_hz) in enumerate(zip(loads, wanted_hz, strict=True)):
        alike.setdefault((load.priority, load.size_kb * rate_hz), []).append(index)
    small_hz = [0.0] * len(loads)
    together: dict[float, float] = {}
    large = LARGE_SHARE * budget_kb_per_s
    for (priority, each_kb_per_s), indices in sorted(alike.items()):
        used = together[priority] = together.get(priority, 0.0) + each_kb_per_s * len(indices)
        # By parts between the two, so that a larger budget lowers no rate.
        part = min(1.0, (large - used) / (large - SMALL_SHARE * budget_kb_per_s)) if used < large else 0.0
        for index in indices:
            small_hz[index] = part * wanted_hz[index]
    return small_hz


class BudgetKeeper:
    """Decides when to plan anew: when requests change, and when the use of the link does, once a second.

    The use is right between 90 and 100 % of the budget; below that only if something is cut. The budget may
    be set anew at any time.
    """

    def __init__(self, budget_kb_per_s: float) -> None:
        self._budget_kb_per_s = budget_kb_per_s
        self.plan = BudgetPlan(cut_hz={}, floors_fit=True)
        self.next_check_ns: int | None = None
        """When the use is looked at again; ``None`` before the first plan."""
        self._is_stale = True

    @property
    def budget_kb_per_s(self) -> float:
        return self._budget_kb_per_s

    @budget_kb_per_s.setter
    def budget_kb_per_s(self, budget_kb_per_s: float) -> None:
        self._is_stale = self._is_stale or budget_kb_per_s != self._budget_kb_per_s
        self._budget_kb_per_s = budget_kb_per_s

    def change_topics(self, topics: Collection[str]) -> None:
        """Only ``topics`` count from now on, some perhaps otherwise; the next ``update`` plans anew."""
        cut_hz = {topic: rate_hz for topic, rate_hz in self.plan.cut_hz.items() if topic in topics}
        self.plan = replace(self.plan, cut_hz=cut_hz)
        self._is_stale = True

    def is_due(self, now_ns: int) -> bool:
        """Whether ``update`` has something to look at, though no request changed."""
        return self._is_stale or self.next_check_ns is None or now_ns >= self.next_check_ns

    def update(
        self,
        loads: Sequence[TopicRequest],
        now_ns: int,
        *,
        requests_changed: bool,
        check_after_ns: int = REPLAN_AFTER_NS,
    ) -> BudgetPlan:
        """The plan for ``loads`` at ``now_ns``; the same object as before where none was needed.

        ``check_after_ns`` says how long the use is not looked at then.
        """
        if not requests_changed and not self.is_due(now_ns):
            return self.plan
        self.next_check_ns = now_ns + check_after_ns
        if requests_changed or self._is_stale or self._is_off_target(loads):
            self.plan = plan_within(loads, self._budget_kb_per_s)
            self._is_stale = False
        return self.plan

    def _is_off_target(self, loads: Sequence[TopicRequest]) -> bool:
        cut_hz = self.plan.cut_hz
        used = used_kb_per_s(
            (load.size_kb, min(load.wanted_hz, cut_hz.get(load.topic, load.wanted_hz))) for load in loads
        )
        if not fits(used, self._budget_kb_per_s):
            return True
        return bool(cut_hz) and used < LOWEST_USE * self._budget_kb_per_s
