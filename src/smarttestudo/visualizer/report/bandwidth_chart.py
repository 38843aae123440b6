# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The bandwidth of all topics over time, and which topics it consists of."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from smarttestudo.visualizer.report.markup import Markup, coordinate, tag
from smarttestudo.visualizer.report.run_report import RunReport
from smarttestudo.visualizer.report.scale import Scale
from smarttestudo.visualizer.report.stack import Layer, layers
from smarttestudo.visualizer.report.wide_chart import (
    BOTTOM,
    LEFT,
    RIGHT,
    WIDTH,
    time_axis,
    time_scale,
    value_axis,
    value_scale,
    wide_svg,
)
from smarttestudo.visualizer.series import Series, SeriesPoint, coarser

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
