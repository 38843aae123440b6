# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Which of many boxes are near a given one, without looking at them all."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from statistics import median_low

from smarttestudo.adirf.boxes.box import Box
from smarttestudo.adirf.boxes.effort import Effort
from smarttestudo.domain.signal import Signal

Interval = tuple[float, float]
"""From the first number to the second, both included."""

Hull = Mapping[Signal, Interval]
"""The closed intervals around a box; signals that the box does not bound are left out."""

_LEAF_SIZE = 8
_SIGNALS_TRIED = 4


@dataclass(frozen=True, slots=True, kw_only=True)
class Entry:
    """A box of the index, with what it belongs to; ``kind`` is what queries can leave out."""

    owner: int
    kind: Hashable
    box: Box
    hull: Hull


def hull_of(box: Box) -> Hull:
    """The closed intervals around ``box``."""
    hull = {signal: (region.pieces[0][0][0], region.pieces[-1][1][0]) for signal, region in box.items()}
    return {signal: ends for signal, ends in hull.items() if ends != (-math.inf, math.inf)}


class BoxIndex:
    """A bounding volume hierarchy over hulls.

    Each node halves its entries along the signal that tells them apart best, so that a query visits about
    log n nodes beside those of its answer. Entries that a signal does not bound do not disturb the others.
    """

    def __init__(self, entries: Sequence[Entry]) -> None:
        self._root = _node(list(entries)) if entries else None

    def near(
        self, interval_of: Callable[[Signal], Interval | None], effort: Effort, *, other_than: Hashable = None
    ) -> Iterator[Entry]:
        """The entries whose hulls meet ``interval_of`` (``None``: any value), in a fixed order.

        Entries of the kind ``other_than`` are left out.
        """
        nodes = [] if self._root is None else [self._root]
        while nodes:
            node = nodes.pop()
            effort.spend(1 + len(node.entries))
            if node.kinds == {other_than} or not _meet(node.hull, interval_of):
                continue
            nodes.extend(reversed(node.children))
            for entry in node.entries:
                if entry.kind != other_than and _meet(entry.hull, interval_of):
                    yield entry


@dataclass(frozen=True, slots=True, kw_only=True)
class _Node:
    """``kinds`` holds the kind of all entries below, or is empty where they have several."""

    hull: Hull
    kinds: frozenset[Hashable]
    children: tuple[_Node, ...] = ()
    entries: tuple[Entry, ...] = ()


def _node(entries: list[Entry]) -> _Node:
    if len(entries) <= _LEAF_SIZE:
        return _Node(
            hull=_around([entry.hull for entry in entries]),
            kinds=_one_kind({entry.kind for entry in entries}),
            entries=tuple(entries),
        )
    signal = _most_selective_signal(entries)
    if signal is not None:
        entries = sorted(
            entries, key=lambda entry: _centre(entry.hull[signal]) if signal in entry.hull else math.inf
        )
    middle = len(entries) // 2
    children = (_node(entries[:middle]), _node(entries[middle:]))
    kinds = {kind for child in children for kind in child.kinds} if all(c.kinds for c in children) else set()
    return _Node(hull=_around([child.hull for child in children]), kinds=_one_kind(kinds), children=children)


def _one_kind(kinds: set[Hashable]) -> frozenset[Hashable]:
    return frozenset(kinds) if len(kinds) == 1 else frozenset()


def _around(hulls: Sequence[Hull]) -> Hull:
    signals = [signal for signal in hulls[0] if all(signal in hull for hull in hulls)]
    return {
        signal: (min(hull[signal][0] for hull in hulls), max(hull[signal][1] for hull in hulls))
        for signal in signals
    }


def _most_selective_signal(entries: Sequence[Entry]) -> Signal | None:
    """The signal along which the entries are spread widest for their width."""
    counts = Counter(signal for entry in entries for signal in entry.hull)
    tried = [signal for signal, _ in counts.most_common(_SIGNALS_TRIED)]
    return max(tried, key=lambda signal: _spread(signal, entries), default=None)


def _spread(signal: Signal, entries: Sequence[Entry]) -> float:
    intervals = [entry.hull[signal] for entry in entries if signal in entry.hull]
    centres = [_centre(interval) for interval in intervals]
    width = median_low(high - low for low, high in intervals)
    spread = (max(centres) - min(centres)) / width if width > 0 else math.inf
    return spread * len(intervals)


def _centre(interval: Interval) -> float:
    low, high = interval
    if math.isinf(low):
        return high
    return low if math.isinf(high) else low / 2 + high / 2


def _meet(hull: Hull, interval_of: Callable[[Signal], Interval | None]) -> bool:
    for signal, (low, high) in hull.items():
        interval = interval_of(signal)
        if interval is not None and (interval[1] < low or high < interval[0]):
            return False
    return True
