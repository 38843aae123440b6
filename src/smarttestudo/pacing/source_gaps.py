# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The gaps between the messages of a source in the last minute."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from smarttestudo.domain.units import NS_PER_S

BUCKET_NS = 10 * NS_PER_S
BUCKETS = 7
"""The one of now, and six before it that are a minute together."""
LONGEST_NS = 2 * NS_PER_S
"""A longer gap is an outage, and counts as one of that length."""
MOST_LAG = 8
"""A message is late by at most so often what the weighted mean gap is longer than the mean gap."""
REST_SHARE = 8
NS_PER_US = 1000


GapNumbers = tuple[int, int, int, int]
"""The four numbers of a ``Gaps``, in their order."""


@dataclass(slots=True)
class Gaps:
    """So many gaps: their sum, the sum of their squares in µs², and the longest."""

    count: int = 0
    total_ns: int = 0
    squares_us2: int = 0
    longest_ns: int = 0

    def numbers(self) -> GapNumbers:
        return self.count, self.total_ns, self.squares_us2, self.longest_ns


class SourceGaps:
    """Gaps of the last minute, by buckets of ten seconds."""

    __slots__ = ("_before", "_bucket", "_buckets", "_number", "last_ns")

    def __init__(self) -> None:
        self.restore(None, ())

    def restore(self, last_ns: int | None, gaps: Sequence[GapNumbers]) -> None:
        """Go on from what another one knew."""
        self.last_ns = last_ns
        """The last arrival, ``None`` before the first."""
        self._number = (last_ns or 0) // BUCKET_NS
        self._buckets = [Gaps(*numbers) for numbers in gaps] or [Gaps() for _ in range(BUCKETS)]
        self._choose_bucket()

    @property
    def gaps(self) -> Sequence[GapNumbers]:
        """The buckets, each at its number modulo their count."""
        return [bucket.numbers() for bucket in self._buckets]

    def record(self, now_ns: int) -> None:
        """Count an arrival; a clock that jumped back starts the count anew."""
        last_ns = self.last_ns
        if last_ns is None or now_ns < last_ns:
            self.restore(now_ns, ())
            return
        self.last_ns = now_ns
        if now_ns // BUCKET_NS != self._number:
            self._begin_bucket(now_ns // BUCKET_NS)
        self._add(1, now_ns - last_ns)

    @property
    def count(self) -> int:
        """How many gaps there were."""
        return self._before.count + self._bucket.count

    @property
    def longest_ns(self) -> int:
        """The longest gap, 0 before the second arrival."""
        return max(self._before.longest_ns, self._bucket.longest_ns)

    @property
    def mean_ns(self) -> int:
        """The mean gap, 0 before the second arrival."""
        count = self._before.count + self._bucket.count
        return (self._before.total_ns + self._bucket.total_ns) // count if count else 0

    @property
    def weighted_mean_ns(self) -> int:
        """The mean gap where each weighs as much as it is long.

        It is the period of a steady source, and of bursts the time from one to the next.
        """
        total_us = (self._before.total_ns + self._bucket.total_ns) // NS_PER_US
        squares_us2 = self._before.squares_us2 + self._bucket.squares_us2
        return squares_us2 // total_us * NS_PER_US if total_us else 0

    def _add(self, count: int, gap_ns: int) -> int:
        """Count so many gaps of one length, which is given back; this runs for every name in a message."""
        if gap_ns > LONGEST_NS:  # noqa: PLR1730 - a call takes longer
            gap_ns = LONGEST_NS
        gap_us, bucket = gap_ns // NS_PER_US, self._bucket
        bucket.count += count
        bucket.total_ns += count * gap_ns
        bucket.squares_us2 += count * gap_us * gap_us
        if gap_ns > bucket.longest_ns:  # noqa: PLR1730
            bucket.longest_ns = gap_ns
        return gap_ns

    def _begin_bucket(self, number: int) -> None:
        for begun in range(max(self._number, number - BUCKETS) + 1, number + 1):
            self._buckets[begun % BUCKETS] = Gaps()
        self._number = number
        self._choose_bucket()

    def _choose_bucket(self) -> None:
        self._bucket = self._buckets[self._number % BUCKETS]
        others = [bucket for bucket in self._buckets if bucket is not self._bucket]
        self._before = Gaps(
            sum(bucket.count for bucket in others),
            sum(bucket.total_ns for bucket in others),
            sum(bucket.squares_us2 for bucket in others),
            max(bucket.longest_ns for bucket in others),
        )


class BurstGaps(SourceGaps):
    """Gaps of a source that may send in bursts, and by how much each message is late in its burst."""

    __slots__ = ("_skipped", "lag_ns", "step_ns")

    def __init__(self) -> None:
        super().__init__()
        self._skipped = 0
        self.lag_ns = 0
        """How long before ``last_ns`` that message would have come, if they arrived one mean gap apart.

        It is 0 unless they come in bursts. The first message of one comes late by this measure, and the last
        one in time.
        """
        self.step_ns = 0
        """The mean gap as it was at the last long one: amid a burst, that of all is too short."""

    def skip(self, messages: int) -> None:
        """Count messages that nobody looked at, before the next message that is recorded."""
        self._skipped += messages

    def record(self, now_ns: int) -> None:
        """Count an arrival; a clock that jumped back starts the count anew."""
        last_ns, count = self.last_ns, self._skipped + 1
        self._skipped = 0
        if last_ns is None or now_ns < last_ns:
            self.restore(now_ns, ())
            self.lag_ns = self.step_ns = 0
            return
        self.last_ns = now_ns
        is_first = now_ns // BUCKET_NS != self._number
        if is_first:
            self._begin_bucket(now_ns // BUCKET_NS)
        longest_ns = self.longest_ns
        gap_ns = self._add(count, (now_ns - last_ns) // count)
        if is_first or gap_ns >= self.step_ns:
            self.step_ns = self.mean_ns
        lag_ns, step_ns, weighted_ns = self.lag_ns, self.step_ns, self.weighted_mean_ns
        if not _is_of_bursts(weighted_ns, step_ns):
            self.lag_ns = 0
            return
        if gap_ns >= step_ns and lag_ns < 2 * step_ns:
            # So small a rest is the error of the mean gap: else it would grow, and messages be lost by it.
            lag_ns -= lag_ns // REST_SHARE
        most_ns = MOST_LAG * (weighted_ns - step_ns)
        # One gap that is longer than all before it is an outage, not yet the pause between bursts.
        late_ns = min(gap_ns, longest_ns) - step_ns
        self.lag_ns = max(min(lag_ns + count * late_ns, most_ns, LONGEST_NS), 0)

    @property
    def comes_in_bursts(self) -> bool:
        """Whether gaps differ by more than jitter makes them."""
        return _is_of_bursts(self.weighted_mean_ns, self.step_ns)


def _is_of_bursts(weighted_ns: int, step_ns: int) -> bool:
    return 4 * weighted_ns >= 5 * step_ns > 0
