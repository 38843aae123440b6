# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How often which time lies between two messages of a topic."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass

from smarttestudo.domain.units import NS_PER_S

BINS_PER_DECADE = 20
"""Equally wide on a logarithmic axis, each 12 % longer than the last."""


@dataclass(frozen=True, slots=True, kw_only=True)
class IntervalBin:
    """``count`` intervals from ``from_s`` to just below ``to_s`` seconds."""

    from_s: float
    to_s: float
    count: int


class IntervalHistogram:
    """Counts the intervals between messages told one by one, in memory that their number does not change.

    Stamps that do not rise, as of messages recorded at one instant, are left out.
    """

    __slots__ = ("_counts", "_last_ns")

    def __init__(self) -> None:
        self._counts: Counter[int] = Counter()
        self._last_ns: int | None = None

    def record(self, stamp_ns: int) -> None:
        """Take in the next message."""
        if self._last_ns is not None and stamp_ns > self._last_ns:
            self._counts[math.floor(math.log10(stamp_ns - self._last_ns) * BINS_PER_DECADE)] += 1
        self._last_ns = stamp_ns

    def bins(self) -> tuple[IntervalBin, ...]:
        """The bins that have an interval, rising."""
        return tuple(
            IntervalBin(from_s=_edge_s(index), to_s=_edge_s(index + 1), count=count)
            for index, count in sorted(self._counts.items())
        )


def _edge_s(index: int) -> float:
    return float(10 ** (index / BINS_PER_DECADE)) / NS_PER_S
