# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The one evaluator of rule sets."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from collections.abc import Set as AbstractSet

from smarttestudo.domain.decision import PlannedRate
from smarttestudo.domain.signal import Signal, SignalKind, Truth, Values
from smarttestudo.domain.timing import Yield, never_yield, yielding
from smarttestudo.language.evaluator.arbiter import RequestedRate, Steps, arbiters_of
from smarttestudo.language.evaluator.graph import Graph, Propagation
from smarttestudo.language.evaluator.literal import (
    ElementThresholds,
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
        self._arbiters = arbiters_of(rule_set, yield_turn)
        self._entries = [
            [(topic, move) for topic in block.topics for move in self._arbiters[topic].movers_of(block.order)]
            for block in yielding(rule_set.blocks, yield_turn)
        ]
        self._margins: dict[Signal, list[tuple[str, Steps]]] = {}
        for topic, arbiter in self._arbiters.items():
            for steps in arbiter.steps:
                self._margins.setdefault(steps.margin.signal, []).append((topic, steps))
        for signal in self._margins:
            self._thresholds.setdefault(signal, Thresholds([]))
        self._changed_topics = set(self._arbiters)
        self._changed_blocks: set[int] = set()
        self._changed_ns = [start_ns] * len(rule_set.blocks)
        self._acting = {block.order for block in rule_set.blocks if block.recordings or block.acts}
        self.has_acting = bool(self._acting)
        self._turned_acting: list[tuple[int, Truth]] = []
        self._has_started_to_act = True
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
        self._turned_acting = []
        self._has_started_to_act = False

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
        for topic, steps in self._margins.get(signal, ()):
            if steps.set(thresholds.value):
                self._changed_topics.add(topic)

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

    def take_turned_acting(self) -> list[tuple[int, Truth]]:
        """The blocks that record or act, by order, and what they turned to since the last call, in order."""
        self._propagation.settle()
        turned, self._turned_acting = self._turned_acting, []
        if not self._has_started_to_act:
            # Until now all were unknown, whatever was foreseen.
            self._has_started_to_act = True
            known = [(order, self.truth(order)) for order in sorted(self._acting)]
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
        """The signals that the condition of a block and its margins read, sorted."""
        block = self._blocks[block_order]
        return sorted({*signals_of(block.form), *(margin.signal for margin in block.margins.values())})

    def values_of(self, block_order: int) -> dict[str, Values | None]:
        """The values that the condition of a block reads, by signal name; ``None`` is unknown."""
        return {str(signal): self._thresholds[signal].value for signal in self.reads(block_order)}

    def cuts(self, signal: Signal) -> list[Bound]:
        """The places of the number line, rising, where a value of ``signal`` changes some check."""
        cuts = self._thresholds[signal].cuts
        margins = self._margins.get(signal)
        if margins is None:
            return cuts
        return sorted({*cuts, *(cut for _, steps in margins for cut in steps.margin.cuts)})

    def texts(self, signal: Signal) -> Collection[str]:
        """The texts that checks compare ``signal`` with."""
        thresholds = self._thresholds[signal]
        return thresholds.texts if isinstance(thresholds, TextThresholds) else ()

    def _block_changed(self, order: int, before: int, after: int) -> None:
        self._changed_blocks.add(order)
        self._changed_ns[order] = self._propagation.now_ns
        if order in self._acting:
            self._turned_acting.append((order, Truth(after)))
        for topic, move in self._entries[order]:
            move(before, after)
            self._changed_topics.add(topic)


def _literal(graph: Graph, block: RuleBlock) -> Literal:
    literal = graph.literal_of(block.form)
    literal.blocks.append(block.order)
    return literal


AnyThresholds = Thresholds | TextThresholds | ElementThresholds


def _thresholds(graph: Graph) -> dict[Signal, AnyThresholds]:
    leaves: dict[Signal, list[Leaf | Latch]] = {
        signal: [*by_region.values()] for signal, by_region in graph.leaves.items()
    }
    for latch in graph.latches.values():
        leaves.setdefault(latch.source, []).append(latch)
    return {signal: _thresholds_of(signal, found) for signal, found in leaves.items()}


def _thresholds_of(signal: Signal, leaves: Iterable[Leaf | Latch]) -> AnyThresholds:
    if ANY in signal.property:
        return ElementThresholds(leaves)
    return TextThresholds(leaves) if signal.kind is SignalKind.TEXT else Thresholds(leaves)
