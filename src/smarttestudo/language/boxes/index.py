# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Which of many boxes are near a given one, without looking at them all."""

from __future__ import annotations

import itertools
import math
from collections import Counter
from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from heapq import heappop, heappush

from smarttestudo.domain.signal import Signal
from smarttestudo.language.boxes.box import Box, Effort

Interval = tuple[float, float]
"""From the first number to the second, both included."""

Hull = Mapping[Signal, Interval]
"""The closed intervals around a box; signals that the box does not bound are left out."""

_UNBOUNDED: Interval = (-math.inf, math.inf)
_LEAF_SIZE = 8
_SIGNALS_TRIED = 4


@dataclass(frozen=True, slots=True, kw_only=True)
class IndexEntry:
    """A box of the index, with what it belongs to; ``kind`` is what queries can leave out."""

    owner: int
    kind: Hashable
    box: Box
    hull: Hull


def hull_of(box: Box) -> Hull:
    """The closed intervals around ``box``."""
    hull: dict[Signal, Interval] = {}
    for signal, region in box.items():
        ends = region.pieces[0][0][0], region.pieces[-1][1][0]
        if ends != _UNBOUNDED:
            hull[signal] = ends
    return hull


def meets(hull: Hull, interval_of: Callable[[Signal], Interval | None]) -> bool:
    """Whether ``hull`` and ``interval_of`` (``None``: any value) share a place, if only on their borders."""
    for signal, (low, high) in hull.items():
        interval = interval_of(signal)
        if interval is not None and (interval[1] < low or high < interval[0]):
            return False
    return True


class BoxIndex:
    """A bounding volume hierarchy over hulls.

    Each node halves its entries along the signal that tells them apart best, so that a query visits about
    log n nodes beside those of its answer. Entries that a signal does not bound do not disturb the others.
    """

    def __init__(self, entries: Sequence[IndexEntry]) -> None:
        self._kinds: dict[Hashable, int] = {}
        leaves: list[_Leaf] = []
        for entry in entries:
            kind = self._kinds.setdefault(entry.kind, len(self._kinds))
            leaves.append(_leaf(entry, kind, first=len(leaves)))
        self._root = _node(leaves) if leaves else None

    def near(
        self, interval_of: Callable[[Signal], Interval | None], effort: Effort, *, other_than: Hashable = None
    ) -> Iterator[IndexEntry]:
        """The entries whose hulls meet ``interval_of`` (``None``: any value), in their order.

        Entries of the kind ``other_than`` are left out.
        """
        left_out = self._kinds.get(other_than)
        nodes = [] if self._root is None else [(0, self._root)]
        while nodes:
            node = heappop(nodes)[1]
            if node.looks:
                effort.spend(node.looks)
            if node.kind == left_out:
                continue
            if not meets(node.hull, interval_of):
                continue
            if node.entry is None:
                for part in node.parts:
                    heappush(nodes, (part.first, part))
                continue
            yield node.entry


_SEVERAL_KINDS = -1


@dataclass(frozen=True, slots=True, kw_only=True)
class _Node:
    """An ``entry``, or what is around ``parts``.

    ``kind`` is the number of the kind of all entries below, ``first`` that of the first entry, ``looks`` what
    a visit costs with its entries.
    """

    hull: Hull
    kind: int
    first: int
    looks: int = 0
    parts: tuple[_Node, ...] = ()
    entry: IndexEntry | None = None


_Extents = Mapping[Signal, tuple[float, float]]
"""The centre and the width of a hull along each of its signals."""

_Leaf = tuple["_Node", _Extents]
"""The node of an entry with its extents."""

_BEHIND_ALL = (math.inf, 0.0)


def _leaf(entry: IndexEntry, kind: int, *, first: int) -> _Leaf:
    extents = {signal: (_centre(ends), ends[1] - ends[0]) for signal, ends in entry.hull.items()}
    return _Node(hull=entry.hull, kind=kind, first=first, entry=entry), extents


def _node(leaves: list[_Leaf]) -> _Node:
    if len(leaves) <= _LEAF_SIZE:
        return _parent([node for node, _ in leaves], looks=1 + len(leaves))
    signal = _most_selective_signal([extents for _, extents in leaves])
    if signal is not None:
        leaves = sorted(leaves, key=lambda leaf: leaf[1].get(signal, _BEHIND_ALL)[0])
    middle = len(leaves) // 2
    return _parent([_node(leaves[:middle]), _node(leaves[middle:])], looks=1)


def _parent(nodes: Sequence[_Node], *, looks: int) -> _Node:
    kind = nodes[0].kind if all(node.kind == nodes[0].kind for node in nodes) else _SEVERAL_KINDS
    return _Node(
        hull=_around([node.hull for node in nodes]),
        kind=kind,
        first=min(node.first for node in nodes),
        looks=looks,
        parts=tuple(nodes),
    )


def _around(hulls: Sequence[Hull]) -> Hull:
    around: dict[Signal, Interval] = {}
    for signal in hulls[0]:
        intervals = [hull[signal] for hull in hulls if signal in hull]
        if len(intervals) == len(hulls):
            lows, highs = zip(*intervals, strict=True)
            around[signal] = min(lows), max(highs)
    return around


def _most_selective_signal(hulls: Sequence[_Extents]) -> Signal | None:
    """The signal along which the hulls are spread widest for their width."""
    counts = Counter(itertools.chain.from_iterable(hulls))
    tried = [signal for signal, _ in counts.most_common(_SIGNALS_TRIED)]
    return max(tried, key=lambda signal: _spread(signal, hulls), default=None)


def _spread(signal: Signal, hulls: Sequence[_Extents]) -> float:
    extents = [hull[signal] for hull in hulls if signal in hull]
    centres, widths = zip(*extents, strict=True)
    width = sorted(widths)[(len(widths) - 1) // 2]
    spread = (max(centres) - min(centres)) / width if width > 0 else math.inf
    return spread * len(extents)


def _centre(interval: Interval) -> float:
    low, high = interval
    if math.isinf(low):
        return high
    return low if math.isinf(high) else low / 2 + high / 2
