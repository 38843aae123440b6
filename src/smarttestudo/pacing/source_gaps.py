# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The gaps between the messages of a source in the last minute."""

from __future__ import annotations

from collections.abc import Sequence

from smarttestudo.domain.dataclass import dataclass
from smarttestudo.domain.units import NS_PER_S

BUCKET_NS = 10 * NS_PER_S
BUCKETS = 7
"""The one of now, and six before it that are a minute together."""
LONGEST_NS = 2 * NS_PER_S
"""A longer gap is an outage, and counts as one of that length."""
NS_PER_US = 1000


@dataclass(slots=True)
class Gaps:
    """So many gaps: their sum, the sum of their squares in µs², and the longest."""

    count: int = 0
    total_ns: int = 0
    squares_us2: int = 0
    longest_ns: int = 0

    def add(self, count: int, gap_ns: int) -> None:
        """Count so many gaps of one length."""
        gap_us = gap_ns // NS_PER_US
        self.count += count
        self.total_ns += count * gap_ns
        self.squares_us2 += count * gap_us * gap_us
        self.longest_ns = max(self.longest_ns, gap_ns)

    def numbers(self) -> tuple[int, int, int, int]:
        """All four."""
        return self.count, self.total_ns, self.squares_us2, self.longest_ns


class SourceGaps:
    """Gaps of the last minute, by buckets of ten seconds, and how far a burst is ahead of a steady source."""

    __slots__ = ("_buckets", "_skipped", "_sum", "lag_ns", "last_ns", "step_ns")

    def __init__(self) -> None:
        self.last_ns: int | None = None
        """The last arrival, ``None`` before the first."""
        self.lag_ns = 0
        """How long before ``last_ns`` that message would have come, if they came one mean gap apart.

        It is 0 unless they come in bursts. The first message of one comes late by this measure, and the last
        one in time.
        """
        self.step_ns = 0
        """The mean gap as it was at the last long one: amid a burst, that of all is too short."""
        self._skipped = 0
        self.restore(None, 0, 0, [])

    def restore(
        self, last_ns: int | None, lag_ns: int, step_ns: int, gaps: Sequence[tuple[int, int, int, int]]
    ) -> None:
        """Go on from what another one knew."""
        self.last_ns, self.lag_ns, self.step_ns = last_ns, lag_ns, step_ns
        self._buckets = [Gaps(*numbers) for numbers in gaps] or [Gaps() for _ in range(BUCKETS)]
        self._add_up()

    @property
    def gaps(self) -> Sequence[tuple[int, int, int, int]]:
        """The numbers of all buckets, of which each has the place that its time modulo all of them says."""
        return [bucket.numbers() for bucket in self._buckets]

    def skip(self, messages: int) -> None:
        """So many messages came that nobody looked at, before the next one that is recorded."""
        self._skipped += messages

    def record(self, now_ns: int) -> None:
        """Count an arrival; a clock that jumped back starts the count anew."""
        last_ns, count = self.last_ns, self._skipped + 1
        self._skipped = 0
        if last_ns is None or now_ns < last_ns:
            self.restore(now_ns, 0, 0, [])
            return
        self.last_ns = now_ns
        number = now_ns // BUCKET_NS
        is_first = number > last_ns // BUCKET_NS
        if is_first:
            self._forget(last_ns // BUCKET_NS, number)
        gap_ns = min((now_ns - last_ns) // count, LONGEST_NS)
        self._buckets[number % BUCKETS].add(count, gap_ns)
        self._sum.add(count, gap_ns)
        if is_first or gap_ns >= self.step_ns:
            self.step_ns = self.mean_ns
        lag_ns = self.lag_ns + count * (gap_ns - self.step_ns)
        self.lag_ns = max(min(lag_ns, self._most_lag_ns), 0)

    @property
    def count(self) -> int:
        """How many gaps there were."""
        return self._sum.count

    @property
    def longest_ns(self) -> int:
        """The longest gap, 0 before the second arrival."""
        return self._sum.longest_ns

    @property
    def mean_ns(self) -> int:
        """The mean gap, 0 before the second arrival."""
        gaps = self._sum
        return gaps.total_ns // gaps.count if gaps.count else 0

    @property
    def weighted_mean_ns(self) -> int:
        """The mean gap where each weighs as much as it is long.

        It is the period of a steady source, and of bursts the time from one to the next.
        """
        gaps = self._sum
        total_us = gaps.total_ns // NS_PER_US
        return gaps.squares_us2 // total_us * NS_PER_US if total_us else 0

    @property
    def comes_in_bursts(self) -> bool:
        """Whether gaps differ by so much that most of the time passes in the long ones."""
        return 2 * self.weighted_mean_ns >= 3 * self.step_ns > 0

    @property
    def _most_lag_ns(self) -> int:
        """Bounded by how much gaps differ, so that one long gap among thousands does not count."""
        if not self.comes_in_bursts:
            return 0
        return min(2 * (self.weighted_mean_ns - self.step_ns), self._sum.longest_ns - self.step_ns)

    def _forget(self, last: int, number: int) -> None:
        """Begin all buckets after ``last`` up to ``number``."""
        for begun in range(max(last, number - BUCKETS) + 1, number + 1):
            self._buckets[begun % BUCKETS] = Gaps()
        self._add_up()

    def _add_up(self) -> None:
        self._sum = Gaps(
            sum(bucket.count for bucket in self._buckets),
            sum(bucket.total_ns for bucket in self._buckets),
            sum(bucket.squares_us2 for bucket in self._buckets),
            max(bucket.longest_ns for bucket in self._buckets),
        )
