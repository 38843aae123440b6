# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Charts over time: lines, layers, axes and marks, the same in whichever form they are drawn."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from enum import Enum
from itertools import accumulate
from statistics import fmean, median

from smarttestudo.bags.comparison import TargetSpan, target_spans
from smarttestudo.bags.incident_record import IncidentMark
from smarttestudo.domain.decision import Decision
from smarttestudo.report.axes import Scale, multiples, round_step
from smarttestudo.report.rule_timeline import (
    RuleStyles,
    StyleSpan,
    bounded,
    by_topic,
    deciding_spans,
    styled,
    styles_of,
)
from smarttestudo.report.run_report import (
    RunReport,
    Series,
    SeriesPoint,
    TopicHistory,
    TopicSeries,
    charted_series,
)

MOST_LAYERS = 6
"""Topics that have a layer of their own; there is one style more, for all others."""
RATE, BANDWIDTH = "Hz", "KB/s"
_VALUE_TICKS = 5
_HEADROOM = 1.08
_GAP_HEADROOM = 1.15
_BREAK_AT = 2.5
_UPPER_FOOT, _UPPER_TOP = 1.2, 1.46
_LEAST_HZ = 0.001
_MOST_SPANS = 120
_SHORTEST_S = 1e-3


class Run(Enum):
    """The subject of a line: a recording or a budget; the value is its class in the style sheet."""

    BEFORE = "before"
    AFTER = "after"
    BUDGET = "budget"


@dataclass(frozen=True, slots=True, kw_only=True)
class ChartLine:
    """A measurement in one recording, from the least to the greatest value at each time."""

    run: Run
    points: Series

    @property
    def is_band(self) -> bool:
        """Whether a point stands for several values, so that there is an area between two lines."""
        return any(point.lowest != point.highest for point in self.points)


@dataclass(frozen=True, slots=True, kw_only=True)
class Layer:
    """The part of one topic, or of all others together, in the bandwidth, in KB/s."""

    name: str
    points: Series

    @property
    def mean_kb_per_s(self) -> float:
        """The mean over the recording."""
        return fmean(point.mean for point in self.points) if self.points else 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class ChartStretch:
    """A stretch of time that a chart labels: the text under it, and what it tells a pointer."""

    label: str
    meaning: str


@dataclass(frozen=True, slots=True, kw_only=True)
class TimeChart:
    """A chart over the time from 0 to ``duration_s``, or over ``stretches``, each of which is 1 wide then.

    ``name`` is what it is of, ``meaning`` what a reader who cannot see it is told. ``heights`` maps values in
    ``unit`` to heights above the foot, straight but for a gap that it may leave out; ``ticks`` are the values
    to label. ``layers`` stand on each other, the first one at the foot. ``incident`` is marked, if there is
    one.
    """

    name: str
    meaning: str
    unit: str
    duration_s: float
    heights: Scale
    lines: tuple[ChartLine, ...] = ()
    layers: tuple[Layer, ...] = ()
    targets: tuple[TargetSpan, ...] = ()
    tints: tuple[StyleSpan, ...] = ()
    usual: float | None = None
    budget: float | None = None
    incident: IncidentMark | None = None
    stretches: tuple[ChartStretch, ...] = ()

    @property
    def top(self) -> float:
        """The greatest height."""
        return self.heights.places[-1]

    @property
    def gap(self) -> float | None:
        """The height at which the axis leaves values out; ``None`` where it leaves out none."""
        places = self.heights.places
        return (places[1] + places[2]) / 2 if len(places) > 2 else None

    @property
    def ticks(self) -> list[float]:
        """The values to label."""
        near = self.heights.values[1]
        own = multiples(round_step(near / _VALUE_TICKS), 0.0, near)
        return own if self.usual is None else [*own, self.usual]

    @property
    def is_empty(self) -> bool:
        """Whether nothing was measured."""
        return not any(line.points for line in self.lines) and not any(layer.points for layer in self.layers)


def stacked_tops(layers: Sequence[Sequence[SeriesPoint]]) -> list[list[float]]:
    """The height of each layer's top over time, the means of what is below it and its own added up."""
    means = ([point.mean for point in points] for points in layers)
    return list(
        accumulate(means, lambda below, own: [low + mean for low, mean in zip(below, own, strict=True)])
    )


def rate_charts(report: RunReport) -> list[TimeChart]:
    """For each charted topic its rates, with the planned ones, tinted by the rules that decided them.

    Where the rate before lies far above the rest, the axis has a gap, so that both can be read. A planned
    rate far above everything that happened runs along the chart's top.
    """
    decisions = by_topic(report.decisions)
    styles = styles_of(report.decisions, report.duration_s, report.actions)
    charts = []
    for series in charted_series(report):
        own = decisions.get(series.topic, [])
        targets = target_spans(own, report.duration_s)
        heights = rate_heights(series, targets)
        charts.append(
            TimeChart(
                name=series.topic,
                meaning=f"Rate of {series.topic} over time, in Hz",
                unit=RATE,
                duration_s=_shown_s(report),
                heights=heights,
                lines=_lines(report, series, lambda history: history.rate_hz),
                targets=tuple(bounded(targets, _MOST_SPANS)),
                tints=_tints(own, report.duration_s, styles),
                usual=_usual_hz(series, heights) if len(heights.values) > 2 else None,
                incident=report.incident,
            )
        )
    return charts


def _tints(decisions: Sequence[Decision], end_s: float, styles: RuleStyles) -> tuple[StyleSpan, ...]:
    return tuple(bounded(styled(deciding_spans(decisions, end_s), styles), _MOST_SPANS))


def rate_heights(series: TopicSeries, targets: Iterable[TargetSpan]) -> Scale:
    """The axis of rates, in two pieces where it has a gap."""
    planned_hz = [span.rate.hz for span in targets if not span.rate.is_full]
    received_hz, before_hz = _highest(series.after.rate_hz), _highest(series.before.rate_hz)
    far_hz = max(before_hz, default=0.0)
    highest_hz = max([*before_hz, *received_hz], default=0.0)
    shown_hz = [min(rate_hz, _BREAK_AT * highest_hz) if highest_hz else rate_hz for rate_hz in planned_hz]
    near_hz = max([*shown_hz, *received_hz], default=0.0)
    near_top_hz = near_hz * _GAP_HEADROOM
    if near_hz < _LEAST_HZ or far_hz <= _BREAK_AT * near_hz:
        return _from_foot(max(near_hz, far_hz, 1.0) * _GAP_HEADROOM)
    usual_hz = min(median(before_hz), far_hz) * 0.95
    return Scale(
        values=(0.0, near_top_hz, max(usual_hz, near_top_hz * 1.01), far_hz * 1.05),
        places=(0.0, near_top_hz, near_top_hz * _UPPER_FOOT, near_top_hz * _UPPER_TOP),
    )


def bandwidth_charts(report: RunReport) -> list[TimeChart]:
    """For each charted topic its bandwidth."""
    return [
        _bandwidth_chart(
            report, topic_series, f"Bandwidth of {topic_series.topic} over time, in KB/s", budget=None
        )
        for topic_series in charted_series(report)
    ]


def total_chart(report: RunReport) -> TimeChart:
    """The sum over all topics in each recording, with the budget if there is one."""
    meaning = "Bandwidth of all topics over time, in KB/s"
    return _bandwidth_chart(report, report.total, meaning, budget=report.budget_kb_per_s)


def stacked_chart(report: RunReport, run: Run) -> TimeChart:
    """The parts of the largest topics in the bandwidth of a recording, and that of all others together."""
    stack = layers(report, run)
    tops = stacked_tops([layer.points for layer in stack])
    highest = max((value for top in tops[-1:] for value in top), default=0.0)
    return TimeChart(
        name=report.names.before if run is Run.BEFORE else report.names.after,
        meaning="Bandwidth over time, stacked by topic, in KB/s",
        unit=BANDWIDTH,
        duration_s=_shown_s(report),
        heights=value_heights(highest, report.budget_kb_per_s),
        layers=stack,
        budget=report.budget_kb_per_s,
        incident=report.incident,
    )


def layers(report: RunReport, run: Run) -> tuple[Layer, ...]:
    """The largest topics of one recording, and a layer for the rest, in one order for both recordings."""
    ranked = sorted(report.series, key=_size, reverse=True)
    own = [Layer(name=series.topic, points=_history(series, run).kb_per_s) for series in ranked]
    own = [layer for layer in own if layer.points]
    if len(own) <= MOST_LAYERS + 1:
        return tuple(own)
    rest = own[MOST_LAYERS:]
    others = Layer(name=f"{len(rest)} other topics", points=_sum([layer.points for layer in rest]))
    return (*own[:MOST_LAYERS], others)


def _bandwidth_chart(
    report: RunReport, series: TopicSeries, meaning: str, *, budget: float | None
) -> TimeChart:
    points = (*series.before.kb_per_s, *series.after.kb_per_s)
    return TimeChart(
        name=series.topic,
        meaning=meaning,
        unit=BANDWIDTH,
        duration_s=_shown_s(report),
        heights=value_heights(max(_highest(points), default=0.0), budget),
        lines=_lines(report, series, lambda history: history.kb_per_s),
        budget=budget,
        incident=report.incident,
    )


def _shown_s(report: RunReport) -> float:
    return max(report.duration_s, _SHORTEST_S)


def _lines(
    report: RunReport, series: TopicSeries, points_of: Callable[[TopicHistory], Series]
) -> tuple[ChartLine, ...]:
    runs = (Run.BEFORE, Run.AFTER) if report.is_pair or points_of(series.after) else (Run.BEFORE,)
    return tuple(ChartLine(run=run, points=points_of(_history(series, run))) for run in runs)


def _history(series: TopicSeries, run: Run) -> TopicHistory:
    return series.before if run is Run.BEFORE else series.after


def _highest(points: Iterable[SeriesPoint]) -> list[float]:
    return [point.highest for point in points]


def _usual_hz(series: TopicSeries, heights: Scale) -> float:
    """The rate to label above the gap."""
    rates_hz = _highest(series.before.rate_hz)
    usual_hz = round(median(rates_hz))
    return usual_hz if usual_hz > heights.values[2] else max(rates_hz)


def _from_foot(top: float) -> Scale:
    return Scale(values=(0.0, top), places=(0.0, top))


def value_heights(highest: float, budget: float | None) -> Scale:
    """From 0 to a little above ``highest`` and the budget, unless that would flatten all the rest."""
    limit = budget or 0.0
    return _from_foot((max(highest, limit) if limit <= 3 * highest else highest) * _HEADROOM or 1.0)


def _size(series: TopicSeries) -> float:
    """The topic's mean bandwidth in both recordings together."""
    both = (series.before.kb_per_s, series.after.kb_per_s)
    return sum(fmean(point.mean for point in points) for points in both if points)


def _sum(parts: Sequence[Series]) -> Series:
    """The means added up; the least and the greatest of a sum are not known, and stand as its mean."""
    sums = []
    for points in zip(*parts, strict=True):
        mean = sum(point.mean for point in points)
        sums.append(SeriesPoint(t_s=points[0].t_s, lowest=mean, mean=mean, highest=mean))
    return tuple(sums)
