# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The parts of the evaluator's network: leaves and joins, each read as it is or inverted."""

from __future__ import annotations

from collections.abc import Hashable

from smarttestudo.adirf.region import Region
from smarttestudo.domain.signal import Signal, Truth

FALSE = Truth.FALSE.value
UNKNOWN = Truth.UNKNOWN.value
TRUE = Truth.TRUE.value


class Group:
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

    def __init__(self, node: Node, group: Group, *, inverted: bool) -> None:
        self.node = node
        self.group = group
        self.inverted = inverted
        self.truth = UNKNOWN
        self.joins: dict[Group, dict[Literal, Join]] = {}
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
