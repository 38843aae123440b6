# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the operator lost over time, stretch by stretch."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from smarttestudo.accuracy.reconstruction import held
from smarttestudo.accuracy.samples import Series
from smarttestudo.domain.units import NS_PER_S

BinnedSeries = tuple[float | None, ...]
"""A value for each stretch; ``None`` where nothing was known in it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TimeBins:
    """``count`` bins of time of ``width_ns`` each, from ``first_ns`` on."""

    first_ns: int
    width_ns: int
    count: int

    def parts(self, from_ns: int, to_ns: int) -> Iterator[tuple[int, int]]:
        """The bins that a time is part of, by index, each with when the time or the stretch ends."""
        first, last = ((at_ns - self.first_ns) // self.width_ns for at_ns in (from_ns, to_ns))
        for index in range(max(first, 0), min(last, self.count - 1) + 1):
            yield index, min(self.first_ns + (index + 1) * self.width_ns, to_ns)


def binned_error(sent: Series, received: Series, end_ns: int, bins: TimeBins) -> BinnedSeries:
    """The largest error when the last value received is held, in the field's unit."""
    picture = received.known()
    if not (sent.stamps_ns and picture.stamps_ns):
        return (None,) * bins.count
    return _largest(_errors(sent, picture, end_ns, bins), bins)


def binned_age(stamps_ns: Sequence[int], end_ns: int, bins: TimeBins) -> BinnedSeries:
    """The greatest age in s of the newest message received, until ``end_ns``."""
    received_ns = [stamp_ns for stamp_ns in stamps_ns if stamp_ns <= end_ns]
    ages = (
        (index, (until_ns - since_ns) / NS_PER_S)
        for since_ns, next_ns in itertools.pairwise([*received_ns, end_ns])
        for index, until_ns in bins.parts(since_ns, next_ns)
    )
    return _largest(ages if received_ns else (), bins)


def _errors(sent: Series, picture: Series, end_ns: int, bins: TimeBins) -> Iterator[tuple[int, float]]:
    now_ns = max(sent.stamps_ns[0], picture.stamps_ns[0])
    steps = held(sent, picture, end_ns)
    for lasts_ns, error in zip(steps.lasts_ns.tolist(), steps.errors.tolist(), strict=True):
        if not math.isnan(error):
            # A value ends where the next one begins, which may be in another stretch.
            until_ns = now_ns + max(lasts_ns - 1, 0)
            yield from ((index, error) for index, _ in bins.parts(now_ns, until_ns))
        now_ns += lasts_ns


def _largest(values: Iterable[tuple[int, float]], bins: TimeBins) -> BinnedSeries:
    binned: list[float | None] = [None] * bins.count
    for index, value in values:
        known = binned[index]
        binned[index] = value if known is None else max(known, value)
    return tuple(binned)
