# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Conditions as one graph, and changes of values carried through it."""

from __future__ import annotations

from collections.abc import Callable, Collection, Hashable, Iterable, Iterator, Mapping
from functools import reduce
from heapq import heappop, heappush
from typing import TypeVar

from smarttestudo.domain.signal import Signal
from smarttestudo.domain.timing import AlarmClock, Yield
from smarttestudo.domain.units import ns_from_s
from smarttestudo.language.evaluator.literal import (
    FALSE,
    TRUE,
    AnyLeaf,
    Join,
    Latch,
    Leaf,
    Literal,
    LiteralGroup,
    Node,
    TimeWindow,
)
from smarttestudo.language.normal_form import AnyElement, Form, HeldTime, InRegion, LastSeen, Some
from smarttestudo.language.region import Region
from smarttestudo.language.text_region import SetOfValues, intersection_of


class Graph:
    """An and-inverter graph over leaves "this signal lies in this region".

    OR is an inverted AND of inverted parts (A. Kuehlmann et al., "Robust Boolean reasoning", IEEE TCAD
    2002), so that a block and its Else are one node read in two ways.
    """

    def __init__(self) -> None:
        self.nodes: list[Node] = []
        self.leaves: dict[Signal, dict[SetOfValues, Leaf]] = {}
        self.latches: dict[Signal, Latch] = {}
        self.windows: dict[tuple[Signal, int], TimeWindow] = {}
        self._joins: dict[tuple[Literal, Literal], Join] = {}
        self._groups: dict[tuple[Hashable, bool], LiteralGroup] = {}

    @property
    def groups(self) -> Iterable[LiteralGroup]:
        """All groups of literals."""
        return self._groups.values()

    def dismantle(self, yield_turn: Yield) -> None:
        """Cut what holds each other."""
        while self.nodes:
            yield_turn()
            for literal in self.nodes.pop().literals:
                literal.dismantle()

    def literal_of(self, form: Form, *, negated: bool = False) -> Literal:
        """The literal that is as true as ``form``, or as its negation."""
        if isinstance(form, InRegion):
            return self._within(form.signal, form.region.complement() if negated else form.region)
        is_or = isinstance(form, Some)
        conjunction = self._conjunction(form.parts, negated=is_or)
        return self._inverse(conjunction) if is_or != negated else conjunction

    def _conjunction(self, parts: Iterable[Form], *, negated: bool) -> Literal:
        """AND of ``parts`` (or of their negations): one leaf for each signal, then the nested parts.

        A signal is known or not for all its checks at once, so their regions may be intersected. The fixed
        order lets conditions over the same signals share joins.
        """
        regions: dict[Signal, list[SetOfValues]] = {}
        nested: dict[Literal, None] = {}
        for part in parts:
            if isinstance(part, InRegion) and not isinstance(part.signal, HeldTime | LastSeen | AnyElement):
                region = part.region.complement() if negated else part.region
                regions.setdefault(part.signal, []).append(region)
            else:
                nested[self.literal_of(part, negated=negated)] = None
        literals = [self._within(signal, intersection_of(regions[signal])) for signal in sorted(regions)]
        literals += sorted(nested, key=lambda literal: (literal.node.number, literal.inverted))
        return reduce(self._joined, literals)

    def _within(self, signal: Signal, region: SetOfValues) -> Literal:
        """The literal of a region; of a region and its complement only one is a leaf."""
        inverted = region.is_inverse
        base = region.complement() if inverted else region
        if isinstance(signal, HeldTime) and isinstance(base, Region):
            return self._literal(self._window(signal, ns_from_s(base.cuts[0][0])), inverted=inverted)
        if isinstance(signal, LastSeen):
            return self._literal(self._latch(signal), inverted=inverted)
        kind: type[Leaf] = Leaf
        source = signal
        if isinstance(signal, AnyElement):
            kind, source, base = AnyLeaf, signal.source, signal.region
        leaves = self.leaves.setdefault(source, {})
        leaf = leaves.get(base)
        if leaf is None:
            leaf = leaves[base] = kind(len(self.nodes), source, base)
            self.nodes.append(leaf)
        return self._literal(leaf, inverted=inverted)

    def _window(self, held: HeldTime, duration_ns: int) -> TimeWindow:
        window = self.windows.get((held, duration_ns))
        if window is None:
            source = self.literal_of(held.form)
            window = self.windows[held, duration_ns] = TimeWindow(len(self.nodes), source, duration_ns)
            self.nodes.append(window)
        return window

    def _latch(self, signal: LastSeen) -> Latch:
        latch = self.latches.get(signal)
        if latch is None:
            latch = self.latches[signal] = Latch(len(self.nodes), signal)
            self.nodes.append(latch)
        return latch

    def _joined(self, left: Literal, right: Literal) -> Literal:
        join = self._joins.get((left, right))
        if join is None:
            join = self._joins[left, right] = Join(len(self.nodes), left, right)
            self.nodes.append(join)
        return self._literal(join, inverted=False)

    def _inverse(self, literal: Literal) -> Literal:
        return self._literal(literal.node, inverted=not literal.inverted)

    def _literal(self, node: Node, *, inverted: bool) -> Literal:
        for literal in node.literals:
            if literal.inverted == inverted:
                return literal
        group = self._groups.setdefault((node.shape, inverted), LiteralGroup())
        literal = Literal(node, group, inverted=inverted)
        node.literals.append(literal)
        return literal


_Key = TypeVar("_Key")
_Item = TypeVar("_Item")

BlockChanged = Callable[[int, int, int], None]
"""Told of a block's new truth: its order, the truth before, the truth after."""


class Propagation:
    """Carries changed leaves, and what time alone changes, to the blocks whose condition changes."""

    def __init__(self, graph: Graph, block_changed: BlockChanged, start_ns: int) -> None:
        self.touched = 0
        """Nodes, groups and blocks visited so far: what a step's cost is proportional to."""
        self._nodes = graph.nodes
        self._live_groups: set[LiteralGroup] = set(graph.groups)
        self._block_changed = block_changed
        self._queue: list[int] = []
        self._alarms: AlarmClock[int] = AlarmClock()
        self._carried: list[int] = []
        self.now_ns = start_ns

    @property
    def next_alarm_ns(self) -> int | None:
        """When time alone may next change a node; it may come early, never late."""
        return self._alarms.next_ns

    def advance(self, now_ns: int) -> None:
        """Let time pass: what it changes before ``now_ns`` changes at its own time, in order.

        What changes at ``now_ns`` itself waits to be settled with what else happens then.
        """
        self.settle()
        while self._alarms.next_ns is not None and self._alarms.next_ns < now_ns:
            self._ring(self._alarms.next_ns)
            self.settle()
        self._ring(now_ns)
        for number in self._carried:
            self._visit(number)
        self._carried.clear()

    def restore_history(self, window: TimeWindow, before: TimeWindow) -> None:
        """Take over the history of ``before``; what holds now is known after the next ``advance``."""
        window.restore_history(before)
        self._carried.append(window.number)

    def _ring(self, at_ns: int) -> None:
        self.now_ns = max(self.now_ns, at_ns)
        for number in self._alarms.take_due(at_ns):
            self._visit(number)

    def _visit(self, number: int) -> None:
        window = self._nodes[number]
        if isinstance(window, TimeWindow):
            self._enqueue(window)

    def change(self, node: Node, truth: int) -> None:
        """Give ``node`` its new truth and queue the joins that it can reach."""
        self.touched += 1
        if node.truth == truth:
            return
        node.truth = truth
        for literal in node.literals:
            self._turn(literal, TRUE - truth if literal.inverted else truth)

    def settle(self) -> None:
        """Bring all queued joins and windows up to date, each once, in the order of the graph."""
        while self._queue:
            node = self._nodes[heappop(self._queue)]
            if isinstance(node, Join):
                self._update(node)
            elif isinstance(node, TimeWindow):
                self._settle(node)

    def settle_joins(self, yield_turn: Yield) -> None:
        """Bring all queued joins up to date; windows wait for the next ``advance``."""
        while self._queue:
            yield_turn()
            node = self._nodes[heappop(self._queue)]
            if isinstance(node, Join):
                self._update(node)
            elif isinstance(node, TimeWindow):
                node.queued = False
                self._carried.append(node.number)

    def _settle(self, window: TimeWindow) -> None:
        window.queued = False
        truth = window.update(self.now_ns)
        self._alarms.set(window.number, window.next_change_ns(self.now_ns))
        self.change(window, truth)

    def _update(self, join: Join) -> None:
        join.queued = False
        truth = min(join.left.truth, join.right.truth)
        if truth == FALSE:
            join.drop_live()
        elif join.truth == FALSE:
            join.keep_live()
        self.change(join, truth)

    def _turn(self, literal: Literal, truth: int) -> None:
        before, literal.truth = literal.truth, truth
        if before == FALSE:
            self._enter(literal)
        else:
            for join in literal.live_joins:
                self._enqueue(join)
            if truth == FALSE:
                self._leave(literal)
        for window in literal.windows:
            self._enqueue(window)
        self.touched += len(literal.blocks)
        for block in literal.blocks:
            self._block_changed(block, before, truth)

    def _enter(self, literal: Literal) -> None:
        live = literal.group.live
        if not live:
            self._live_groups.add(literal.group)
        live.add(literal)
        for group, joins in self._common(literal.joins, self._live_groups):
            for _, join in self._common(joins, group.live):
                self._enqueue(join)

    def _leave(self, literal: Literal) -> None:
        live = literal.group.live
        live.discard(literal)
        if not live:
            self._live_groups.discard(literal.group)

    def _enqueue(self, node: Join | TimeWindow) -> None:
        self.touched += 1
        if not node.queued:
            node.queued = True
            heappush(self._queue, node.number)

    def _common(self, items: Mapping[_Key, _Item], keys: Collection[_Key]) -> Iterator[tuple[_Key, _Item]]:
        """The items whose key is among ``keys``, in time proportional to the smaller of the two."""
        self.touched += min(len(items), len(keys))
        if len(items) <= len(keys):
            return ((key, item) for key, item in items.items() if key in keys)
        return ((key, items[key]) for key in keys if key in items)
