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

    __slots__ = ("_arrivals_ns",)

    def __init__(self) -> None:
        self._arrivals_ns: deque[int] = deque(maxlen=INTERVALS_KEPT + 1)

    def record(self, now_ns: int) -> None:
        """Count an arrival; a clock that jumped back starts the count anew."""
        arrivals_ns = self._arrivals_ns
        if arrivals_ns and now_ns < arrivals_ns[-1]:
            arrivals_ns.clear()
        arrivals_ns.append(now_ns)

    @property
    def arrivals_ns(self) -> tuple[int, ...]:
        """The arrivals that count, oldest first."""
        return tuple(self._arrivals_ns)

    @property
    def last_ns(self) -> int | None:
        """The last arrival, ``None`` before the first."""
        return self._arrivals_ns[-1] if self._arrivals_ns else None

    @property
    def mean_ns(self) -> int | None:
        """The mean interval in ns, ``None`` before the second arrival."""
        arrivals_ns = self._arrivals_ns
        intervals = len(arrivals_ns) - 1
        return (arrivals_ns[-1] - arrivals_ns[0]) // intervals if intervals > 0 else None

    @property
    def is_known(self) -> bool:
        """Whether enough intervals were seen to say when silence makes the source stale."""
        return len(self._arrivals_ns) > INTERVALS_NEEDED

    def stale_from_ns(self, *, stale_after_ns: int | None, transient_local: bool) -> int | None:
        """The first time at which the last arrival counts as stale; ``None`` while it never will.

        Stale is older than the larger of 2 s and five periods, not before three intervals were seen, nor
        ever on a transient_local topic. ``stale_after_ns`` replaces all of that.
        """
        arrivals_ns = self._arrivals_ns
        if not arrivals_ns:
            return None
        last_ns, intervals = arrivals_ns[-1], len(arrivals_ns) - 1
        if stale_after_ns is not None:
            return last_ns + stale_after_ns + 1
        if transient_local or not self.is_known:
            return None
        return last_ns + silence_limit_ns(last_ns - arrivals_ns[0], intervals) + 1


def silence_limit_ns(span_ns: int, intervals: int) -> int:
    """How long a source may be silent that had so many ``intervals`` in ``span_ns``: 2 s or five of them."""
    return max(STALE_AT_LEAST_NS, STALE_PERIODS * span_ns // intervals)
