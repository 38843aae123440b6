# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A second opinion on the whole loop: at each step, everything anew from the full history."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import pairwise
from typing import Any

from language.evaluator.naive_rules import (
    NaiveRequest,
    naive_blocks,
    naive_request,
    naive_shown,
    naive_signals,
)
from smarttestudo.domain.observation import (
    Arrival,
    Observation,
    SourceChanged,
    Undecodable,
    VitalsMeasured,
)
from smarttestudo.domain.signal import Signal, SignalKind, Value, Values
from smarttestudo.language.syntax import RuleFile

SECOND = 1_000_000_000


@dataclass(frozen=True, slots=True, kw_only=True)
class NaiveDecision:
    t_ns: int
    topic: str
    before: NaiveRequest | None
    after: NaiveRequest
    values: dict[str, Value | None]


ABSENT = "absent"
"""Stands for an element that a message has not."""


def naive_field(signal: Signal, message: Any) -> Values | str | None:
    """What a message has of ``x``, of each of ``xs[*]``, or of the one called ``xs["b"]``."""

    def of_kind(part: object) -> Value | None:
        if signal.kind is SignalKind.TEXT:
            return part if isinstance(part, str) else None
        return None if isinstance(part, str) or math.isnan(part) else float(part)  # type: ignore[arg-type]

    if "[" not in signal.property:
        return of_kind(getattr(message, signal.property, math.nan))
    elements = getattr(message, "xs", None)
    if elements is None:
        return None
    if signal.property == "xs[*].x":
        known = [part for part in (of_kind(element.x) for element in elements) if part is not None]
        return tuple(known) if known or not elements else None
    return next((of_kind(element.x) for element in elements if element.name == "b"), ABSENT)


def _differs(before: NaiveRequest, after: NaiveRequest) -> bool:
    is_settled = (before.reason == "unknown") == (after.reason == "unknown")
    return not is_settled or (before.height, before.place) != (after.height, after.place)


@dataclass(kw_only=True)
class NaiveLoop:
    """Time counts from the start and only forward; ``settle_ns`` and ``stale_after_ns`` as in the profile."""

    files: Sequence[RuleFile]
    topics: Sequence[str]
    settle_ns: int
    stale_after_ns: dict[str, int]
    events: list[tuple[int, Observation]] = field(default_factory=list)
    requests: dict[str, list[tuple[int, NaiveRequest]]] = field(default_factory=dict)
    effective: dict[str, NaiveRequest] = field(default_factory=dict)

    def step(self, observations: Sequence[Observation], now: int) -> list[NaiveDecision]:
        self.events += [(now, observation) for observation in observations]
        values = self.values(now)
        decisions = []
        for topic in self.topics:
            self.requests.setdefault(topic, []).append((now, naive_request(self.files, topic, values)))
            before, after = self.effective.get(topic), self.settled(self.requests[topic], now)
            self.effective[topic] = after
            if before is None or _differs(before, after):
                decisions.append(
                    NaiveDecision(
                        t_ns=now, topic=topic, before=before, after=after, values=self.read(after, values)
                    )
                )
        return decisions

    def peek(self, now: int) -> dict[str, NaiveRequest]:
        """What a step at ``now`` without observations would make effective."""
        values = self.values(now)
        return {
            topic: self.settled([*self.requests[topic], (now, naive_request(self.files, topic, values))], now)
            for topic in self.topics
        }

    def settled(self, requests: Sequence[tuple[int, NaiveRequest]], now: int) -> NaiveRequest:
        """The highest request of the last ``settle_ns``, the latest among equals."""
        ends = [start for start, _ in requests[1:]] + [math.inf]
        counting = [
            request for (_, request), end in zip(requests, ends, strict=True) if now < end + self.settle_ns
        ]
        highest = max(request.height for request in counting)
        return next(request for request in reversed(counting) if request.height == highest)

    def values(self, now: int) -> dict[Signal, Values | None]:
        signals = {s for block in naive_blocks(self.files) for s in naive_signals(block.condition)}
        return {signal: self.value(signal, now) for signal in signals}

    def read(self, request: NaiveRequest, values: dict[Signal, Values | None]) -> dict[str, Value | None]:
        if request.place is None:
            return {}
        condition = naive_blocks(self.files)[request.place].condition
        return {
            str(signal): naive_shown(condition, signal, values[signal])
            for signal in sorted(naive_signals(condition))
        }

    def value(self, signal: Signal, now: int) -> Values | None:
        if signal.kind is SignalKind.UNRESOLVED:
            return None
        if signal.topic.startswith("@"):
            return self.vital(signal, now)
        arrivals = [
            (at, one) for at, one in self.events if isinstance(one, Arrival) and one.topic == signal.topic
        ]
        recent = [one for at, one in arrivals if now - 2 * SECOND < at <= now]
        match signal.property:
            case "rate" | "bandwidth" | "age" if signal.kind is SignalKind.TEXT:
                return None
            case "rate":
                return len(recent) / 2
            case "bandwidth":
                return sum(one.size_bytes for one in recent) / 1000 / 2
            case "age":
                return (now - (arrivals[-1][0] if arrivals else 0)) / SECOND
        if signal.property == 'xs["b"].x':
            return self.element(signal, arrivals, now)
        if not arrivals or self.is_gone(signal.topic) or self.is_stale(signal, arrivals, now):
            return None
        message = arrivals[-1][1].message
        return None if message is None or isinstance(message, Undecodable) else naive_field(signal, message)

    def element(self, signal: Signal, arrivals: Sequence[tuple[int, Arrival]], now: int) -> Values | None:
        """The value in the last message that has it, unless all is forgotten since, or it is stale."""
        if self.is_gone(signal.topic):
            return None
        having = [
            (at, one)
            for at, one in arrivals
            if one.message is not None
            and not isinstance(one.message, Undecodable)
            and naive_field(signal, one.message) != ABSENT
        ]
        known: Values | None = None
        for _, one in self.events:
            if isinstance(one, SourceChanged) and one.topic == signal.topic and not one.publishers:
                known = None
            if isinstance(one, Arrival) and one.topic == signal.topic:
                if one.message is None or isinstance(one.message, Undecodable):
                    known = None
                elif (found := naive_field(signal, one.message)) != ABSENT:
                    known = found
        return None if not having or self.is_stale(signal, having, now) else known

    def vital(self, signal: Signal, now: int) -> float | None:
        measured = [
            (at, one)
            for at, one in self.events
            if isinstance(one, VitalsMeasured) and one.source == signal.topic
        ]
        if not measured or now - measured[-1][0] >= 5 * SECOND or signal.kind is SignalKind.TEXT:
            return None
        return measured[-1][1].values.get(signal.property)

    def is_gone(self, topic: str) -> bool:
        """No publisher, or none was heard since the last time there was none."""
        mine = [
            one for _, one in self.events if isinstance(one, Arrival | SourceChanged) and one.topic == topic
        ]
        changes = [one for one in mine if isinstance(one, SourceChanged)]
        if changes and changes[-1].publishers == 0:
            return True
        for one in reversed(mine):
            if isinstance(one, Arrival):
                return False
            if one.publishers == 0:
                return True
        return False

    def is_stale(self, signal: Signal, arrivals: Sequence[tuple[int, Arrival]], now: int) -> bool:
        age, topic = now - arrivals[-1][0], signal.topic
        if topic in self.stale_after_ns:
            return age > self.stale_after_ns[topic]
        if signal.kind is not SignalKind.NUMBER:
            return False
        changes = [one for _, one in self.events if isinstance(one, SourceChanged) and one.topic == topic]
        stamps = [at for at, _ in arrivals]
        intervals = [late - early for early, late in pairwise(stamps)][-20:]
        if (changes and changes[-1].transient_local) or len(intervals) < 3:
            return False
        return age > 2 * SECOND and age > 5 * Fraction(sum(intervals), len(intervals))
