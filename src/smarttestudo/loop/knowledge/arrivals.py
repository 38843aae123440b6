# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The arrivals of a topic: their rate, bandwidth and age over the last seconds."""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence

from smarttestudo.domain.signal import ArrivalProperty
from smarttestudo.domain.units import BYTES_PER_KB, NS_PER_S
from smarttestudo.language.region import Bound

WINDOW_S = 2
WINDOW_NS = WINDOW_S * NS_PER_S


class ArrivalWindow:
    """The arrivals of ``(now - 2 s, now]``, the source of the properties ``rate`` and ``bandwidth``."""

    __slots__ = ("_arrivals", "_bytes_gone", "_bytes_seen")

    def __init__(self) -> None:
        self._arrivals: deque[tuple[int, int]] = deque()
        self._bytes_seen = 0
        self._bytes_gone = 0

    def record(self, now_ns: int, size_bytes: int) -> None:
        """Count a message."""
        self.forget(now_ns)
        self._bytes_seen += size_bytes
        self._arrivals.append((now_ns, self._bytes_seen))

    def forget(self, now_ns: int) -> None:
        """Drop what has left the window by ``now_ns``."""
        while self._arrivals and self._arrivals[0][0] <= now_ns - WINDOW_NS:
            _, self._bytes_gone = self._arrivals.popleft()

    def leaving(self, now_ns: int) -> int:
        """How many will have left the window by ``now_ns``."""
        oldest_first = enumerate(self._arrivals)
        is_in = (count for count, (stamp_ns, _) in oldest_first if stamp_ns > now_ns - WINDOW_NS)
        return next(is_in, len(self._arrivals))

    def rate_hz(self, leaving: int = 0) -> float:
        """Arrivals per second without the oldest ``leaving``."""
        return (len(self._arrivals) - leaving) / WINDOW_S

    def bandwidth_kb_per_s(self, leaving: int = 0) -> float:
        """KB per second without the oldest ``leaving`` arrivals."""
        gone = self._arrivals[leaving - 1][1] if leaving else self._bytes_gone
        return (self._bytes_seen - gone) / BYTES_PER_KB / WINDOW_S

    def falls_ns(self, measure: Callable[[int], float], cuts: Sequence[Bound]) -> int | None:
        """When, with nothing new arriving, ``measure`` crosses the next of ``cuts`` below it, if ever."""
        position = bisect_left(cuts, (measure(0), 0))
        if position == 0:
            return None
        cut = cuts[position - 1]
        counts = range(len(self._arrivals) + 1)
        leaving = bisect_left(counts, 1, key=lambda count: (measure(count), 0) < cut)
        if leaving == len(counts):
            return None
        return self._arrivals[leaving - 1][0] + WINDOW_NS


_LONGEST_NS = 2**62


class Arrivals:
    """Arrival properties that checks read, and when time alone takes one of them across a cut."""

    __slots__ = ("_ages_ns", "_cuts", "_window", "_window_is_read")

    def __init__(self, cuts: Mapping[ArrivalProperty, Sequence[Bound]]) -> None:
        self._cuts = cuts
        self._window = ArrivalWindow()
        self._window_is_read = bool(cuts.keys() - {ArrivalProperty.AGE})
        age_cuts = cuts.get(ArrivalProperty.AGE, ())
        self._ages_ns = sorted({_first_age_ns(cut) for cut in age_cuts if math.isfinite(cut[0])})

    def __bool__(self) -> bool:
        """Whether any of them is read."""
        return bool(self._cuts)

    def restore_history(self, before: Arrivals) -> None:
        """Take over the arrivals that ``before`` counted, if it did."""
        if before._window_is_read:
            self._window = before._window

    def record(self, now_ns: int, size_bytes: int) -> None:
        """Count a message."""
        if self._window_is_read:
            self._window.record(now_ns, size_bytes)

    def values(self, now_ns: int, silent_since_ns: int) -> Iterator[tuple[ArrivalProperty, float]]:
        """The value of each property at ``now_ns``; to ask changes nothing."""
        for kind in self._cuts:
            if kind is ArrivalProperty.AGE:
                yield kind, (now_ns - silent_since_ns) / NS_PER_S
            else:
                yield kind, self._measure(kind)(self._window.leaving(now_ns))

    def changes_ns(self, now_ns: int, silent_since_ns: int) -> Iterator[int]:
        """When time alone next takes each property across a cut; for those that it will."""
        for kind, cuts in self._cuts.items():
            if kind is ArrivalProperty.AGE:
                position = bisect_right(self._ages_ns, now_ns - silent_since_ns)
                if position < len(self._ages_ns):
                    yield silent_since_ns + self._ages_ns[position]
            else:
                self._window.forget(now_ns)
                falls_ns = self._window.falls_ns(self._measure(kind), cuts)
                if falls_ns is not None:
                    yield falls_ns

    def _measure(self, kind: ArrivalProperty) -> Callable[[int], float]:
        is_rate = kind is ArrivalProperty.RATE
        return self._window.rate_hz if is_rate else self._window.bandwidth_kb_per_s


def _first_age_ns(cut: Bound) -> int:
    """The first age beyond ``cut``, found by the very comparison that checks use: floats round."""
    # Not bisect, which counts no further than 2**31 on a 32-bit machine: two seconds.
    shortest_ns, longest_ns = 0, _LONGEST_NS
    while shortest_ns < longest_ns:
        age_ns = (shortest_ns + longest_ns) // 2
        if (age_ns / NS_PER_S, 0) > cut:
            longest_ns = age_ns
        else:
            shortest_ns = age_ns + 1
    return shortest_ns
