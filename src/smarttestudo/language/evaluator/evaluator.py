# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The one evaluator of rule sets."""

from __future__ import annotations

from bisect import bisect_left, insort
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass, replace
from typing import Any

from smarttestudo.domain.decision import BoundReason, PlannedRate, Reason
from smarttestudo.domain.rate import Rate
from smarttestudo.domain.signal import Signal, SignalKind, Truth, Values
from smarttestudo.domain.timing import Yield, never_yield, yielding
from smarttestudo.language.evaluator.graph import Graph, Propagation
from smarttestudo.language.evaluator.literal import (
    TRUE,
    UNKNOWN,
    Latch,
    Leaf,
    Literal,
    TextThresholds,
    Thresholds,
)
from smarttestudo.language.normal_form import HeldTime, LastSeen, signals_of
from smarttestudo.language.properties.field_path import ANY
from smarttestudo.language.region import Bound
from smarttestudo.language.rule_set import RuleBlock, RuleSet


@dataclass(frozen=True, slots=True, kw_only=True)
class RequestedRate:
    """The rate that the rules ask for now, and the order of the deciding block where a block decides."""

    planned: PlannedRate
    block: int | None


class Ranking:
    """The blocks that set one thing and are true or unknown, kept sorted so that the best is at hand.

    A block's rank is its place by (priority, merit, earliest in the file first); it never changes.
    """

    __slots__ = ("_blocks", "_merit", "_true", "_unknown", "rank_of")

    def __init__(self, blocks: Iterable[RuleBlock], merit: Callable[[RuleBlock], Any]) -> None:
        def placed(block: RuleBlock) -> tuple[Any, int]:
            return merit(block), -block.order

        self._merit = placed
        self._blocks = sorted(blocks, key=lambda block: (block.priority, *self._merit(block)))
        self.rank_of = {block.order: rank for rank, block in enumerate(self._blocks)}
        self._true: list[int] = []
        self._unknown: dict[int, list[int]] = {}
        for rank, block in enumerate(self._blocks):
            self._unknown.setdefault(block.priority, []).append(rank)

    def move(self, rank: int, before: int, after: int) -> None:
        """The block of ``rank`` went from one truth to another."""
        self._drop(rank, before)
        if after == TRUE:
            insort(self._true, rank)
        elif after == UNKNOWN:
            insort(self._unknown.setdefault(self._blocks[rank].priority, []), rank)

    @property
    def known(self) -> RuleBlock | None:
        """The best of the highest priority among those that are known to hold."""
        return self._blocks[self._true[-1]] if self._true else None

    def best_unknown(self, known: RuleBlock | None) -> RuleBlock | None:
        """The best unknown block among those that could overrule ``known``."""
        candidates = (
            self._blocks[ranks[-1]]
            for priority, ranks in self._unknown.items()
            if known is None or priority >= known.priority
        )
        return max(candidates, key=self._merit, default=None)

    def _drop(self, rank: int, truth: int) -> None:
        if truth == TRUE:
            del self._true[bisect_left(self._true, rank)]
        elif truth == UNKNOWN:
            priority = self._blocks[rank].priority
            ranks = self._unknown[priority]
            del ranks[bisect_left(ranks, rank)]
            if not ranks:
                del self._unknown[priority]


class RateArbiter:
    """Which rate the rules ask for one topic."""

    __slots__ = ("_default", "_default_reason", "_floor_hz", "_topic", "ranking")

    def __init__(self, topic: str, blocks: Iterable[RuleBlock], rule_set: RuleSet) -> None:
        self._topic = topic
        self._default = rule_set.defaults.get(topic, Rate.full())
        self._default_reason = rule_set.default_reason
        self._floor_hz = rule_set.floors_hz.get(topic, 0.0)

        def merit(block: RuleBlock) -> tuple[float, bool]:
            # As rates order, and much faster to compare.
            rate = block.rates[topic]
            return rate.hz, rate.yields_to_floor

        self.ranking = Ranking(blocks, merit)

    def request(self) -> RequestedRate:
        """Rules 3 to 6 of the language: priority, then rate; in doubt more; never below the floor."""
        known = self.ranking.known
        rate = known.rates[self._topic] if known else self._default
        reason = Reason.BLOCK if known else self._default_reason
        doubt = self.ranking.best_unknown(known)
        if doubt and doubt.rates[self._topic] > rate:
            known, rate, reason = doubt, doubt.rates[self._topic], Reason.UNKNOWN
        raised = rate.at_least(self._floor_hz)
        if raised is not rate:
            reason = Reason.FLOOR
        planned = PlannedRate(
            rate=raised,
            reason=reason,
            rule=known.label if known else None,
            line=known.line if known else None,
        )
        return RequestedRate(planned=planned, block=known.order if known else None)


class BoundArbiter:
    """Which bound the rules ask for one property of one topic."""

    __slots__ = ("_default", "_topic", "property", "ranking")

    def __init__(self, topic: str, name: str, blocks: Iterable[RuleBlock], rule_set: RuleSet) -> None:
        self._topic = topic
        self.property = name
        self._default = rule_set.bounds.get(topic, {}).get(name)
        self.ranking = Ranking(blocks, lambda block: -block.bounds[topic][name])

    @property
    def is_known(self) -> bool:
        """Whether the property is bound whatever the unknown blocks turn out to be."""
        return self._default is not None or self.ranking.known is not None

    def request(self, *, doubt_counts: bool) -> tuple[float | None, RuleBlock | None, Reason]:
        """The bound, the block that decides it, and why: priority, then the tightest.

        In doubt the tightest, where ``doubt_counts``. The bound is ``None`` while nothing bounds the
        property; a block beside it is one in doubt that would.
        """
        known = self.ranking.known
        bound, reason = self._default, Reason.DEFAULT
        if known is not None:
            bound, reason = known.bounds[self._topic][self.property], Reason.BLOCK
        doubt = self.ranking.best_unknown(known)
        if doubt is not None:
            feared = doubt.bounds[self._topic][self.property]
            if bound is None or feared < bound:
                return feared if doubt_counts else None, doubt, Reason.UNKNOWN
        return bound, known, reason


class TopicArbiter:
    """The request of the rules for one topic: its rate, and the bounds of the receiver's picture."""

    __slots__ = ("_bounds", "_rate")

    def __init__(self, topic: str, blocks: Sequence[RuleBlock], rule_set: RuleSet) -> None:
        self._rate = RateArbiter(topic, [block for block in blocks if topic in block.rates], rule_set)
        names = dict.fromkeys(rule_set.bounds.get(topic, {}))
        for block in blocks:
            names.update(dict.fromkeys(block.bounds.get(topic, {})))
        self._bounds = [
            BoundArbiter(
                topic, name, [block for block in blocks if name in block.bounds.get(topic, {})], rule_set
            )
            for name in names
        ]

    def rankings_of(self, order: int) -> list[tuple[Ranking, int]]:
        """The rankings that hold the block of that order, with its rank in each."""
        rankings = (self._rate.ranking, *(bound.ranking for bound in self._bounds))
        return [(ranking, ranking.rank_of[order]) for ranking in rankings if order in ranking.rank_of]

    def request(self) -> RequestedRate:
        """The rate with its reason, and the bounds.

        A topic without any bound passes all that its rate lets through, which is more than with one: so
        bounds of unknown blocks count only where a known one bounds the topic. Where no block decides the
        rate, the first that decides a bound stands for it.
        """
        request = self._rate.request()
        if not self._bounds:
            return request
        is_bound = any(arbiter.is_known for arbiter in self._bounds)
        within: dict[str, float] = {}
        reasons: dict[str, BoundReason] = {}
        for arbiter in self._bounds:
            bound, block, reason = arbiter.request(doubt_counts=is_bound)
            if bound is None and block is None:
                continue
            label, line = (None, None) if block is None else (block.label, block.line)
            reasons[arbiter.property] = BoundReason(reason=reason, rule=label, line=line)
            if bound is None:
                continue
            within[arbiter.property] = bound
            if block is not None and request.block is None and request.planned.reason is Reason.DEFAULT:
                planned = replace(request.planned, reason=reason, rule=label, line=line)
                request = RequestedRate(planned=planned, block=block.order)
        return replace(request, planned=replace(request.planned, within=within, bound_reasons=reasons))


class Evaluator:
    """The requests of a rule set, given the values of its signals; all signals start unknown.

    A new value costs in proportion to the thresholds it crosses and the blocks it changes, whatever the
    size of the rule set. Time passes with ``advance``; what is remembered of conditions takes two numbers
    each.
    """

    def __init__(self, rule_set: RuleSet, start_ns: int = 0, yield_turn: Yield = never_yield) -> None:
        self._graph = graph = Graph()
        self._blocks = rule_set.blocks
        self._literals = [_literal(graph, block) for block in yielding(rule_set.blocks, yield_turn)]
        self._thresholds = _thresholds(graph)
        self._arbiters = _arbiters(rule_set, yield_turn)
        self._entries = [
            [
                (topic, *ranking)
                for topic in block.topics
                for ranking in self._arbiters[topic].rankings_of(block.order)
            ]
            for block in yielding(rule_set.blocks, yield_turn)
        ]
        self._changed_topics = set(self._arbiters)
        self._changed_blocks: set[int] = set()
        self._changed_ns = [start_ns] * len(rule_set.blocks)
        self._recording = {block.order for block in rule_set.blocks if block.recordings}
        self.has_recordings = bool(self._recording)
        self._turned_recordings: list[tuple[int, Truth]] = []
        self._has_started_to_record = True
        self._propagation = Propagation(graph, self._block_changed, start_ns)

    @property
    def touched(self) -> int:
        """How many parts of the network were visited so far, a measure of cost that needs no clock."""
        return self._propagation.touched

    @property
    def next_alarm_ns(self) -> int | None:
        """When time alone may next change a condition; it may come early, never late. ``None``: never."""
        return self._propagation.next_alarm_ns

    def advance(self, now_ns: int) -> None:
        """Let time pass until ``now_ns``; what is ``set`` from now on happens then. Time never goes back."""
        self._propagation.advance(now_ns)

    @property
    def values(self) -> Mapping[Signal, Values | None]:
        """The last value of each signal. Another thread may ask for them."""
        return {signal: thresholds.value for signal, thresholds in self._thresholds.items()}

    def foresee(self, values: Mapping[Signal, Values | None], yield_turn: Yield = never_yield) -> None:
        """Compute with ``values`` as what may hold at the ``start``: what turns out to does not cost again.

        What remembers the past takes no part.
        """
        for signal, value in values.items():
            thresholds = self._thresholds.get(signal)
            if thresholds is not None and not thresholds.has_latch:
                self.set(signal, value)
        self._propagation.settle_joins(yield_turn)

    def start(self, now_ns: int) -> None:
        """Have the time begin at ``now_ns``, in place of when this was made: nothing has happened yet."""
        self._changed_ns = [now_ns] * len(self._changed_ns)
        self._propagation.now_ns = now_ns
        self._turned_recordings = []
        self._has_started_to_record = False

    def dismantle(self, yield_turn: Yield = never_yield) -> None:
        """Let go of every part, piece by piece: what holds each other is else freed in one long stop."""
        self._graph.dismantle(yield_turn)
        del self._propagation

    def restore_history(self, before: Evaluator) -> None:
        """Take over the history of every condition that ``before`` has, too, be it with other durations.

        To be followed by an ``advance`` and the values of all signals.
        """
        known_of = {held: window for (held, _), window in before._graph.windows.items()}
        for (held, _), window in self._graph.windows.items():
            known = known_of.get(held)
            if known is not None:
                self._propagation.restore_history(window, known)
        for signal, latch in self._graph.latches.items():
            remembered = before._graph.latches.get(signal)
            if remembered is not None:
                latch.restore_history(remembered)

    def set(self, signal: Signal, value: Values | None) -> None:
        """Take a signal's value; ``None`` and NaN mean unknown. Signals that no check reads are ignored."""
        thresholds = self._thresholds.get(signal)
        if thresholds is None:
            return
        for leaf in thresholds.move(value):
            self._propagation.change(leaf, leaf.truth_at(thresholds.value))

    def take_changed_topics(self) -> AbstractSet[str]:
        """The topics whose request may have changed since the last call; at first all that are relayed."""
        self._propagation.settle()
        changed, self._changed_topics = self._changed_topics, set()
        return changed

    def take_changed_blocks(self) -> AbstractSet[int]:
        """The blocks, by order, that turned since the last call; at first none: all start unknown."""
        self._propagation.settle()
        changed, self._changed_blocks = self._changed_blocks, set()
        return changed

    def take_turned_recordings(self) -> list[tuple[int, Truth]]:
        """The blocks with recordings, by order, and what they turned to since the last call, in order."""
        self._propagation.settle()
        turned, self._turned_recordings = self._turned_recordings, []
        if not self._has_started_to_record:
            # Until now all were unknown, whatever was foreseen.
            self._has_started_to_record = True
            known = [(order, self.truth(order)) for order in sorted(self._recording)]
            return [(order, truth) for order, truth in known if truth is not Truth.UNKNOWN]
        return turned

    def request(self, topic: str) -> PlannedRate:
        """The rate that the rules ask for now; ``topic`` is one of the rule set's relayed topics."""
        return self.decide(topic).planned

    def decide(self, topic: str) -> RequestedRate:
        """Like ``request``, with the order of the deciding block."""
        self._propagation.settle()
        return self._arbiters[topic].request()

    def truth(self, block_order: int) -> Truth:
        """Whether the condition of a block holds."""
        self._propagation.settle()
        return Truth(self._literals[block_order].truth)

    def changed_ns(self, block_order: int) -> int:
        """Since when the condition of a block is as it is."""
        self._propagation.settle()
        return self._changed_ns[block_order]

    def window(self, held: HeldTime, duration_ns: int, now_ns: int) -> tuple[Truth, int | None]:
        """Whether ``held`` is at least so long, and how long it is at ``now_ns``.

        Unknown for what no condition reads.
        """
        self._propagation.settle()
        window = self._graph.windows.get((held, duration_ns))
        if window is None:
            return Truth.UNKNOWN, None
        return Truth(window.truth), window.held_ns(now_ns)

    def latched(self, signal: LastSeen) -> Truth:
        """The memory between the two regions; unknown for one that no condition reads."""
        latch = self._graph.latches.get(signal)
        return Truth.UNKNOWN if latch is None else Truth(latch.truth)

    def reads(self, block_order: int) -> list[Signal]:
        """The signals that the condition of a block reads, sorted."""
        return sorted(signals_of(self._blocks[block_order].form))

    def values_of(self, block_order: int) -> dict[str, Values | None]:
        """The values that the condition of a block reads, by signal name; ``None`` is unknown."""
        return {str(signal): self._thresholds[signal].value for signal in self.reads(block_order)}

    def cuts(self, signal: Signal) -> list[Bound]:
        """The places of the number line, rising, where a value of ``signal`` changes some check."""
        return self._thresholds[signal].cuts

    def texts(self, signal: Signal) -> Collection[str]:
        """The texts that checks compare ``signal`` with."""
        thresholds = self._thresholds[signal]
        return thresholds.texts if isinstance(thresholds, TextThresholds) else ()

    def _block_changed(self, order: int, before: int, after: int) -> None:
        self._changed_blocks.add(order)
        self._changed_ns[order] = self._propagation.now_ns
        if order in self._recording:
            self._turned_recordings.append((order, Truth(after)))
        for topic, ranking, rank in self._entries[order]:
            ranking.move(rank, before, after)
            self._changed_topics.add(topic)


def _literal(graph: Graph, block: RuleBlock) -> Literal:
    literal = graph.literal_of(block.form)
    literal.blocks.append(block.order)
    return literal


def _thresholds(graph: Graph) -> dict[Signal, Thresholds | TextThresholds]:
    leaves: dict[Signal, list[Leaf | Latch]] = {
        signal: [*by_region.values()] for signal, by_region in graph.leaves.items()
    }
    for latch in graph.latches.values():
        leaves.setdefault(latch.source, []).append(latch)
    return {
        signal: TextThresholds(found)
        if signal.kind is SignalKind.TEXT or ANY in signal.property
        else Thresholds(found)
        for signal, found in leaves.items()
    }


def _arbiters(rule_set: RuleSet, yield_turn: Yield) -> dict[str, TopicArbiter]:
    blocks = rule_set.blocks_by_topic(yield_turn)
    return {topic: TopicArbiter(topic, setting, rule_set) for topic, setting in blocks.items()}
