# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How often a source publishes, and when its silence makes it stale."""

from __future__ import annotations

from collections import deque

from smarttestudo.domain.units import NS_PER_S

INTERVALS_KEPT = 20
INTERVALS_NEEDED = 3
STALE_PERIODS = 5
STALE_AT_LEAST_NS = 2 * NS_PER_S


class SourcePeriod:
    """The mean of a source's last 20 arrival intervals."""

    __slots__ = ("_intervals", "_sum_ns", "last_ns")

    def __init__(self) -> None:
        self.last_ns: int | None = None
        self._intervals: deque[int] = deque()
        self._sum_ns = 0

    def record(self, now_ns: int) -> None:
        """Count an arrival; a clock that jumped back starts the count anew."""
        last_ns = self.last_ns
        self.last_ns = now_ns
        if last_ns is None:
            return
        if now_ns < last_ns:
            self._intervals.clear()
            self._sum_ns = 0
            return
        self._intervals.append(now_ns - last_ns)
        self._sum_ns += now_ns - last_ns
        if len(self._intervals) > INTERVALS_KEPT:
            self._sum_ns -= self._intervals.popleft()

    @property
    def mean_ns(self) -> int | None:
        """The mean interval in ns, ``None`` before the second arrival."""
        return self._sum_ns // len(self._intervals) if self._intervals else None

    def stale_from_ns(self, *, stale_after_ns: int | None, transient_local: bool) -> int | None:
        """The first time at which the last arrival counts as stale; ``None`` while it never will.

        Stale is older than the larger of 2 s and five periods, not before three intervals were seen, nor
        ever on a transient_local topic. ``stale_after_ns`` replaces all of that.
        """
        if self.last_ns is None:
            return None
        if stale_after_ns is not None:
            return self.last_ns + stale_after_ns + 1
        if transient_local or len(self._intervals) < INTERVALS_NEEDED:
            return None
        limit_ns = max(STALE_AT_LEAST_NS, STALE_PERIODS * self._sum_ns // len(self._intervals))
        return self.last_ns + limit_ns + 1
