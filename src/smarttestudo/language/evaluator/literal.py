# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Checks as literals, and the thresholds that a new value crosses."""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Collection, Hashable, Iterable, Iterator, Mapping, Sequence
from typing import Any

from smarttestudo.domain.signal import Signal, Truth, Value, Values
from smarttestudo.language.normal_form import LastSeen
from smarttestudo.language.region import Bound, Region
from smarttestudo.language.text_region import SetOfValues, TextRegion

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
    not false now. ``windows`` remember how long it held. All literals start unknown, and so do the nodes.
    """

    __slots__ = ("blocks", "group", "inverted", "joins", "live_joins", "node", "truth", "windows")

    def __init__(self, node: Node, group: LiteralGroup, *, inverted: bool) -> None:
        self.node = node
        self.group = group
        self.inverted = inverted
        self.truth = UNKNOWN
        self.joins: dict[LiteralGroup, dict[Literal, Join]] = {}
        self.live_joins: set[Join] = set()
        self.blocks: list[int] = []
        self.windows: list[TimeWindow] = []
        group.live.add(self)

    def dismantle(self) -> None:
        """Hold nothing that holds this."""
        self.node.literals = []
        self.group.live.discard(self)
        self.joins.clear()
        self.live_joins.clear()
        self.windows.clear()


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

    def __init__(self, number: int, signal: Signal, region: SetOfValues) -> None:
        super().__init__(number, signal)
        self.region = region

    @property
    def regions(self) -> tuple[SetOfValues, ...]:
        """The regions whose ends are where the signal's value changes it."""
        return (self.region,)

    def truth_at(self, value: Any) -> int:
        """The truth for a value, ``None`` for an unknown value."""
        if value is None:
            return UNKNOWN
        return TRUE if self.region.contains(value) else FALSE


class AnyLeaf(Leaf):
    """True while any of a signal's values lies in a region."""

    __slots__ = ()

    def truth_at(self, value: Any) -> int:
        """The truth for the values of all elements, ``None`` for unknown ones."""
        if value is None:
            return UNKNOWN
        return TRUE if any(map(self.region.contains, value)) else FALSE


class Latch(Node):
    """True from when its source was in one region until it was in the other, unknown while the source is."""

    __slots__ = ("_memory", "_signal")

    def __init__(self, number: int, signal: LastSeen) -> None:
        super().__init__(number, signal)
        self._signal = signal
        self._memory = UNKNOWN

    @property
    def source(self) -> Signal:
        """The signal that it reads."""
        return self._signal.source

    @property
    def regions(self) -> tuple[SetOfValues, ...]:
        """The regions whose ends are where the source's value may change it."""
        return self._signal.on, self._signal.off

    def truth_at(self, value: Any) -> int:
        """The truth for the next value, ``None`` for an unknown value; the memory keeps what was seen."""
        if value is None:
            return UNKNOWN
        if self._signal.on.contains(value):
            self._memory = TRUE
        elif self._signal.off.contains(value):
            self._memory = FALSE
        return self._memory

    def restore_history(self, before: Latch) -> None:
        """Take over the memory of ``before``."""
        self._memory = before._memory


class TimeWindow(Node):
    """Kleene AND of what one literal was at every instant of the last ``duration_ns``.

    Two times are all it must remember: until when the literal was last known to be false, and until when it
    was last unknown. What it was for no time at all, at one instant, counts as seen at that instant.
    """

    __slots__ = ("_duration_ns", "_false_until_ns", "_seen", "_unknown_until_ns", "queued", "source")

    def __init__(self, number: int, source: Literal, duration_ns: int) -> None:
        super().__init__(number, ("window", source.group))
        self.source = source
        self.queued = False
        self._duration_ns = duration_ns
        self._seen = UNKNOWN
        self._false_until_ns: int | None = None
        self._unknown_until_ns: int | None = None
        source.windows.append(self)

    def update(self, now_ns: int) -> int:
        """Take the literal's truth from ``now_ns`` on; return the truth of the window then."""
        truth = self.source.truth
        if truth != self._seen:
            if self._seen == FALSE:
                self._false_until_ns = now_ns
            elif self._seen == UNKNOWN:
                self._unknown_until_ns = now_ns
            self._seen = truth
        if truth == FALSE or self._counts(self._false_until_ns, now_ns):
            return FALSE
        if truth == UNKNOWN or self._counts(self._unknown_until_ns, now_ns):
            return UNKNOWN
        return TRUE

    def held_ns(self, now_ns: int) -> int | None:
        """For how long the literal has been known to hold; ``None`` where that is unknown now."""
        if self._seen != TRUE:
            return 0 if self._seen == FALSE else None
        ends_ns = (self._false_until_ns, self._unknown_until_ns)
        return now_ns - max(until_ns for until_ns in ends_ns if until_ns is not None)

    def next_change_ns(self, now_ns: int) -> int | None:
        """When time alone next changes its truth; ``None`` where it does not."""
        if self._seen == FALSE:
            return None
        for until_ns in (self._false_until_ns, self._unknown_until_ns if self._seen == TRUE else None):
            if until_ns is not None and self._counts(until_ns, now_ns):
                return until_ns + self._duration_ns
        return None

    def _counts(self, until_ns: int | None, now_ns: int) -> bool:
        return until_ns is not None and now_ns < until_ns + self._duration_ns

    def restore_history(self, before: TimeWindow) -> None:
        """Take over what ``before`` remembers."""
        self._seen = before._seen
        self._false_until_ns = before._false_until_ns
        self._unknown_until_ns = before._unknown_until_ns


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


class TextThresholds:
    """Which leaves a change of the signal's text can touch: those that compare with the old or the new."""

    __slots__ = ("_leaves", "_leaves_of", "cuts", "value")

    def __init__(self, leaves: Iterable[Leaf | Latch]) -> None:
        self._leaves = tuple(leaves)
        self._leaves_of: dict[str, list[Leaf | Latch]] = {}
        for leaf in self._leaves:
            texts = (text for region in leaf.regions for text in _texts(region))
            for text in dict.fromkeys(texts):
                self._leaves_of.setdefault(text, []).append(leaf)
        self.cuts: list[Bound] = []
        self.value: Values | None = None

    @property
    def texts(self) -> Collection[str]:
        """The texts that are compared with."""
        return self._leaves_of.keys()

    @property
    def has_latch(self) -> bool:
        """Whether any of them remembers values of before."""
        return any(isinstance(leaf, Latch) for leaf in self._leaves)

    def move(self, value: Values | None) -> Collection[Leaf | Latch]:
        """Take the new value (``None``: unknown); the leaves that may have changed."""
        before, self.value = self.value, value
        if before == value:
            return ()
        if not isinstance(before, str) or not isinstance(value, str):
            return self._leaves
        return {*self._leaves_of.get(before, ()), *self._leaves_of.get(value, ())}


def _texts(region: SetOfValues) -> Iterable[str]:
    return region.texts if isinstance(region, TextRegion) else ()


class ElementThresholds:
    """Which leaves a change of the values of all elements can touch.

    Values that every comparison takes alike are of one place, and ``value`` has the first of each: of numbers
    the places are between cuts, of texts each that is compared with, and all others together.
    """

    __slots__ = ("_always", "_given", "_leaves", "_leaves_of", "_places", "cuts", "value")

    has_latch = False

    def __init__(self, leaves: Iterable[Leaf | Latch]) -> None:
        self._leaves = tuple(leaves)
        regions = {leaf: region for leaf in self._leaves for region in leaf.regions}
        ends = {cut for region in regions.values() if isinstance(region, Region) for cut in region.cuts}
        self.cuts = sorted(ends)
        # What is no single comparison has other ends than these.
        self._always = [leaf for leaf, region in regions.items() if region.comparison is None]
        self._leaves_of: dict[Hashable, list[Leaf | Latch]] = {}
        for leaf, region in regions.items():
            for end in region.cuts if isinstance(region, Region) else region.texts:
                self._leaves_of.setdefault(end, []).append(leaf)
        self._given: Values | None = None
        self._places: Mapping[Any, Value] | None = None
        self.value: Values | None = None

    def move(self, value: Values | None) -> Collection[Leaf | Latch]:
        """Take the new values (``None``: unknown); the leaves that may have changed."""
        if value is self._given:
            return ()
        self._given = value
        before, after = self._places, self._first_of_places(value) if isinstance(value, tuple) else None
        self._places = after
        self.value = None if after is None else tuple(after.values())
        if before is None and after is None:
            return ()
        if not before or not after:
            return self._leaves
        if before.keys() == after.keys():
            return ()
        return {*self._always, *(leaf for end in self._ends(before, after) for leaf in self._leaves_of[end])}

    def _first_of_places(self, values: Sequence[Value]) -> Mapping[Any, Value]:
        """The first of ``values`` in each place that has one."""
        firsts: dict[Any, Value] = {}
        most = len(self._leaves_of) + 1
        if self.cuts and values:
            low, high = self._place(min(values)), self._place(max(values))
            most = high - low + 1
        for value in values:
            firsts.setdefault(self._place(value), value)
            if len(firsts) == most:
                break
        return firsts

    def _place(self, value: Any) -> Any:
        if self.cuts:
            return bisect_left(self.cuts, (value, 0))
        return value if value in self._leaves_of else None

    def _ends(self, before: Mapping[Any, Value], after: Mapping[Any, Value]) -> Iterator[Hashable]:
        """The ends of comparisons that hold for some value before or after, and not the other time."""
        changed = before.keys() ^ after.keys()
        if not self.cuts:
            # Where all are of one text, nothing differs from it.
            alone = [place for places in (before, after) if len(places) == 1 for place in places]
            yield from (place for place in {*changed, *alone} if place is not None)
            return
        for place in changed:
            yield from self.cuts[max(place - 1, 0) : place + 1]
        for first, last in ((min(before), min(after)), (max(before), max(after))):
            yield from self.cuts[min(first, last) : max(first, last)]


class Thresholds:
    """Which leaves a change of the signal's value can touch: those with a cut between old and new value."""

    __slots__ = ("_leaves", "_leaves_at", "_position", "cuts", "value")

    def __init__(self, leaves: Iterable[Leaf | Latch]) -> None:
        self._leaves = tuple(leaves)
        leaves_at: dict[Bound, list[Leaf | Latch]] = {}
        for leaf in self._leaves:
            cuts = (cut for region in leaf.regions if isinstance(region, Region) for cut in region.cuts)
            for cut in dict.fromkeys(cuts):
                leaves_at.setdefault(cut, []).append(leaf)
        self.cuts = sorted(leaves_at)
        self._leaves_at = [leaves_at[cut] for cut in self.cuts]
        self._position: int | None = None
        self.value: float | None = None

    @property
    def has_latch(self) -> bool:
        """Whether any of them remembers values of before."""
        return any(isinstance(leaf, Latch) for leaf in self._leaves)

    def move(self, value: Any) -> Collection[Leaf | Latch]:
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

    def _forget(self) -> Collection[Leaf | Latch]:
        self.value = None
        if self._position is None:
            return ()
        self._position = None
        return self._leaves

    def _crossed(self, low: int, high: int) -> Collection[Leaf | Latch]:
        if high - low == 1:
            return self._leaves_at[low]
        return {leaf for leaves in self._leaves_at[low:high] for leaf in leaves}
