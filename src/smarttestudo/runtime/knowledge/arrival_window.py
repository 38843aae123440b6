# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How much of a topic arrived in the last two seconds."""

from __future__ import annotations

from bisect import bisect_left
from collections import deque
from collections.abc import Callable, Sequence

from smarttestudo.adirf.region import Bound
from smarttestudo.domain.units import BYTES_PER_KB, NS_PER_S

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
