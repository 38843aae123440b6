# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The loop's state: one instance, owned by the loop."""

from __future__ import annotations

import math
from collections import Counter, deque
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

from smarttestudo.domain.decision import BoundReason, PlannedRate, Reason
from smarttestudo.domain.names import is_source
from smarttestudo.domain.observation import LinkBudget
from smarttestudo.domain.profile import UNLIMITED_KB_PER_S, Profile
from smarttestudo.domain.signal import Signal, Value, shown_value
from smarttestudo.domain.timing import AlarmClock, SteadyTime
from smarttestudo.domain.units import ns_from_s
from smarttestudo.language.evaluator import Evaluator, RequestedRate
from smarttestudo.language.normal_form import reads
from smarttestudo.language.rule_set import RuleSet
from smarttestudo.language.text_region import SetOfValues
from smarttestudo.loop.knowledge.action_plan import ActionPlan
from smarttestudo.loop.knowledge.link_use import LinkUse
from smarttestudo.loop.knowledge.watched_topic import Reading, WatchedTopic
from smarttestudo.loop.knowledge.watched_vitals import WatchedVitals


class BoundHysteresis:
    """The effective bounds of a topic: those that let pass all that was requested in ``settle_ns``.

    A request that another one replaces keeps counting for so long, unless the other lets as much pass. Of
    requests that count, one without any bound stands above all; else of each property the tightest.
    """

    __slots__ = ("_replaced", "_request", "_settle_ns")

    def __init__(self, request: PlannedRate, settle_ns: int) -> None:
        self._request = request
        self._settle_ns = settle_ns
        self._replaced: list[tuple[int, PlannedRate]] = []

    def on_request(self, request: PlannedRate, now_ns: int) -> None:
        """The rules now request the bounds of ``request``."""
        if request.within == self._request.within:
            self._request = request
            return
        replaced = [*self._replaced, (now_ns + self._settle_ns, self._request)]
        self._request = request
        self._replaced = [one for one in replaced if not _covers(request.within, one[1].within)]

    def effective(self, planned: PlannedRate, now_ns: int) -> PlannedRate:
        """``planned`` with the bounds that count at ``now_ns``, which never goes back."""
        self._replaced = [one for one in self._replaced if one[0] > now_ns]
        counting = [self._request, *(request for _, request in self._replaced)]
        unbound = next((one for one in counting if not one.within), None)
        within, reasons = _tightest(counting) if unbound is None else ({}, unbound.bound_reasons)
        if (planned.within, planned.bound_reasons) == (within, reasons):
            return planned
        return replace(planned, within=within, bound_reasons=reasons)

    def carried_on(self, rename: Callable[[PlannedRate], PlannedRate], settle_ns: int) -> BoundHysteresis:
        """The same requests by other names, where what lets less pass waits for ``settle_ns`` from now on."""
        carried_on = BoundHysteresis(rename(self._request), settle_ns)
        carried_on._replaced = [(end_ns, rename(request)) for end_ns, request in self._replaced]
        return carried_on

    @property
    def next_change_ns(self) -> int | None:
        """When the effective bounds may let less pass by themselves."""
        return min((end_ns for end_ns, _ in self._replaced), default=None)


def _tightest(requests: Sequence[PlannedRate]) -> tuple[dict[str, float], dict[str, BoundReason]]:
    """Of each property the tightest bound, of equals the first, with its reason."""
    within: dict[str, float] = {}
    reasons: dict[str, BoundReason] = {}
    for request in requests:
        for name, bound in request.within.items():
            if bound < within.get(name, math.inf):
                within[name] = bound
                reasons[name] = request.bound_reasons[name]
    return within, reasons


def _covers(request: Mapping[str, float], other: Mapping[str, float]) -> bool:
    """Whether bounds of ``request`` let pass all that those of ``other`` do; none let everything pass."""
    if not request or not other:
        return not request
    return all(request.get(name, math.inf) <= bound for name, bound in other.items())


class RateHysteresis:
    """The effective request of a topic: the one with the greatest rate of the last ``settle_ns``.

    A request that another one replaces keeps counting for ``settle_ns``, and so a lower rate takes effect
    when nothing higher was requested for so long. Among equal rates the latest request counts, with its
    reason. It is a sliding-window maximum by a monotonic queue: rates fall from the front, the effective
    request, to the back, the current one.
    """

    __slots__ = ("_replaced", "_request", "_settle_ns")

    def __init__(self, request: RequestedRate, settle_ns: int) -> None:
        self._settle_ns = settle_ns
        self._request = request
        self._replaced: deque[tuple[int, RequestedRate]] = deque()

    def on_request(self, request: RequestedRate, now_ns: int) -> None:
        self._replaced.append((now_ns + self._settle_ns, self._request))
        self._request = request
        while self._replaced and self._replaced[-1][1].planned.rate <= request.planned.rate:
            self._replaced.pop()

    def effective(self, now_ns: int) -> RequestedRate:
        """The request that counts at ``now_ns``, which never goes back."""
        while self._replaced and self._replaced[0][0] <= now_ns:
            self._replaced.popleft()
        return self._replaced[0][1] if self._replaced else self._request

    def carried_on(self, rename: Callable[[RequestedRate], RequestedRate], settle_ns: int) -> RateHysteresis:
        """The same requests by other names, where lower rates wait for ``settle_ns`` from now on."""
        carried_on = RateHysteresis(rename(self._request), settle_ns)
        carried_on._replaced.extend((end_ns, rename(request)) for end_ns, request in self._replaced)
        return carried_on

    @property
    def next_change_ns(self) -> int | None:
        """When the effective request ends by itself; ``None`` if it is the current one."""
        return self._replaced[0][0] if self._replaced else None


@dataclass(frozen=True, slots=True, kw_only=True)
class Hysteresis:
    """The effective request of a topic: its rate and its bounds fall only once they were low for a while."""

    rate: RateHysteresis
    bounds: BoundHysteresis

    @staticmethod
    def of(request: RequestedRate, settle_ns: int) -> Hysteresis:
        """The state after the first request."""
        return Hysteresis(
            rate=RateHysteresis(request, settle_ns), bounds=BoundHysteresis(request.planned, settle_ns)
        )

    def on_request(self, request: RequestedRate, now_ns: int) -> None:
        self.rate.on_request(request, now_ns)
        self.bounds.on_request(request.planned, now_ns)

    def effective(self, now_ns: int) -> RequestedRate:
        """The request that counts at ``now_ns``, which never goes back, with the bounds that do."""
        request = self.rate.effective(now_ns)
        planned = self.bounds.effective(request.planned, now_ns)
        return request if planned is request.planned else replace(request, planned=planned)

    def carried_on(
        self,
        rename: Callable[[RequestedRate], RequestedRate],
        rename_bounds: Callable[[PlannedRate], PlannedRate],
        settle_ns: int,
    ) -> Hysteresis:
        """The same requests by other names; what lets less pass waits for ``settle_ns`` from now on."""
        return Hysteresis(
            rate=self.rate.carried_on(rename, settle_ns),
            bounds=self.bounds.carried_on(rename_bounds, settle_ns),
        )

    @property
    def next_change_ns(self) -> int | None:
        """When the effective request may change by itself."""
        times_ns = (self.rate.next_change_ns, self.bounds.next_change_ns)
        return min((at_ns for at_ns in times_ns if at_ns is not None), default=None)


class Knowledge:
    """Rules, profile and everything remembered about the robot; the loop owns one and changes it in ``step``.

    Times inside are steady times. ``effective`` and ``plan`` hold the relayed topics, ``watched`` those that
    checks read, ``vitals`` what they read of the machine and the link; ``settled`` are the requests that
    settled, before ``link`` cuts them to a budget, if there is one; ``without_subscribers`` are relayed
    topics. ``unknown_values`` counts messages that left a signal unknown, ``undecodable`` those that could
    not be decoded, by topic. ``begun`` are the blocks that record or act, by order, that began to hold and
    are not known to have ended; ``actions`` is what they do.
    """

    def __init__(
        self, rule_set: RuleSet, profile: Profile, start_ns: int, budget_kb_per_s: float | None = None
    ) -> None:
        self.rule_set = rule_set
        self.profile = profile
        self.start_ns = start_ns
        self.settle_ns = ns_from_s(profile.settle_s)
        self.time = SteadyTime(start_ns)
        self.evaluator = Evaluator(rule_set, start_ns)
        self.watched = watched_topics(rule_set, profile, start_ns, self.evaluator)
        self.vitals = watched_vitals(rule_set)
        self.watch_alarms = AlarmClock()
        for topic in (*self.watched, *self.vitals):
            self.watch_alarms.set(topic, start_ns)
        self.hysteresis: dict[str, Hysteresis] = {}
        self.settle_alarms = AlarmClock()
        self.settled: dict[str, RequestedRate] = {}
        self.link: LinkUse | None = None
        self._budgets: dict[bool, float] = {}
        """What the relayed topics may take, by whether it was measured."""
        self.without_subscribers: set[str] = set()
        if budget_kb_per_s is not None:
            self.set_budget(LinkBudget(link_kb_per_s=budget_kb_per_s))
        self.effective: dict[str, RequestedRate] = {}
        self.plan: dict[str, PlannedRate] = {}
        self.order_of = {topic: place for place, topic in enumerate(rule_set.relayed)}
        self.unknown_values: Counter[Signal] = Counter()
        self.undecodable: Counter[str] = Counter()
        self.begun: set[int] = set()
        self.actions = ActionPlan(profile)

    def set_budget(self, budget: LinkBudget) -> None:
        """The relayed topics may take so much from now on: the lesser of what was set and measured."""
        self._budgets[budget.is_measured] = budget.link_kb_per_s
        is_measured = min(self._budgets, key=lambda each: (self._budgets[each], each))
        budget_kb_per_s, reason = self._budgets[is_measured], Reason.LINK if is_measured else Reason.BUDGET
        if self.link is None:
            self.link = LinkUse(self.rule_set, self.profile, budget_kb_per_s)
        self.link.set_budget(budget_kb_per_s, reason)

    @property
    def budget_kb_per_s(self) -> float | None:
        """Bandwidth that all relayed topics together may take; ``None`` where nothing limits them."""
        if self.link is None:
            return None
        budget_kb_per_s = self.link.budget_kb_per_s
        is_of_link = budget_kb_per_s == self._budgets.get(True)
        return None if is_of_link and budget_kb_per_s >= UNLIMITED_KB_PER_S else budget_kb_per_s

    @property
    def floors_broke_budget(self) -> bool:
        """Whether the floors alone were ever more than the budget; they won."""
        return self.link is not None and self.link.floors_broke_budget

    @property
    def floors_break_budget(self) -> bool:
        """Whether the floors alone are more than the budget now."""
        return self.link is not None and self.link.floors_break_budget

    def reads(self, topic: str) -> bool:
        """Whether a check reads fields of ``topic``, so that its messages must be decoded."""
        watched = self.watched.get(topic)
        return watched is not None and bool(watched.fields)

    def readings(self, topic: str, now_ns: int) -> list[Reading]:
        """The value of every signal of ``topic``, which checks read, at ``now_ns``."""
        vitals = self.vitals.get(topic)
        return (self.watched[topic] if vitals is None else vitals).readings(now_ns)

    def values_of(self, block: int | None, now_ns: int) -> dict[str, Value | None]:
        """Values that the condition of the block of that order reads at ``now_ns``, by signal name."""
        if block is None:
            return {}
        regions: dict[Signal, list[SetOfValues]] = {}
        for within in reads(self.rule_set.blocks[block].form):
            regions.setdefault(within.signal, []).append(within.region)
        signals = self.evaluator.reads(block)
        values = {
            signal: value
            for topic in {signal.topic for signal in signals}
            for signal, value in self.readings(topic, now_ns)
        }
        return {
            str(signal): shown_value(values[signal], partial(_is_in_any, regions.get(signal, ())))
            for signal in signals
        }

    @property
    def next_wake_ns(self) -> int | None:
        """When, on the clock, time alone may next change the plan; it may come early, never late."""
        check_ns = None if self.link is None else self.link.next_check_ns
        rules_ns = self.evaluator.next_alarm_ns
        actions_ns = self.actions.next_wake_ns
        times_ns = (self.watch_alarms.next_ns, self.settle_alarms.next_ns, rules_ns, check_ns, actions_ns)
        earliest_ns = min([at_ns for at_ns in times_ns if at_ns is not None], default=None)
        return None if earliest_ns is None else self.time.on_clock(earliest_ns)


def _is_in_any(regions: Iterable[SetOfValues], value: Value) -> bool:
    return any(region.contains(value) for region in regions)  # type: ignore[arg-type]  # of one sort


def watched_topics(
    rule_set: RuleSet, profile: Profile, start_ns: int, evaluator: Evaluator
) -> Mapping[str, WatchedTopic]:
    """The topics that the checks of a rule set read; nothing is known of them yet."""
    return {
        topic: WatchedTopic(read, profile.topic(topic), start_ns, evaluator.cuts)
        for topic, read in _signals_by_topic(rule_set).items()
        if not is_source(topic)
    }


def watched_vitals(rule_set: RuleSet) -> Mapping[str, WatchedVitals]:
    """Vitals that the checks of a rule set read; nothing is known of them yet."""
    by_topic = _signals_by_topic(rule_set)
    return {source: WatchedVitals(read) for source, read in by_topic.items() if is_source(source)}


def _signals_by_topic(rule_set: RuleSet) -> dict[str, list[Signal]]:
    signals: dict[str, list[Signal]] = {}
    for signal in sorted(rule_set.signals):
        signals.setdefault(signal.topic, []).append(signal)
    return signals
