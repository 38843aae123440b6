# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Truth through the graph, touching only what changes.

Joins work as in Rete (C. Forgy, Artificial Intelligence 19, 1982): partial matches are kept, never
recomputed. And an AND with one false side cannot change through the other, so, in the spirit of the watched
literals of SAT solvers (M. Moskewicz et al., "Chaff", DAC 2001), a changing literal looks at few joins:

- from false to not false, at those whose other side is not false: the common members of two sets, what the
  literal is joined with and the live literals of a group, found by walking the smaller one;
- otherwise, at its live joins, which are exactly those that the change can reach.

A robot that crosses the border between two of 100 columns of zones thus touches the zones of its own row,
not the 100 zones of a column.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from heapq import heappop, heappush
from typing import TypeVar

from smarttestudo.adirf.evaluator.graph import Graph
from smarttestudo.adirf.evaluator.literal import FALSE, TRUE, Group, Join, Literal, Node

_Key = TypeVar("_Key")
_Item = TypeVar("_Item")

BlockChanged = Callable[[int, int, int], None]
"""Told of a block's new truth: its order, the truth before, the truth after."""


class Propagation:
    """Carries changed leaves to the blocks whose condition changes."""

    def __init__(self, graph: Graph, block_changed: BlockChanged) -> None:
        self.touched = 0
        """Nodes, groups and blocks looked at so far: what a step's cost is proportional to."""
        self._nodes = graph.nodes
        self._live_groups: set[Group] = set(graph.groups)
        self._block_changed = block_changed
        self._queue: list[int] = []

    def change(self, node: Node, truth: int) -> None:
        """Give ``node`` its new truth and queue the joins that it can reach."""
        self.touched += 1
        if node.truth == truth:
            return
        node.truth = truth
        for literal in node.literals:
            self._turn(literal, TRUE - truth if literal.inverted else truth)

    def settle(self) -> None:
        """Bring all queued joins up to date, each once, in the order of the graph."""
        while self._queue:
            join = self._nodes[heappop(self._queue)]
            if isinstance(join, Join):
                self._update(join)

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

    def _enqueue(self, join: Join) -> None:
        self.touched += 1
        if not join.queued:
            join.queued = True
            heappush(self._queue, join.number)

    def _common(self, items: Mapping[_Key, _Item], keys: Collection[_Key]) -> Iterator[tuple[_Key, _Item]]:
        """The items whose key is among ``keys``, in time proportional to the smaller of the two."""
        self.touched += min(len(items), len(keys))
        if len(items) <= len(keys):
            return ((key, item) for key, item in items.items() if key in keys)
        return ((key, items[key]) for key in keys if key in items)
