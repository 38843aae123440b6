# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Checks as literals, and the thresholds that a new value crosses."""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Collection, Hashable, Iterable

from smarttestudo.adirf.region import Bound, Region
from smarttestudo.domain.signal import Signal, Truth

FALSE = Truth.FALSE.value
UNKNOWN = Truth.UNKNOWN.value
TRUE = Truth.TRUE.value


class LiteralGroup:
    """Literals of one shape (the same signals, joined alike); ``live`` are those that are not false."""

    __slots__ = ("live",)

    def __init__(self) -> None:
        self.live: set[Literal] = set()


class Literal:
    """A node, or its inverse, with the joins that it is one side of and the blocks it is the condition of.

    ``joins`` finds a join by the other side's group and the other side; ``live_joins`` are those that are
    not false now. All literals start unknown, and so do the joins.
    """

    __slots__ = ("blocks", "group", "inverted", "joins", "live_joins", "node", "truth")

    def __init__(self, node: Node, group: LiteralGroup, *, inverted: bool) -> None:
        self.node = node
        self.group = group
        self.inverted = inverted
        self.truth = UNKNOWN
        self.joins: dict[LiteralGroup, dict[Literal, Join]] = {}
        self.live_joins: set[Join] = set()
        self.blocks: list[int] = []
        group.live.add(self)


class Node:
    """A value that literals read; ``number`` rises from what a node reads to the node.

    Nodes of one ``shape`` have their literals in the same groups. ``literals`` are those in use: the node,
    its inverse or both.
    """

    __slots__ = ("literals", "number", "shape", "truth")

    def __init__(self, number: int, shape: Hashable) -> None:
        self.number = number
        self.shape = shape
        self.truth = UNKNOWN
        self.literals: list[Literal] = []


class Leaf(Node):
    """True while one signal lies in a region."""

    __slots__ = ("region",)

    def __init__(self, number: int, signal: Signal, region: Region) -> None:
        super().__init__(number, signal)
        self.region = region


class Join(Node):
    """Kleene AND of two literals."""

    __slots__ = ("left", "queued", "right")

    def __init__(self, number: int, left: Literal, right: Literal) -> None:
        super().__init__(number, (left.group, right.group))
        self.left = left
        self.right = right
        self.queued = False
        left.joins.setdefault(right.group, {})[right] = self
        right.joins.setdefault(left.group, {})[left] = self
        self.keep_live()

    def keep_live(self) -> None:
        """Let both sides find this join, which is not false."""
        self.left.live_joins.add(self)
        self.right.live_joins.add(self)

    def drop_live(self) -> None:
        """Let neither side find this join, which is false."""
        self.left.live_joins.discard(self)
        self.right.live_joins.discard(self)


class Thresholds:
    """Which leaves a change of the signal's value can touch: those with a cut between old and new value."""

    __slots__ = ("_leaves", "_leaves_at", "_position", "cuts", "value")

    def __init__(self, leaves: Iterable[Leaf]) -> None:
        self._leaves = tuple(leaves)
        leaves_at: dict[Bound, list[Leaf]] = {}
        for leaf in self._leaves:
            for cut in leaf.region.cuts:
                leaves_at.setdefault(cut, []).append(leaf)
        self.cuts = sorted(leaves_at)
        self._leaves_at = [leaves_at[cut] for cut in self.cuts]
        self._position: int | None = None
        self.value: float | None = None

    def move(self, value: float | None) -> Collection[Leaf]:
        """Take the new value (``None`` or NaN: unknown); the leaves that may have changed."""
        if value is None or math.isnan(value):
            return self._forget()
        self.value = value
        before, after = self._position, bisect_left(self.cuts, (value, 0))
        self._position = after
        if before is None:
            return self._leaves
        if before == after:
            return ()
        return self._crossed(before, after) if before < after else self._crossed(after, before)

    def truth(self, leaf: Leaf) -> int:
        """What the current value makes of one of the leaves."""
        if self.value is None:
            return UNKNOWN
        return TRUE if leaf.region.contains(self.value) else FALSE

    def _forget(self) -> Collection[Leaf]:
        self.value = None
        if self._position is None:
            return ()
        self._position = None
        return self._leaves

    def _crossed(self, low: int, high: int) -> Collection[Leaf]:
        if high - low == 1:
            return self._leaves_at[low]
        return {leaf for leaves in self._leaves_at[low:high] for leaf in leaves}
