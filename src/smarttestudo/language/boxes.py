# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Sets of states as boxes: a region for each signal."""

from __future__ import annotations

import itertools
import math
from collections import Counter
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from heapq import heappop, heappush

from smarttestudo.domain.signal import Signal, Truth
from smarttestudo.language.normal_form import Every, Form, InRegion, Some, negation
from smarttestudo.language.text_region import SetOfValues, TextRegion, common

Box = Mapping[Signal, SetOfValues]
"""All states whose signals lie in the given, never empty, regions; other signals may have any value."""

Domain = Callable[[Signal], SetOfValues]
"""The values that a signal can have."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Border:
    """Where two boxes meet without sharing a state: ``signal`` passes ``value``."""

    signal: Signal
    value: float


def common_box(first: Box, second: Box) -> Box | None:
    """The states in both boxes, ``None`` if there are none."""
    both = dict(first)
    for signal, region in second.items():
        mine = both.get(signal)
        if mine is not None:
            region = common(mine, region)  # noqa: PLW2901
            if region.is_empty:
                return None
        both[signal] = region
    return both


def border_between(first: Box, second: Box) -> Border | None:
    """Where one small step of one signal leads from ``first`` into ``second``.

    ``None`` for boxes that share a state, lie apart, or touch at a corner only.
    """
    shared = (signal for signal in first if signal in second)
    apart = [signal for signal in shared if common(first[signal], second[signal]).is_empty]
    if len(apart) != 1:
        return None
    signal = apart[0]
    ends = _ends(first[signal])
    value = next((value for value in _ends(second[signal]) if value in ends), None)
    return None if value is None else Border(signal=signal, value=value)


def _ends(region: SetOfValues) -> dict[float, None]:
    if isinstance(region, TextRegion):
        return {}  # From one text to another no step is small.
    return dict.fromkeys(value for value, _ in region.cuts)


class TooComplexError(Exception):
    """A question that was given up because its effort was spent."""


class Effort:
    """The effort left, in looks at one region (about a microsecond each).

    Spending goes to ``parent`` as well, so that many questions share a common bound.
    """

    __slots__ = ("_left", "_parent")

    def __init__(self, looks: int, parent: Effort | None = None) -> None:
        self._left = looks
        self._parent = parent

    def spend(self, looks: int) -> None:
        """Count ``looks``; raises ``TooComplexError`` when there were not as many left."""
        self._left -= looks
        if self._left < 0:
            raise TooComplexError
        if self._parent is not None:
            self._parent.spend(looks)


def find_box(forms: Iterable[Form], domain: Domain, effort: Effort) -> Box | None:
    """A box in all of which all ``forms`` hold, ``None`` if they never hold together.

    Raises ``TooComplexError`` when ``effort`` is spent before that is known.
    """
    return next(boxes_where(forms, domain, effort), None)


def boxes_where(forms: Iterable[Form], domain: Domain, effort: Effort) -> Iterator[Box]:
    """Disjoint boxes that together are all states in which all ``forms`` hold, found one by one.

    Raises ``TooComplexError`` when ``effort`` is spent.
    """
    search = _Search(domain, effort)
    cases: list[tuple[dict[Signal, SetOfValues], tuple[Form, ...]]] = [({}, tuple(forms))]
    while cases:
        box, pending = cases.pop()
        clauses = search.narrow(box, pending)
        if clauses is None:
            continue
        if not clauses:
            yield box
            continue
        narrowest = min(clauses, key=lambda clause: len(clause.parts))
        others = tuple(clause for clause in clauses if clause is not narrowest)
        tried, *rest = narrowest.parts
        otherwise = rest[0] if len(rest) == 1 else Some(tuple(rest))
        cases.append((box, (negation(tried), otherwise, *others)))
        cases.append((dict(box), (tried, *others)))


class _Search:
    __slots__ = ("_domain", "_effort")

    def __init__(self, domain: Domain, effort: Effort) -> None:
        self._domain = domain
        self._effort = effort

    def narrow(self, box: dict[Signal, SetOfValues], forms: Iterable[Form]) -> list[Some] | None:
        """Narrow ``box`` by all that ``forms`` force; what is left to choose, ``None`` if they contradict."""
        clauses: list[Some] = []
        forced = list(forms)
        self._effort.spend(len(box) + len(forced))
        while forced:
            while forced:
                form = forced.pop()
                if isinstance(form, Every):
                    forced.extend(form.parts)
                elif isinstance(form, Some):
                    clauses.append(form)
                elif not self._narrow_signal(box, form):
                    return None
            undecided: list[Some] = []
            for clause in clauses:
                possible = self._possible_parts(box, clause)
                if possible is None:
                    continue
                if not possible:
                    return None
                if len(possible) == 1:
                    forced.append(possible[0])
                else:
                    undecided.append(Some(possible))
            clauses = undecided
        return clauses

    def _narrow_signal(self, box: dict[Signal, SetOfValues], within: InRegion) -> bool:
        region = common(self._values(box, within.signal), within.region)
        box[within.signal] = region
        return not region.is_empty

    def _possible_parts(self, box: Box, clause: Some) -> tuple[Form, ...] | None:
        """The parts that can hold in ``box``; ``None`` if one holds in all of it."""
        possible: list[Form] = []
        for part in clause.parts:
            truth = self._truth(box, part)
            if truth is Truth.TRUE:
                return None
            if truth is Truth.UNKNOWN:
                possible.append(part)
        return tuple(possible)

    def _truth(self, box: Box, form: Form) -> Truth:
        """TRUE if ``form`` holds in all of ``box``, FALSE if nowhere in it; UNKNOWN may be either."""
        if isinstance(form, InRegion):
            self._effort.spend(1)
            values = self._values(box, form.signal)
            possible = common(values, form.region)
            if possible.is_empty:
                return Truth.FALSE
            return Truth.TRUE if possible == values else Truth.UNKNOWN
        decisive = Truth.FALSE if isinstance(form, Every) else Truth.TRUE
        settled = True
        for part in form.parts:
            truth = self._truth(box, part)
            if truth is decisive:
                return decisive
            settled = settled and truth is not Truth.UNKNOWN
        if not settled:
            return Truth.UNKNOWN
        return Truth.TRUE if isinstance(form, Every) else Truth.FALSE

    def _values(self, box: Box, signal: Signal) -> SetOfValues:
        region = box.get(signal)
        return self._domain(signal) if region is None else region


Interval = tuple[float, float]
"""From the first number to the second, both included."""

Hull = Mapping[Signal, Interval]
"""The closed intervals around a box; signals that the box does not bound, and texts, are left out."""

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
        if isinstance(region, TextRegion):
            continue
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
