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

import math
from collections.abc import Iterable, Iterator

from smarttestudo.pacing.grid import NEVER_NS
from smarttestudo.visualizer.loss.report import ErrorSize, FieldError
from smarttestudo.visualizer.loss.samples import Series, turn

Step = tuple[int, float, float]
"""ns that it lasts, the true value, the operator's."""


def field_error(sent: Series, received: Series, end_ns: int) -> FieldError | None:
    """The errors until ``end_ns``; ``None`` where truth and picture were never known at one time."""
    picture = received.known()
    if not (sent.stamps_ns and picture.stamps_ns):
        return None
    value_range = sent.value_range
    hold = _error_size(held(sent, picture, end_ns), value_range, wraps=sent.wraps)
    interpolated = _error_size(between(sent, picture, end_ns), value_range, wraps=sent.wraps)
    return FieldError(hold=hold, interpolated=interpolated or hold) if hold else None


def held(sent: Series, received: Series, end_ns: int) -> Iterator[Step]:
    """Both step functions beside each other; the last step, at ``end_ns``, has no length."""
    now_ns = max(sent.stamps_ns[0], received.stamps_ns[0])
    if now_ns > end_ns:
        return
    truth, picture = _Steps(sent), _Steps(received)
    while True:
        true_value, shown_value = truth.at(now_ns), picture.at(now_ns)
        next_ns = min(truth.next_ns, picture.next_ns, end_ns)
        yield next_ns - now_ns, true_value, shown_value
        if now_ns == end_ns:
            return
        now_ns = next_ns


def between(sent: Series, received: Series, end_ns: int) -> Iterator[Step]:
    """The samples sent from the first one received on, each with the line's value at its stamp."""
    stamps_ns, values = sent.stamps_ns, sent.values
    line = _Line(received)
    first_ns = received.stamps_ns[0]
    for index, stamp_ns in enumerate(stamps_ns):
        next_ns = stamps_ns[index + 1] if index + 1 < len(stamps_ns) else NEVER_NS
        if stamp_ns > end_ns:
            return
        if first_ns <= stamp_ns < next_ns:
            yield min(next_ns, end_ns) - stamp_ns, values[index], line.at(stamp_ns)


def distance(true_value: float, shown_value: float, *, wraps: bool) -> float:
    """How far the operator's value is from the true one; an angle that wraps, the shorter way round."""
    return abs(turn(true_value, shown_value) if wraps else shown_value - true_value)


class _Steps:
    """The value of a series at rising times; ``next_ns`` is when it changes next."""

    __slots__ = ("_index", "_series", "next_ns")

    def __init__(self, series: Series) -> None:
        self._series = series
        self._index = -1
        self.next_ns = series.stamps_ns[0]

    def at(self, now_ns: int) -> float:
        stamps_ns = self._series.stamps_ns
        while self.next_ns <= now_ns:
            self._index += 1
            following = self._index + 1
            self.next_ns = stamps_ns[following] if following < len(stamps_ns) else NEVER_NS
        return self._series.values[self._index]


class _Line:
    """The line through the samples of a series at rising times, from the first one on."""

    __slots__ = ("_index", "_series")

    def __init__(self, series: Series) -> None:
        self._series = series
        self._index = 0

    def at(self, now_ns: int) -> float:
        stamps_ns, values = self._series.stamps_ns, self._series.values
        index, last = self._index, len(stamps_ns) - 1
        while index < last and stamps_ns[index + 1] <= now_ns:
            index += 1
        self._index = index
        if index == last:
            return values[index]
        share = (now_ns - stamps_ns[index]) / (stamps_ns[index + 1] - stamps_ns[index])
        start, end = values[index], values[index + 1]
        return start + share * (turn(start, end) if self._series.wraps else end - start)


def _error_size(steps: Iterable[Step], value_range: float, *, wraps: bool) -> ErrorSize | None:
    squares = maximum = 0.0
    total_ns = 0
    is_known = False
    for lasts_ns, true_value, shown_value in steps:
        error = distance(true_value, shown_value, wraps=wraps)
        if math.isnan(error):
            continue
        is_known = True
        squares += lasts_ns * error * error
        total_ns += lasts_ns
        maximum = max(maximum, error)
    if not is_known:
        return None
    # An error that lasts no time, at the end of the recording, is as large as it is.
    rmse = math.sqrt(squares / total_ns) if total_ns else maximum
    return ErrorSize(
        rmse=rmse,
        maximum=maximum,
        relative_rmse=rmse / value_range if value_range else None,
        relative_maximum=maximum / value_range if value_range else None,
    )
