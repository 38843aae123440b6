# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rates and bandwidth over time, in as few points as a chart can show, spikes included."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from statistics import fmean

from smarttestudo.bags.statistics import RecordingSpan
from smarttestudo.bags.trace import SecondBin, TraceAccumulator
from smarttestudo.domain.units import BYTES_PER_KB, NS_PER_S

MAX_POINTS = 2000


@dataclass(frozen=True, slots=True, kw_only=True)
class SeriesPoint:
    """The least, mean and greatest value among the seconds of one stretch of time around ``t_s``.

    The unit is that of the series: Hz or KB/s.
    """

    t_s: float
    lowest: float
    mean: float
    highest: float


Series = tuple[SeriesPoint, ...]


def rate_series(trace: TraceAccumulator, span: RecordingSpan, *, max_points: int = MAX_POINTS) -> Series:
    """The rate of ``trace`` in Hz, in each whole epoch-aligned second of ``span``, counted from its start.

    Seconds without a message count as 0. The two seconds that the recording only partly covers are left out:
    they would look like drops. A long recording gives stretches of several seconds, at most ``max_points``.
    """
    return _series([trace], span, max_points, lambda bin_: bin_.messages)


def bandwidth_series(
    traces: Iterable[TraceAccumulator], span: RecordingSpan, *, max_points: int = MAX_POINTS
) -> Series:
    """The bandwidth of all ``traces`` together in KB/s, at the times that ``rate_series`` has."""
    return _series(traces, span, max_points, lambda bin_: bin_.size_bytes / BYTES_PER_KB)


def coarser(points: Sequence[SeriesPoint], max_points: int) -> Series:
    """``points`` with neighbours joined until there are at most ``max_points``."""
    width = -(-len(points) // max_points) or 1
    joined = (points[start : start + width] for start in range(0, len(points), width))
    return tuple(
        SeriesPoint(
            t_s=(group[0].t_s + group[-1].t_s) / 2,
            lowest=min(point.lowest for point in group),
            mean=fmean(point.mean for point in group),
            highest=max(point.highest for point in group),
        )
        for group in joined
    )


def _series(
    traces: Iterable[TraceAccumulator],
    span: RecordingSpan,
    max_points: int,
    value_of: Callable[[SecondBin], float],
) -> Series:
    first = -(-span.start_ns // NS_PER_S)
    seconds = max(span.end_ns // NS_PER_S - first, 0)
    # A jump of the clock makes decades of seconds without a message; only the others are kept.
    values: dict[int, float] = defaultdict(float)
    for trace in traces:
        for bin_ in trace.bins():
            if 0 <= bin_.second - first < seconds:
                values[bin_.second - first] += value_of(bin_)
    width = -(-seconds // max_points) or 1
    stretches: list[list[float]] = [[] for _ in range(0, seconds, width)]
    for second, value in values.items():
        stretches[second // width].append(value)
    offset_s = (first * NS_PER_S - span.start_ns) / NS_PER_S
    return tuple(
        _point(found, offset_s + index * width, min(width, seconds - index * width))
        for index, found in enumerate(stretches)
    )


def _point(values: Sequence[float], start_s: float, seconds: int) -> SeriesPoint:
    """The stretch of ``seconds`` from ``start_s`` on, with the values of those that are not 0."""
    return SeriesPoint(
        t_s=start_s + seconds / 2,
        lowest=min(values) if len(values) == seconds else 0,
        mean=sum(values) / seconds,
        highest=max(values, default=0),
    )
