# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How far an operator's picture of a field is from the field.

The truth x(t) is what the robot sent: each sample counts until the next one. The operator has the samples
b(1) … b(n), received at t(1) … t(n), and either holds the last one, h(t) = b(k) for t(k) <= t < t(k+1), or,
looking back, interpolates between two of them, l(t) = b(k) + (t − t(k)) / (t(k+1) − t(k)) · (b(k+1) − b(k)).
Angles take the shorter way round, and so do their differences. Errors are weighted by time:

- hold: e(t) = x(t) − h(t) at every t, which is exact because both are steps;
- interpolated: e(t) = x(s) − l(s) until the next sample, where s is the stamp of the robot's last sample,
  so that who received everything errs by nothing; after the last one received it is held.

RMSE = √(1/T ∫ e(t)² dt), from when both are known to the end; time in which x is not known is left out.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from smarttestudo.accuracy.loss_report import ErrorSize, FieldError
from smarttestudo.accuracy.samples import FULL_TURN, Series
from smarttestudo.domain.units import NS_PER_S

Floats = NDArray[np.float64]
Stamps = NDArray[np.int64]


@dataclass(frozen=True, slots=True, kw_only=True)
class ErrorSteps:
    """Errors in time order, NaN where unknown, and for how long each counts; the last may for no time."""

    lasts_ns: Stamps
    errors: Floats


def field_error(sent: Series, received: Series, end_ns: int) -> FieldError | None:
    """The errors until ``end_ns``; ``None`` where truth and picture were never known at one time."""
    picture = received.known()
    if not (sent.stamps_ns and picture.stamps_ns):
        return None
    value_range = sent.value_range
    hold = _error_size(held(sent, picture, end_ns), value_range)
    interpolated = _error_size(_interpolated(sent, picture, end_ns), value_range)
    return FieldError(hold=hold, interpolated=interpolated or hold) if hold else None


def held(sent: Series, received: Series, end_ns: int) -> ErrorSteps:
    """The errors of holding, from when both are known; the last step, at ``end_ns``, has no length."""
    sent_ns, received_ns = np.asarray(sent.stamps_ns), np.asarray(received.stamps_ns)
    start_ns = max(sent_ns[0], received_ns[0])
    if start_ns > end_ns:
        return ErrorSteps(lasts_ns=np.empty(0, np.int64), errors=np.empty(0))
    changes_ns = np.unique(np.concatenate((sent_ns, received_ns, [start_ns, end_ns])))
    at_ns = changes_ns[(changes_ns >= start_ns) & (changes_ns <= end_ns)]
    true_values = np.asarray(sent.values)[_newest(sent_ns, at_ns)]
    shown_values = np.asarray(received.values)[_newest(received_ns, at_ns)]
    return ErrorSteps(
        lasts_ns=np.diff(at_ns, append=end_ns),
        errors=np.abs(_ways(true_values, shown_values, wraps=sent.wraps)),
    )


def _interpolated(sent: Series, received: Series, end_ns: int) -> ErrorSteps:
    """The errors at the samples sent from the first one received on, by the line's value at their stamps."""
    sent_ns, received_ns = np.asarray(sent.stamps_ns), np.asarray(received.stamps_ns)
    next_ns = np.append(sent_ns[1:], np.iinfo(np.int64).max)
    counts = (received_ns[0] <= sent_ns) & (sent_ns < next_ns) & (sent_ns <= end_ns)
    at_ns = sent_ns[counts]
    values = np.asarray(received.values)
    before = _newest(received_ns, at_ns)
    after = np.minimum(before + 1, len(values) - 1)
    # After the last one received, the line stays where it is.
    length_ns = np.where(after > before, received_ns[after] - received_ns[before], 1)
    share = np.where(after > before, (at_ns - received_ns[before]) / length_ns, 0.0)
    line = values[before] + share * _ways(values[before], values[after], wraps=received.wraps)
    return ErrorSteps(
        lasts_ns=np.minimum(next_ns[counts], end_ns) - at_ns,
        errors=np.abs(_ways(np.asarray(sent.values)[counts], line, wraps=sent.wraps)),
    )


def _newest(stamps_ns: Stamps, at_ns: Stamps) -> NDArray[np.intp]:
    """The index of the newest of ``stamps_ns`` at each time; of several with one stamp, the last."""
    return np.searchsorted(stamps_ns, at_ns, side="right") - 1


def _ways(before: Floats, after: Floats, *, wraps: bool) -> Floats:
    """From one value to another; of angles that wrap, the shorter way round, as ``samples.turn``."""
    ways = after - before
    if not wraps:
        return ways
    return np.fromiter(map(math.remainder, ways.tolist(), itertools.repeat(FULL_TURN)), float, len(ways))


def _error_size(steps: ErrorSteps, value_range: float) -> ErrorSize | None:
    is_known = ~np.isnan(steps.errors)
    errors, lasts_ns = steps.errors[is_known], steps.lasts_ns[is_known]
    if not len(errors):
        return None
    total_ns, maximum = int(lasts_ns.sum()), float(errors.max())
    # An error that lasts no time, at the end of the recording, is as large as it is.
    rmse = math.sqrt(_sum(lasts_ns * errors * errors) / total_ns) if total_ns else maximum
    return ErrorSize(
        rmse=rmse,
        maximum=maximum,
        relative_rmse=rmse / value_range if value_range else None,
        relative_maximum=maximum / value_range if value_range else None,
    )


def _sum(numbers: Floats) -> float:
    """In order, so that the last digit does not depend on how numpy splits an array."""
    return float(np.add.accumulate(numbers)[-1])


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
