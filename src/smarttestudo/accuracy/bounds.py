# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The bounds of the rules, judged by what an operator received."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from operator import itemgetter
from typing import Annotated

from smarttestudo.accuracy.arms import Later, Receiver
from smarttestudo.accuracy.samples import Message
from smarttestudo.domain.decision import Decision
from smarttestudo.domain.record import JsonEntry, derived
from smarttestudo.domain.units import FIRST_STAMP_NS, NS_PER_S
from smarttestudo.language.rule_set import RuleSet
from smarttestudo.loop.decision_log import with_run_starts

MOST_STRETCHES = 20
"""Broken stretches that are told of one bound; the others are counted."""

Bounds = Mapping[str, float]
"""By property."""

BoundsFrom = tuple[int, Bounds]
"""A stamp in ns, and the bounds that are in force from it on."""


@dataclass(frozen=True, slots=True, kw_only=True)
class BrokenStretch:
    """From A's first message with the picture out of bounds to its next one with the picture within them.

    It ends earlier where the bound is no longer in force, and at the end of A. Times are in s since the start
    of A; ``worst`` is ``None`` where nothing was shown.
    """

    from_s: float
    to_s: float
    messages: int
    worst: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class BoundLoss:
    """How one bound of the rules was kept, over the messages of A while it was in force.

    ``broken`` counts those after which the picture was more than ``bound`` off, or showed nothing;
    ``unreadable`` those without a value, which are not among ``messages``. ``worst`` is the largest finite
    error, at ``worst_at_s``; both are ``None`` where there is none. ``stretches`` are the first of
    ``stretch_count``, which last ``broken_s`` together. ``reckons``: the receiver shows dead reckoning.
    """

    topic: str
    property_name: Annotated[str, JsonEntry(name="property")]
    unit: str
    bound: float
    reckons: bool
    in_force_s: float
    messages: int
    broken: int
    unreadable: int
    worst: float | None
    worst_at_s: float | None
    broken_s: float
    stretch_count: int
    stretches: tuple[BrokenStretch, ...]

    @property
    @derived("held")
    def is_held(self) -> bool:
        """Whether the picture was within the bound after every message."""
        return not self.broken


def bounds_of(rule_set: RuleSet) -> dict[str, dict[str, set[float]]]:
    """Every bound that the rules write down, by topic and property."""
    found: dict[str, dict[str, set[float]]] = {}
    for bounds in (rule_set.bounds, *(block.bounds for block in rule_set.blocks)):
        for topic, of_topic in bounds.items():
            for name, bound in of_topic.items():
                found.setdefault(topic, {}).setdefault(name, set()).add(bound)
    return found


def bounded_topics(rule_set: RuleSet) -> frozenset[str]:
    """The topics that have a bound somewhere in the rules."""
    return frozenset(bounds_of(rule_set))


def needs_decisions(rule_set: RuleSet, topic: str) -> bool:
    """Whether a block decides which bounds of ``topic`` are in force."""
    return any(topic in block.bounds for block in rule_set.blocks)


def bounds_in_force(rule_set: RuleSet, topic: str, decisions: Sequence[Decision]) -> Sequence[BoundsFrom]:
    """The bounds of ``topic`` over time, from the decisions where a block has a word in it.

    These are in the order in which they were taken, of one run after the other.
    """
    if not needs_decisions(rule_set, topic):
        return ((FIRST_STAMP_NS, rule_set.bounds.get(topic, {})),)
    found: list[BoundsFrom] = []
    run_ns: int | None = None
    for began_ns, one in with_run_starts(decisions):
        if began_ns != run_ns:
            run_ns = began_ns
            found.append((began_ns, {}))
        if one.topic == topic and one.from_within != one.planned.within:
            found.append((one.stamp_ns, one.planned.within))
    return sorted(found, key=itemgetter(0))


class BoundWatch:
    """The bounds of one topic, tallied over the messages sent while they are in force.

    ``written`` are the bounds of the rules, told of also where none was in force; ``in_force`` are those that
    count, by stamp. Times of the result count from ``start_ns``. With ``reckons`` the receiver shows dead
    reckoning.
    """

    def __init__(
        self,
        receiver: Receiver,
        in_force: Sequence[BoundsFrom],
        written: Mapping[str, Collection[float]],
        *,
        reckons: bool,
        start_ns: int,
    ) -> None:
        self._receiver, self._reckons, self._start_ns = receiver, reckons, start_ns
        self._coming = iter(in_force)
        self._next = next(self._coming, None)
        self._bounds: Bounds = {}
        self._tallies = {
            (name, bound): _Tally(start_ns) for name in sorted(written) for bound in sorted(written[name])
        }

    def sent(self, message: Message, later: Later) -> None:
        """Count a message that the robot sent, by how far the picture is off from it.

        ``later`` messages of its stamp follow.
        """
        now_ns = message.stamp_ns
        self._receiver.catch_up(message, later)
        self._advance(now_ns)
        if not self._bounds:
            return
        errors = self._receiver.errors(message)
        for name, bound in self._bounds.items():
            tally = self._tally(name, bound)
            if name in errors:
                tally.judge(now_ns, errors[name], is_broken=errors[name] > bound)
            else:
                tally.unreadable += 1

    def losses(self, topic: str, units: Mapping[str, str], end_ns: int) -> Iterator[BoundLoss]:
        """End with A: what was found of ``topic``."""
        self._advance(end_ns)
        for name, bound in self._bounds.items():
            self._tally(name, bound).leave(end_ns)
        for (name, bound), tally in self._tallies.items():
            yield BoundLoss(
                topic=topic,
                property_name=name,
                unit=units.get(name, ""),
                bound=bound,
                reckons=self._reckons,
                in_force_s=tally.in_force_ns / NS_PER_S,
                messages=tally.messages,
                broken=tally.broken,
                unreadable=tally.unreadable,
                worst=tally.worst,
                worst_at_s=tally.worst_at_s,
                broken_s=tally.broken_ns / NS_PER_S,
                stretch_count=tally.stretch_count,
                stretches=tuple(tally.stretches),
            )

    def _advance(self, now_ns: int) -> None:
        """Take the bounds that came into force until ``now_ns``."""
        while self._next is not None and self._next[0] <= now_ns:
            from_ns, bounds = max(self._next[0], self._start_ns), self._next[1]
            for name, bound in self._bounds.items():
                if bounds.get(name) != bound:
                    self._tally(name, bound).leave(from_ns)
            for name, bound in bounds.items():
                if self._bounds.get(name) != bound:
                    self._tally(name, bound).enter(from_ns)
            self._bounds = bounds
            self._next = next(self._coming, None)

    def _tally(self, name: str, bound: float) -> _Tally:
        return self._tallies.setdefault((name, bound), _Tally(self._start_ns))


class _Tally:
    """Counts of one bound while it is in force; times in s count from ``start_ns``."""

    def __init__(self, start_ns: int) -> None:
        self.messages = self.broken = self.unreadable = 0
        self.in_force_ns = self.broken_ns = self.stretch_count = 0
        self.worst: float | None = None
        self.worst_at_s: float | None = None
        self.stretches: list[BrokenStretch] = []
        self._start_ns = self._entered_ns = start_ns
        self._broken_since_ns: int | None = None
        self._broken_before = 0
        self._worst_since: float | None = None

    def enter(self, now_ns: int) -> None:
        """The bound is in force from now on."""
        self._entered_ns = now_ns

    def leave(self, now_ns: int) -> None:
        """The bound is not in force any more, or the recording ends."""
        self.in_force_ns += max(0, now_ns - self._entered_ns)
        self._close(now_ns)

    def judge(self, now_ns: int, error: float, *, is_broken: bool) -> None:
        """The picture's error after a message."""
        self.messages += 1
        if error < math.inf and (self.worst is None or error > self.worst):
            self.worst, self.worst_at_s = error, self._seconds(now_ns)
        if not is_broken:
            self._close(now_ns)
            return
        if self._broken_since_ns is None:
            self._broken_since_ns, self._broken_before, self._worst_since = now_ns, self.broken, None
        self.broken += 1
        if error < math.inf and (self._worst_since is None or error > self._worst_since):
            self._worst_since = error

    def _close(self, now_ns: int) -> None:
        from_ns, self._broken_since_ns = self._broken_since_ns, None
        if from_ns is None:
            return
        self.broken_ns += now_ns - from_ns
        self.stretch_count += 1
        if len(self.stretches) < MOST_STRETCHES:
            self.stretches.append(
                BrokenStretch(
                    from_s=self._seconds(from_ns),
                    to_s=self._seconds(now_ns),
                    messages=self.broken - self._broken_before,
                    worst=self._worst_since,
                )
            )

    def _seconds(self, stamp_ns: int) -> float:
        return (stamp_ns - self._start_ns) / NS_PER_S
