# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The times between a topic's messages."""

from __future__ import annotations

import math
from collections.abc import Iterable

from smarttestudo.domain.units import NS_PER_S


class Intervals:
    """How even a topic's messages are, counted one by one in constant memory."""

    __slots__ = ("_last_ns", "_mean_ns", "_squares_ns2", "count", "longest_ns")

    def __init__(self) -> None:
        self.count = 0
        self.longest_ns = 0
        self._last_ns: int | None = None
        self._mean_ns = 0.0
        self._squares_ns2 = 0.0

    def record(self, stamp_ns: int) -> None:
        """Take in the next message; B. P. Welford, Technometrics 1962, on corrected sums of squares."""
        if self._last_ns is not None:
            interval_ns = stamp_ns - self._last_ns
            self.count += 1
            if interval_ns > self.longest_ns:  # noqa: PLR1730 - half the time of max()
                self.longest_ns = interval_ns
            distance = interval_ns - self._mean_ns
            self._mean_ns += distance / self.count
            self._squares_ns2 += distance * (interval_ns - self._mean_ns)
        self._last_ns = stamp_ns

    def record_all(self, stamps_ns: Iterable[int]) -> None:
        """Take in several messages, at a fraction of what ``record`` costs for each."""
        last_ns, count, longest_ns = self._last_ns, self.count, self.longest_ns
        mean_ns, squares_ns2 = self._mean_ns, self._squares_ns2
        for stamp_ns in stamps_ns:
            if last_ns is not None:
                interval_ns = stamp_ns - last_ns
                count += 1
                if interval_ns > longest_ns:  # noqa: PLR1730 - half the time of max()
                    longest_ns = interval_ns
                distance = interval_ns - mean_ns
                mean_ns += distance / count
                squares_ns2 += distance * (interval_ns - mean_ns)
            last_ns = stamp_ns
        self._last_ns, self.count, self.longest_ns = last_ns, count, longest_ns
        self._mean_ns, self._squares_ns2 = mean_ns, squares_ns2

    @property
    def longest_s(self) -> float | None:
        """The longest interval in seconds; ``None`` without one."""
        return self.longest_ns / NS_PER_S if self.count else None

    @property
    def jitter_s(self) -> float | None:
        """The standard deviation of the intervals in seconds; ``None`` below two intervals."""
        return math.sqrt(self._squares_ns2 / self.count) / NS_PER_S if self.count > 1 else None
