# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""One topic's rate over time: before, after, and what was planned."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from statistics import median

from smarttestudo.visualizer.report.markup import Markup, coordinate, tag
from smarttestudo.visualizer.report.rule_styles import RuleStyles
from smarttestudo.visualizer.report.run_report import TopicHistory, TopicSeries
from smarttestudo.visualizer.report.scale import Scale, label, linear, long_enough, multiples, round_step
from smarttestudo.visualizer.rule_timeline import RuleSpan
from smarttestudo.visualizer.series import SeriesPoint, coarser
from smarttestudo.visualizer.targets import TargetSpan

_WIDTH, _HEIGHT = 340.0, 168.0
_LEFT, _RIGHT, _TOP, _BOTTOM = 34.0, 20.0, 18.0, 30.0
_FOOT = _HEIGHT - _BOTTOM
_BREAK_AT = 2.5
_LOWER_TOP, _UPPER_FOOT = _TOP + 38.0, _TOP + 22.0
_HEADROOM = 1.15
_LEAST_HZ = 0.001
MAX_POINTS = 300
_BEFORE_POINTS = 40
_TIME_TOLERANCE = 1.005
_THINNEST = 1.0


def rate_chart(
    series: TopicSeries,
    targets: Sequence[TargetSpan],
    spans: Sequence[RuleSpan],
    styles: RuleStyles,
    *,
    duration_s: float,
    max_points: int = MAX_POINTS,
) -> Markup:
    """The chart as an SVG element.

    Where the rate before lies far above the rest, the axis has a gap, so that both can be read. A planned
    rate far above everything that happened runs along the chart's top.
    """
    x = linear((0.0, max(duration_s, 1e-3)), (_LEFT, _WIDTH - _RIGHT))
    y = rate_scale(series, targets)
    return tag(
        "svg",
        *_shading(spans, styles, x),
        *_axes(x, y, series),
        _band(coarser(series.before.rate_hz, min(_BEFORE_POINTS, max_points)), x, y, "before"),
        _target_line(targets, x, y),
        _band(coarser(series.after.rate_hz, max_points), x, y, "after"),
        class_="static rate",
        viewBox=f"0 0 {coordinate(_WIDTH)} {coordinate(_HEIGHT)}",
        role="img",
        aria_label=f"Rate of {series.topic} over time, in Hz",
    )


def rate_scale(series: TopicSeries, targets: Sequence[TargetSpan]) -> Scale:
    """The chart's axis of rates, in two pieces where it has a gap."""
    planned_hz = [span.rate.hz for span in targets if not span.rate.is_full]
    received_hz, before_hz = _highest_hz(series.after), _highest_hz(series.before)
    far_hz = max(before_hz, default=0.0)
    highest_hz = max([*before_hz, *received_hz], default=0.0)
    shown_hz = [min(rate_hz, _BREAK_AT * highest_hz) if highest_hz else rate_hz for rate_hz in planned_hz]
    near_hz = max([*shown_hz, *received_hz], default=0.0)
    if near_hz < _LEAST_HZ or far_hz <= _BREAK_AT * near_hz:
        return linear((0.0, max(near_hz, far_hz, 1.0) * _HEADROOM), (_FOOT, _TOP))
    top_hz = far_hz * 1.05
    usual_hz = min(median(before_hz), far_hz) * 0.95
    near_top_hz = near_hz * _HEADROOM
    return Scale(
        values=(0.0, near_top_hz, max(usual_hz, near_top_hz * 1.01), top_hz),
        places=(_FOOT, _LOWER_TOP, _UPPER_FOOT, _TOP),
    )


def _shading(spans: Sequence[RuleSpan], styles: RuleStyles, x: Scale) -> Iterator[Markup]:
    """A tint behind the chart and a strip under it, in the look of the block that decided the topic."""
    for span in long_enough(spans, _shortest_s(x)):
        css_class = styles.of(span.block).css_class
        left, width = x(span.start_s), x(span.end_s) - x(span.start_s)
        yield tag("rect", class_=f"tint {css_class}", x=left, y=_TOP, width=width, height=_FOOT - _TOP)
        yield tag("rect", class_=f"strip {css_class}", x=left, y=_FOOT + 2, width=width, height=4.0)


def _axes(x: Scale, y: Scale, series: TopicSeries) -> Iterator[Markup]:
    right = _WIDTH - _RIGHT
    for value in rate_ticks(y, series):
        at = y(value)
        yield tag("line", class_="grid", x1=_LEFT, x2=right, y1=at, y2=at)
        yield tag("text", label(value), class_="tick", x=_LEFT - 5, y=at + 3.5, text_anchor="end")
    if len(y.values) > 2:
        middle = (_LOWER_TOP + _UPPER_FOOT) / 2
        for at in (middle - 2, middle + 2):
            yield tag("line", class_="gap", x1=_LEFT - 5, x2=_LEFT + 5, y1=at + 2, y2=at - 2)
    yield tag("text", "Hz", class_="tick", x=_LEFT - 5, y=10.0, text_anchor="end")
    times_s = multiples(round_step(x.values[1] / 5), 0.0, x.values[1] * _TIME_TOLERANCE)
    for value in times_s:
        unit = " s" if value == times_s[-1] else ""
        yield tag("text", label(value) + unit, class_="tick", x=x(value), y=_HEIGHT - 8, text_anchor="middle")


def rate_ticks(y: Scale, series: TopicSeries) -> list[float]:
    """The rates to label on the axis ``y`` of ``series``."""
    ticks = multiples(round_step(y.values[1] / 4), 0.0, y.values[1])
    if len(y.values) > 2:
        rates_hz = _highest_hz(series.before)
        usual_hz = round(median(rates_hz))
        ticks.append(usual_hz if usual_hz > y.values[2] else max(rates_hz))
    return ticks


def _highest_hz(history: TopicHistory) -> list[float]:
    return [point.highest for point in history.rate_hz]


def _band(points: Sequence[SeriesPoint], x: Scale, y: Scale, css_class: str) -> Markup:
    """The area between the least and the greatest rate, which is a line wherever they are one."""
    there = [f"{coordinate(x(point.t_s))},{coordinate(y(point.highest))}" for point in points]
    back = [f"{coordinate(x(point.t_s))},{coordinate(y(point.lowest))}" for point in reversed(points)]
    return tag("polyline", class_=css_class, points=" ".join(there + back))


def _target_line(targets: Iterable[TargetSpan], x: Scale, y: Scale) -> Markup:
    """The planned rate in steps; a gap where it was Full."""
    steps = (
        f"M{coordinate(x(span.start_s))} {coordinate(y(span.rate.hz))}H{coordinate(x(span.end_s))}"
        for span in long_enough(targets, _shortest_s(x))
        if not span.rate.is_full
    )
    return tag("path", class_="target", d="".join(steps))


def _shortest_s(x: Scale) -> float:
    """What is too thin to be seen."""
    return _THINNEST * (x.values[1] - x.values[0]) / (x.places[1] - x.places[0])
