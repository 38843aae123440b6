# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Why rules ask for a rate: the values that they read, and the nearest border of each that changes it."""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from smarttestudo.domain.decision import PlannedRate
from smarttestudo.domain.rate import Rate
from smarttestudo.domain.signal import Signal, SignalKind, Value
from smarttestudo.language.evaluator.evaluator import Evaluator
from smarttestudo.language.normal_form import HELD, LAST_SEEN, AnyElement, is_derived, reads
from smarttestudo.language.properties.field_path import ANY
from smarttestudo.language.region import Bound, Region
from smarttestudo.language.rule_set import RuleSet
from smarttestudo.language.text_region import SetOfValues, TextRegion

SignalValues = Mapping[Signal, Value | None]
"""The values of signals by their names; those that are not known are ``None`` or missing."""

_MOST_FOR_UNKNOWN = 4


@dataclass(frozen=True, slots=True, kw_only=True)
class RateBorder:
    """The request of the rules where one value lies in ``where`` and all others stay as they are.

    ``is_lasting``: only once that has lasted as long as a ``For`` or ``Within`` says.
    """

    where: SetOfValues
    request: PlannedRate
    is_lasting: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class ExplainedValue:
    """A value that the rules of a topic read, with its nearest borders below and above.

    Of an unknown value ``borders`` are the first few intervals that would change the rate. ``signal`` may
    also stand for how many seconds a condition has held.
    """

    signal: Signal
    value: Value | None
    borders: tuple[RateBorder, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class RateExplanation:
    """The request of the rules for a topic, and the values that they read for it."""

    request: PlannedRate
    values: tuple[ExplainedValue, ...]


def explain(rule_set: RuleSet, topic: str, values: SignalValues) -> RateExplanation:
    """Explain the request for ``topic``, which the rules relay, with the signals of the deciding block first.

    ``values`` has what is derived, too: by the names of ``HeldTime`` for how long a condition has held, by
    those of ``LastSeen`` and ``AnyElement`` 1 or 0.
    """
    states = _rules_of(rule_set.over_states(), topic)
    question = _Question(states, topic, values)
    first = question.decided_by
    order = {signal: place for place, signal in enumerate(question.signals_of(first))}
    signals = sorted(question.signals, key=lambda signal: (order.get(signal, len(order)), signal))
    return RateExplanation(
        request=question.request,
        values=tuple(question.explained(signal) for signal in signals if not _is(signal, LAST_SEEN)),
    )


def explain_block(
    rule_set: RuleSet, label: str, line: int, values: SignalValues
) -> tuple[ExplainedValue, ...]:
    """The values that the block of that name and line reads, with the borders where it no longer holds.

    For a decision of before, of which no other values are known. Nothing where there is no such block.
    """
    topic = ""
    for block in rule_set.blocks:
        if (block.label, block.line) == (label, line):
            alone = replace(block, rates={topic: Rate.full()}, bounds={}, priority=0)
            only = RuleSet(defaults={topic: Rate.off()}, default_lines={}, floors_hz={}, blocks=(alone,))
            # It held, for as long as it asks for.
            return explain(only, topic, {**values, **_held_long(only), **_of_any(only, values)}).values
    return ()


def _held_long(rule_set: RuleSet) -> dict[Signal, float]:
    derived = (Signal(*signal) for signal in rule_set.over_states().signals if is_derived(signal))
    return {signal: math.inf for signal in derived if _is(signal, HELD)}


def _of_any(rule_set: RuleSet, values: SignalValues) -> dict[Signal, float]:
    """Whether any element was in a region, by the one whose value is known."""
    found: dict[Signal, float] = {}
    for within in (within for block in rule_set.blocks for within in reads(block.form)):
        value = values.get(within.signal)
        if ANY in within.signal.property and value is not None:
            derived = AnyElement(within.signal, within.region)
            found[Signal(*derived)] = float(within.region.contains(value))  # type: ignore[arg-type]  # of one sort
    return found


def _is(signal: Signal, derived: str) -> bool:
    """Whether ``signal`` stands for the past of others in this way; a message may have such a field."""
    return signal.property == derived and is_derived(signal)


def _rules_of(rule_set: RuleSet, topic: str) -> RuleSet:
    """The part of the rules that decides on ``topic``."""
    blocks = (block for block in rule_set.blocks if topic in block.topics)
    margins = {name: margin for name, margin in rule_set.default_margins.items() if name == topic}
    return replace(
        rule_set,
        default_margins=margins,
        blocks=tuple(replace(block, order=order, recordings=()) for order, block in enumerate(blocks)),
    )


class _Question:
    """The request for a topic now, and what it would be with another value of one signal."""

    def __init__(self, rule_set: RuleSet, topic: str, values: SignalValues) -> None:
        self._topic = topic
        self._values = values
        self._now = Evaluator(rule_set)
        self._later = Evaluator(rule_set)
        """Once all that is said to hold, or not to, has lasted."""
        self.signals = rule_set.signals
        for signal in self.signals:
            self._now.set(signal, values.get(signal))
            self._later.set(signal, math.inf if _is(signal, HELD) else values.get(signal))
        decided = self._now.decide(topic)
        self.request, self.decided_by = decided.planned, decided.block
        self._request_later = self._later.request(topic)

    def signals_of(self, block: int | None) -> Sequence[Signal]:
        """The signals that a block reads."""
        return [] if block is None else self._now.reads(block)

    def explained(self, signal: Signal) -> ExplainedValue:
        """The borders of one signal."""
        value = self._values.get(signal)
        if isinstance(value, str) or signal.kind is SignalKind.TEXT:
            borders = [*_first(self._unlike(signal, _other_texts(self._now.texts(signal), value)))]
            self._set(signal, value)
            return ExplainedValue(signal=signal, value=value, borders=tuple(borders))
        value = None if value is None or math.isnan(value) else value
        cuts: list[Bound] = self._now.cuts(signal)
        if value is None and _is(signal, HELD):
            borders = []
        elif value is None:
            borders = [*_first(self._unlike(signal, _intervals(cuts)))]
        else:
            place = bisect_left(cuts, (value, 0))
            # Time only passes: a condition that holds has held for longer later.
            below = [] if _is(signal, HELD) else [_below(cut) for cut in reversed(cuts[:place])]
            above = [_above(cut) for cut in cuts[place:]]
            found = (next(self._unlike(signal, side), None) for side in (_nearest(below), _nearest(above)))
            borders = [border for border in found if border is not None]
        self._set(signal, value)
        return ExplainedValue(signal=signal, value=value, borders=tuple(borders))

    def _unlike(
        self, signal: Signal, regions: Iterable[tuple[SetOfValues, SetOfValues]]
    ) -> Iterator[RateBorder]:
        """The regions, each with the part of it that is tried, in which the rate is another one."""
        for where, tried in regions:
            if tried.is_empty:
                continue
            self._set(signal, tried.sample())
            request, later = self._now.request(self._topic), self._later.request(self._topic)
            if _differs(request, self.request):
                yield RateBorder(where=where, request=request, is_lasting=False)
            elif _differs(later, self.request) and _differs(later, self._request_later):
                yield RateBorder(where=where, request=later, is_lasting=True)

    def _set(self, signal: Signal, value: Value | None) -> None:
        self._now.set(signal, value)
        if not _is(signal, HELD):
            self._later.set(signal, value)


def _differs(one: PlannedRate, other: PlannedRate) -> bool:
    return (one.rate, one.within) != (other.rate, other.within)


def _below(cut: Bound) -> Region:
    return Region.everything().intersection(Region((((-math.inf, -1), cut),)))


def _above(cut: Bound) -> Region:
    return Region.everything().intersection(Region(((cut, (math.inf, 1)),)))


def _nearest(sides: Sequence[Region]) -> Iterator[tuple[Region, Region]]:
    """Half lines from near to far, each with what of it is before the next."""
    for number, side in enumerate(sides):
        after = sides[number + 1] if number + 1 < len(sides) else Region.nothing()
        yield side, side.intersection(after.complement())


def _intervals(cuts: Sequence[Bound]) -> Iterator[tuple[Region, Region]]:
    for low, high in zip(((-math.inf, -1), *cuts), (*cuts, (math.inf, 1)), strict=True):
        interval = _above(low).intersection(_below(high))
        yield interval, interval


def _other_texts(texts: Iterable[str], value: Value | None) -> Iterator[tuple[TextRegion, TextRegion]]:
    """Texts that are compared with, and all others, without the ones that ``value`` is among."""
    compared = frozenset(texts)
    regions = [TextRegion(frozenset((text,))) for text in sorted(compared)]
    for region in (*regions, TextRegion(compared, is_inverse=True)):
        if value is None or not region.contains(value):
            yield region, region


def _first(borders: Iterator[RateBorder]) -> Iterator[RateBorder]:
    """The first border for each rate, at most a few."""
    seen: set[Rate] = set()
    for border in borders:
        if border.request.rate not in seen:
            seen.add(border.request.rate)
            yield border
        if len(seen) == _MOST_FOR_UNKNOWN:
            return
