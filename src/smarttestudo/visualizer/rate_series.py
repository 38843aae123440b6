# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A topic's rate over time, in as few points as a chart can show."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from smarttestudo.domain.units import NS_PER_S
from smarttestudo.visualizer.statistics import RecordingSpan
from smarttestudo.visualizer.trace import TraceAccumulator

MAX_POINTS = 300


@dataclass(frozen=True, slots=True, kw_only=True)
class RatePoint:
    """The least and the greatest rate among the seconds of one stretch of time around ``t_s``."""

    t_s: float
    lowest_hz: int
    highest_hz: int


def rate_series(
    trace: TraceAccumulator, span: RecordingSpan, *, max_points: int = MAX_POINTS
) -> tuple[RatePoint, ...]:
    """The rate of ``trace`` in each whole epoch-aligned second of ``span``, time counted from its start.

    Seconds without a message count as 0 Hz. The two seconds that the recording only partly covers are left
    out: they would look like drops. A long recording gives stretches of several seconds, at most
    ``max_points`` of them.
    """
    first = -(-span.start_ns // NS_PER_S)
    seconds = span.end_ns // NS_PER_S - first
    if seconds <= 0:
        return ()
    width = -(-seconds // max_points)
    starts = range(0, seconds, width)
    seen, lowest, highest = ([0] * len(starts) for _ in range(3))
    for bin_ in trace.bins():
        if not first <= bin_.second < first + seconds:
            continue
        index = (bin_.second - first) // width
        lowest[index] = min(lowest[index], bin_.messages) if seen[index] else bin_.messages
        highest[index] = max(highest[index], bin_.messages)
        seen[index] += 1
    offset_s = (first * NS_PER_S - span.start_ns) / NS_PER_S
    return tuple(
        RatePoint(
            t_s=offset_s + start + min(width, seconds - start) / 2,
            lowest_hz=lowest[index] if seen[index] == min(width, seconds - start) else 0,
            highest_hz=highest[index],
        )
        for index, start in enumerate(starts)
    )


def coarser(points: Sequence[RatePoint], max_points: int) -> tuple[RatePoint, ...]:
    """``points`` with neighbours joined until there are at most ``max_points``."""
    width = -(-len(points) // max_points) or 1
    joined = (points[start : start + width] for start in range(0, len(points), width))
    return tuple(
        RatePoint(
            t_s=(group[0].t_s + group[-1].t_s) / 2,
            lowest_hz=min(point.lowest_hz for point in group),
            highest_hz=max(point.highest_hz for point in group),
        )
        for group in joined
    )
