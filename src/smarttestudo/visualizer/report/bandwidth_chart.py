# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Bandwidth over time, stacked by topic."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from statistics import fmean

from smarttestudo.visualizer.report.markup import Markup, coordinate, tag
from smarttestudo.visualizer.report.run_report import RunReport, TopicSeries
from smarttestudo.visualizer.report.scale import (
    BOTTOM,
    LEFT,
    RIGHT,
    WIDTH,
    Scale,
    time_axis,
    time_scale,
    value_axis,
    value_scale,
    wide_svg,
)
from smarttestudo.visualizer.series import Series, SeriesPoint, coarser

MOST_LAYERS = 6
"""Topics that have a layer of their own; the style sheet defines one look more, for all others."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Layer:
    """What one topic, or all others together, add to the bandwidth, in KB/s."""

    name: str
    points: Series

    @property
    def mean_kb_per_s(self) -> float:
        """The mean over the recording."""
        return fmean(point.mean for point in self.points) if self.points else 0.0


def layers(report: RunReport, *, of_second: bool) -> tuple[Layer, ...]:
    """The largest topics of one recording, and a layer for the rest, in one order for both recordings."""
    ranked = sorted(report.series, key=_size, reverse=True)
    own = [Layer(name=series.topic, points=_points(series, of_second=of_second)) for series in ranked]
    own = [layer for layer in own if layer.points]
    if len(own) <= MOST_LAYERS + 1:
        return tuple(own)
    rest = own[MOST_LAYERS:]
    others = Layer(name=f"{len(rest)} other topics", points=_sum([layer.points for layer in rest]))
    return (*own[:MOST_LAYERS], others)


def _size(series: TopicSeries) -> float:
    """The topic's mean bandwidth in both recordings together."""
    both = (series.before.kb_per_s, series.after.kb_per_s)
    return sum(fmean(point.mean for point in points) for points in both if points)


def _points(series: TopicSeries, *, of_second: bool) -> Series:
    return series.after.kb_per_s if of_second else series.before.kb_per_s


def _sum(parts: Sequence[Series]) -> Series:
    """The means added up; the least and the greatest of a sum are not known, and stand as its mean."""
    sums = []
    for points in zip(*parts, strict=True):
        mean = sum(point.mean for point in points)
        sums.append(SeriesPoint(t_s=points[0].t_s, lowest=mean, mean=mean, highest=mean))
    return tuple(sums)


HEIGHT = 230.0
MAX_POINTS = 200
KB_PER_S = "KB/s"


def highest_total_kb_per_s(report: RunReport) -> float:
    """What the axis of ``total_chart`` must hold: also the budget, as far as it is near."""
    points = (*report.total.before.kb_per_s, *report.total.after.kb_per_s)
    return _with_budget(max((point.highest for point in points), default=0.0), report)


def highest_stacked_kb_per_s(report: RunReport) -> float:
    """What the axis of ``stacked_chart`` must hold."""
    points = stacked_series(report)
    return _with_budget(max((point.mean for point in points), default=0.0), report)


def stacked_series(report: RunReport) -> Series:
    """The total of the recording whose topics are stacked: the second, where there are two."""
    return report.total.after.kb_per_s if report.is_pair else report.total.before.kb_per_s


def total_chart(report: RunReport) -> Markup:
    """The sum over all topics in each recording, with the budget if there is one."""
    x = time_scale(report.duration_s)
    y = value_scale(highest_total_kb_per_s(report), HEIGHT - BOTTOM)
    return wide_svg(
        *value_axis(y, KB_PER_S),
        *time_axis(x, HEIGHT),
        _band(report.total.before.kb_per_s, x, y, "before"),
        _band(report.total.after.kb_per_s, x, y, "after"),
        *_budget(report, y),
        height=HEIGHT,
        meaning="Bandwidth of all topics over time, in KB/s",
        css_class="bandwidth",
    )


def stacked_chart(report: RunReport) -> Markup:
    """What each of the largest topics adds to the bandwidth, and all others together."""
    x = time_scale(report.duration_s)
    y = value_scale(highest_stacked_kb_per_s(report), HEIGHT - BOTTOM)
    return wide_svg(
        *value_axis(y, KB_PER_S),
        *time_axis(x, HEIGHT),
        *_layers(layers(report, of_second=report.is_pair), x, y),
        *_budget(report, y),
        height=HEIGHT,
        meaning="Bandwidth over time, stacked by topic, in KB/s",
        css_class="stacked",
    )


def _with_budget(highest: float, report: RunReport) -> float:
    """``highest``, or the budget where that is above it, unless it would flatten all the rest."""
    budget = report.budget_kb_per_s or 0.0
    return max(highest, budget) if budget <= 3 * highest else highest


def _layers(stack: Sequence[Layer], x: Scale, y: Scale) -> Iterator[Markup]:
    """From the top of the stack down, each down to the foot and covered by the next."""
    sums = [0.0] * max((len(layer.points) for layer in stack), default=0)
    areas = []
    for index, layer in enumerate(stack, start=1):
        points = coarser(layer.points, MAX_POINTS)
        sums = [low + point.mean for low, point in zip(sums, points, strict=False)]
        areas.append(_area(points, sums, x, y, f"layer share-{index}"))
    yield from reversed(areas)


def _area(points: Sequence[SeriesPoint], sums: Sequence[float], x: Scale, y: Scale, look: str) -> Markup:
    top = [
        f"{coordinate(x(point.t_s))},{coordinate(y(value))}"
        for point, value in zip(points, sums, strict=True)
    ]
    foot = [f"{coordinate(x(point.t_s))},{coordinate(y(0))}" for point in (*points[-1:], *points[:1])]
    return tag("polygon", class_=look, points=" ".join([*top, *foot]))


def _band(series: Series, x: Scale, y: Scale, look: str) -> Markup:
    """The area between the least and the greatest value, which is a line wherever they are one."""
    points = coarser(series, MAX_POINTS)
    there = [f"{coordinate(x(point.t_s))},{coordinate(y(point.highest))}" for point in points]
    back = [f"{coordinate(x(point.t_s))},{coordinate(y(point.lowest))}" for point in reversed(points)]
    return tag("polyline", class_=look, points=" ".join(there + back))


def _budget(report: RunReport, y: Scale) -> Iterator[Markup]:
    budget = report.budget_kb_per_s
    if budget is None:
        return
    at, right = y(budget), WIDTH - RIGHT
    above = " (far above)" if budget > y.values[-1] else ""
    yield tag("line", class_="budget", x1=LEFT, x2=right, y1=at, y2=at)
    yield tag("text", f"budget {budget:,g} KB/s{above}", class_="axis", x=right, y=at - 5, text_anchor="end")
