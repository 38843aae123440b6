# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Bandwidth of each topic on the link, and the rates that fit the budget."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

from smarttestudo.domain.decision import Reason
from smarttestudo.domain.profile import Profile, TopicProfile
from smarttestudo.domain.rate import Rate
from smarttestudo.domain.rate_meter import INTERVALS_NEEDED, STALE_AT_LEAST_NS, mean_hz, silence_limit_ns
from smarttestudo.domain.units import BYTES_PER_KB, NS_PER_S, ns_from_s
from smarttestudo.language.evaluator import RequestedRate
from smarttestudo.language.rule_set import RuleSet
from smarttestudo.optimizer.run_time import (
    REPLAN_AFTER_NS,
    BudgetKeeper,
    TopicRequest,
    can_widen,
    widened,
    widest,
)

WINDOW_S = 10
WINDOW_NS = WINDOW_S * NS_PER_S
MEASURED_OVER_NS = NS_PER_S // 4
"""A rate from a few messages is unreliable before they span this time."""
MEASURED_AFTER_NS = NS_PER_S
"""By then even a slow source counts by what came of it."""


class Measure(NamedTuple):
    """The mean size of a source's messages in KB, and its rate."""

    message_kb: float
    source_hz: float


@dataclass(slots=True)
class _Second:
    """The messages of one second: when the first arrived, how many, how many bytes."""

    first_ns: int
    messages: int = 0
    size_bytes: int = 0


class SourceLoad:
    """Mean message size and rate of a source over ten seconds, in steps of a second.

    A source asks from a message on until it is silent: for ``stale_after_ns``, else for as long as makes the
    values of a topic stale (``SourcePeriod.stale_from_ns``), and for ten seconds in any case. After that it
    begins anew. Memory and time do not depend on how many messages there are.
    """

    __slots__ = ("_began_ns", "_last_ns", "_seconds", "before", "stale_after_ns")

    def __init__(self, stale_after_ns: int | None = None) -> None:
        self.stale_after_ns = stale_after_ns
        self.before: Measure | None = None
        """What was measured last, for when the source begins anew."""
        self._seconds: deque[_Second] = deque()
        self._began_ns = 0
        self._last_ns = 0

    def record(self, now_ns: int, size_bytes: int) -> bool:
        """Count a message; whether the source begins with it. Times never fall."""
        begins = self.is_silent(now_ns)
        if begins:
            self.end()
            self._began_ns = now_ns
        if begins or now_ns - self._seconds[-1].first_ns >= NS_PER_S:
            self._seconds.append(_Second(now_ns))
            self.forget(now_ns)
        second = self._seconds[-1]
        second.messages += 1
        second.size_bytes += size_bytes
        self._last_ns = now_ns
        return begins

    def end(self) -> None:
        """The source's messages no longer count: its next message begins anew."""
        self._seconds.clear()

    def forget(self, now_ns: int) -> None:
        """Drop the seconds that began before the window."""
        while self._seconds and self._seconds[0].first_ns <= now_ns - WINDOW_NS:
            self._seconds.popleft()

    def is_silent(self, now_ns: int) -> bool:
        """Whether the source asks for nothing."""
        if not self._seconds:
            return True
        silent_ns = now_ns - self._last_ns
        # Nearly every message comes soon after the one before it.
        if silent_ns <= STALE_AT_LEAST_NS and self.stale_after_ns is None:
            return False
        self.forget(now_ns)
        return not self._seconds or silent_ns > self._limit_ns

    def is_measured(self, now_ns: int) -> bool:
        """Whether the messages since the source began suffice to measure it."""
        return now_ns - self._began_ns >= MEASURED_AFTER_NS or self._span_ns >= MEASURED_OVER_NS

    def began_after(self, at_ns: int) -> bool:
        """Whether the source asks for less long."""
        return self._began_ns > at_ns

    @property
    def measure(self) -> Measure:
        """Size and rate: (n - 1) / (last - first) in the window; one message counts as one in ten seconds.

        There must be a message.
        """
        messages = self._messages
        size_bytes = sum(second.size_bytes for second in self._seconds)
        rate_hz = mean_hz(messages, max(self._span_ns, MEASURED_OVER_NS)) or 1 / WINDOW_S
        return Measure(size_bytes / BYTES_PER_KB / messages, rate_hz)

    @property
    def _limit_ns(self) -> int:
        intervals = self._messages - 1
        if self.stale_after_ns is not None:
            return self.stale_after_ns
        return WINDOW_NS if intervals < INTERVALS_NEEDED else silence_limit_ns(self._span_ns, intervals)

    @property
    def _span_ns(self) -> int:
        return self._last_ns - self._seconds[0].first_ns if self._seconds else 0

    @property
    def _messages(self) -> int:
        return sum(second.messages for second in self._seconds)


_SOON_NS = REPLAN_AFTER_NS // 2


class LinkUse:
    """Keeps the relayed topics within a budget by the sizes that are really measured.

    A topic requests a part of it from a message on until its source is silent or gone
    (``SourceLoad``); any other takes nothing. Until a source that began is measured, what was measured of it
    before stands in, or the profile's size and rate. ``floors_broke_budget`` says whether the floors alone
    were ever too much.

    A topic whose bounds have a measured need counts that, if it is less than its rate. In place of its rate,
    its bounds are widened, up to α0 of their levels.
    """

    def __init__(self, rule_set: RuleSet, profile: Profile, budget_kb_per_s: float) -> None:
        self.floors_broke_budget = False
        self._keeper = BudgetKeeper(budget_kb_per_s)
        self._reason = Reason.BUDGET
        self._is_reason_new = False
        self._sources: dict[str, SourceLoad] = {}
        self._unmeasured = _unmeasured(rule_set, profile)
        self._entries = _entries(rule_set, profile)
        self._stale_after_ns = _stale_after_ns(rule_set, profile)
        self._streams: dict[str, float] = {}
        """How many messages of a topic pass at 1 Hz, where that is more than one."""
        self._asking: dict[str, bool] = {}
        """The topics that asked when it was planned last, and whether they were measured."""
        self._changed_ns: int | None = None
        """Since when another topic asks than was planned with."""

    def change_rules(self, rule_set: RuleSet, profile: Profile) -> None:
        """Other rules and another profile are in force; measurements are kept."""
        self._stale_after_ns = _stale_after_ns(rule_set, profile)
        for topic, source in self._sources.items():
            source.stale_after_ns = self._stale_after_ns.get(topic)
        before = self._unmeasured, self._entries
        self._unmeasured, self._entries = _unmeasured(rule_set, profile), _entries(rule_set, profile)
        if (self._unmeasured, self._entries) != before:
            self._sources = {
                topic: source for topic, source in self._sources.items() if topic in self._unmeasured
            }
            self._keeper.change_topics(self._unmeasured)

    def set_budget(self, budget_kb_per_s: float, reason: Reason) -> None:
        """The topics may take ``budget_kb_per_s``, for that reason; the next ``update`` plans anew."""
        self._keeper.budget_kb_per_s = budget_kb_per_s
        self._is_reason_new |= reason is not self._reason
        self._reason = reason

    @property
    def budget_kb_per_s(self) -> float:
        return self._keeper.budget_kb_per_s

    @property
    def floors_break_budget(self) -> bool:
        """Whether the floors alone are too much now."""
        return not self._keeper.plan.floors_fit

    def record(self, topic: str, now_ns: int, size_bytes: int) -> bool:
        """A source sent a message; whether it asks from now on. Topics without a relay do not count."""
        source = self._sources.get(topic)
        if source is None:
            if topic not in self._unmeasured:
                return False
            source = self._sources[topic] = SourceLoad(self._stale_after_ns[topic])
        begins = source.record(now_ns, size_bytes)
        if begins:
            self._changed_ns = now_ns
        return begins

    def set_streams(self, topic: str, streams: float) -> None:
        """Count ``streams`` messages of a topic for each Hz: its messages name so many streams."""
        if streams > 1:
            self._streams[topic] = streams

    def end(self, topic: str, now_ns: int) -> None:
        """The source of a topic no longer has a subscriber or publisher."""
        source = self._sources.get(topic)
        if source is not None and not source.is_silent(now_ns):
            source.end()
            self._changed_ns = now_ns

    @property
    def next_check_ns(self) -> int | None:
        """When the use of the link is next checked; ``None`` while no topic requests any of it."""
        if self._changed_ns is not None:
            return self._changed_ns
        return self._keeper.next_check_ns if self._asking else None

    def update(
        self, requests: Mapping[str, RequestedRate], now_ns: int, *, requests_changed: bool
    ) -> set[str]:
        """Plan anew if it is time or requests changed; the topics whose cut is another one now."""
        if not (requests_changed or self._changed_ns is not None or self._keeper.is_due(now_ns)):
            return set()
        before, asked = self._keeper.plan, self._asking
        self._changed_ns = None
        self._asking = self._asking_at(now_ns)
        loads = [self._load(topic, request) for topic, request in requests.items()]
        after = self._keeper.update(
            loads,
            now_ns,
            requests_changed=requests_changed or self._asking != asked,
            check_after_ns=self._check_after_ns(now_ns),
        )
        self.floors_broke_budget |= not after.floors_fit
        topics = {*before.cut_hz, *after.cut_hz}
        if self._is_reason_new:
            self._is_reason_new = False
            return topics
        return {topic for topic in topics if before.cut_hz.get(topic) != after.cut_hz.get(topic)}

    def within(self, topic: str, request: RequestedRate) -> RequestedRate:
        """``request``, its rate cut or its bounds widened if the budget asks for it, by the same block."""
        cut_hz = self._keeper.plan.cut_hz.get(topic)
        if cut_hz is None:
            return request
        planned, entry = request.planned, self._entries[topic]
        if can_widen(entry, planned.within):
            bounds = widened(entry, planned.within, cut_hz * self._streams_of(topic))
            return replace(request, planned=replace(planned, within=bounds, reason=self._reason))
        return replace(request, planned=replace(planned, rate=Rate(cut_hz), reason=self._reason))

    def _asking_at(self, now_ns: int) -> dict[str, bool]:
        for source in self._sources.values():
            source.forget(now_ns)
        return {
            topic: source.is_measured(now_ns)
            for topic, source in self._sources.items()
            if not source.is_silent(now_ns)
        }

    def _check_after_ns(self, now_ns: int) -> int:
        """The time after which to plan again, so that a new topic has its place after a second."""
        just_began = any(self._sources[topic].began_after(now_ns - _SOON_NS) for topic in self._asking)
        return _SOON_NS if just_began else REPLAN_AFTER_NS

    def _load(self, topic: str, request: RequestedRate) -> TopicRequest:
        load = replace(self._unmeasured[topic], requested_hz=request.planned.rate.hz)
        within, entry = request.planned.within, self._entries[topic]
        if can_widen(entry, within):
            streams = self._streams_of(topic)
            needed_hz = max(entry.needed_hz(within) / streams, load.floor_hz)
            load.requested_hz = min(load.requested_hz, needed_hz)
            load.floor_hz = max(load.floor_hz, entry.needed_hz(widest(entry, within)) / streams)
        if topic not in self._asking:
            load.size_kb = load.source_hz = 0.0
            return load
        source = self._sources[topic]
        measure = source.measure
        if self._asking[topic]:
            source.before = measure
        elif source.before is not None:
            measure = source.before
        elif load.size_kb and not math.isinf(load.wanted_hz):
            return load
        streams = self._streams_of(topic)
        load.size_kb, load.source_hz = measure.message_kb * streams, measure.source_hz / streams
        return load

    def _streams_of(self, topic: str) -> float:
        return self._streams.get(topic, self._entries[topic].streams)


def _stale_after_ns(rule_set: RuleSet, profile: Profile) -> dict[str, int | None]:
    after_s = {topic: profile.topic(topic).stale_after_s for topic in rule_set.relayed}
    return {topic: None if stale_s is None else ns_from_s(stale_s) for topic, stale_s in after_s.items()}


def _entries(rule_set: RuleSet, profile: Profile) -> dict[str, TopicProfile]:
    return {topic: profile.topic(topic) for topic in rule_set.relayed}


def _unmeasured(rule_set: RuleSet, profile: Profile) -> dict[str, TopicRequest]:
    loads = {}
    for topic in rule_set.relayed:
        entry = profile.topic(topic)
        loads[topic] = TopicRequest(
            topic=topic,
            requested_hz=0.0,
            floor_hz=max(rule_set.floors_hz.get(topic, 0.0), entry.min_hz or 0.0),
            priority=entry.priority,
            size_kb=entry.kb_per_hz or 0.0,
            source_hz=math.inf if entry.stream_hz is None else entry.stream_hz,
        )
    return loads
