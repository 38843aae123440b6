# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The contents of a report: one run, or two beside each other."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from enum import Enum
from statistics import fmean
from typing import Any

from smarttestudo.accuracy.accuracy_curve import AccuracyCurve
from smarttestudo.accuracy.comparison import AccuracyComparison
from smarttestudo.accuracy.loss_report import LossReport
from smarttestudo.bags.comparison import Comparison
from smarttestudo.bags.incident_record import IncidentMark
from smarttestudo.bags.robot_path import PathPoint
from smarttestudo.bags.statistics import IntervalBin, RecordingSpan, SecondBin, TraceAccumulator
from smarttestudo.domain.action import ActionDecision
from smarttestudo.domain.decision import Decision
from smarttestudo.domain.floor_plan import FloorPlan
from smarttestudo.domain.link import StreamCounts
from smarttestudo.domain.remote_robots import RuleText
from smarttestudo.domain.units import BYTES_PER_KB, NS_PER_S
from smarttestudo.report.comparison_tables import RunNames, bandwidth_table, frequency_table
from smarttestudo.report.rule_timeline import by_topic
from smarttestudo.report.table import Table

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


MAX_CHARTS = 24


def charted_series(report: RunReport) -> list[TopicSeries]:
    """At most ``MAX_CHARTS`` topics: those with decisions, then those that carry most.

    One whose messages all came within one of several seconds, as /tf_static's, has nothing to show over time.
    """
    decided = by_topic(report.decisions)

    def varies(series: TopicSeries) -> bool:
        runs = (series.before.rate_hz, series.after.rate_hz)
        brings = (len(run) == 1 or sum(point.highest > 0 for point in run) > 1 for run in runs)
        return series.topic in decided or any(brings)

    def rank(series: TopicSeries) -> tuple[bool, float]:
        points = (*series.before.kb_per_s, *series.after.kb_per_s)
        return series.topic not in decided, -sum(point.mean for point in points)

    chosen = {series.topic for series in sorted(filter(varies, report.series), key=rank)[:MAX_CHARTS]}
    return [series for series in report.series if series.topic in chosen]


@dataclass(frozen=True, slots=True, kw_only=True)
class TopicHistory:
    """A topic over time in one recording; empty where the recording does not have it."""

    rate_hz: Series = ()
    kb_per_s: Series = ()
    intervals: tuple[IntervalBin, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class TopicSeries:
    """A topic over time in both recordings."""

    topic: str
    before: TopicHistory = field(default_factory=TopicHistory)
    after: TopicHistory = field(default_factory=TopicHistory)


@dataclass(frozen=True, slots=True, kw_only=True)
class TopicOverLink:
    """How one topic did: its ages in ms over time and in order, and its counts since the first status."""

    topic: str
    ages: Series
    sorted_ages_ms: tuple[float, ...]
    counts: StreamCounts


@dataclass(frozen=True, slots=True, kw_only=True)
class LinkHistory:
    """The load of the link and the budget that rates were planned within, in KB/s; times in s.

    ``outages`` is how many the robot counted since the first status; in ``silences`` it was not connected or
    told nothing.
    """

    capacity: Series
    budget: Series
    silences: tuple[tuple[float, float], ...]
    outages: int
    topics: tuple[TopicOverLink, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Fact:
    """One line about where the report comes from: a recording, a version, a seed."""

    label: str
    value: str


@dataclass(frozen=True, slots=True, kw_only=True)
class RunReport:
    """One recording, or two beside each other. Every text may come from a stranger.

    Times are in seconds since the first recording's start, those of ``decisions`` and ``actions`` too.
    ``explanation`` says what is compared; ``total`` is the bandwidth of all topics together,
    ``accuracy_curve`` what bounds of the robot's position cost; ``incident`` is known where the first
    recording is one. Of a pair, ``tables`` may be left empty for the usual two.
    """

    title: str
    duration_s: float
    comparison: Comparison
    series: tuple[TopicSeries, ...]
    decisions: tuple[Decision, ...]
    actions: tuple[ActionDecision, ...] = ()
    explanation: str = ""
    total: TopicSeries = field(default_factory=lambda: TopicSeries(topic="All topics"))
    names: RunNames = field(default_factory=RunNames)
    tables: tuple[Table[Any], ...] = ()
    budget_kb_per_s: float | None = None
    loss: LossReport | None = None
    accuracy: AccuracyComparison | None = None
    accuracy_curve: AccuracyCurve | None = None
    link: LinkHistory | None = None
    rules: tuple[RuleText, ...] = ()
    provenance: tuple[Fact, ...] = ()
    notices: tuple[str, ...] = ()
    incident: IncidentMark | None = None
    floor_plan: FloorPlan | None = None
    path: tuple[PathPoint, ...] = ()

    @property
    def is_pair(self) -> bool:
        """Whether there is a second recording."""
        return any(pair.after is not None for pair in self.comparison.topics)

    @property
    def shown_tables(self) -> tuple[Table[Any], ...]:
        """``tables``, or those of the comparison."""
        usual = (frequency_table, bandwidth_table)
        return self.tables or tuple(table(self.comparison, self.names) for table in usual)


class FigureKind(Enum):
    """The kinds of figures; the value is a file's name."""

    RATES = "rates"
    BANDWIDTH = "bandwidth"
    TOTAL = "total"
    INTERVALS = "intervals"
    ACCURACY = "accuracy"
    PATH = "path"
