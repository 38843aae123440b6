# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The cost of an accuracy as a drawing and a table."""

from __future__ import annotations

from collections.abc import Iterator

from smarttestudo.accuracy.accuracy_curve import AccuracyCurve
from smarttestudo.domain.units import grouped
from smarttestudo.report.accuracy_chart import AccuracyChart, AccuracyLine, accuracy_chart
from smarttestudo.report.accuracy_curve_table import accuracy_table
from smarttestudo.report.legends import chart_legend
from smarttestudo.report.markup import Markup, html_table, name_parts, tag
from smarttestudo.report.scale import label, tick_label
from smarttestudo.report.sections import section
from smarttestudo.report.time_drawing import number, plot

_TOP, _HEIGHT, _BOTTOM = 22.0, 220.0, 44.0
_MARK_PX = 2.5
_EXPLANATION = (
    "How many messages the robot must send for the operator's picture to be at most so much off: messages "
    "that a bound (KeepWithin) lets pass, beside a fixed rate of as many. Lower and further left is better."
)


def accuracy_curve_section(curve: AccuracyCurve) -> Markup:
    """The worst error against the messages, and all numbers beneath."""
    chart = accuracy_chart(curve)
    table = accuracy_table([curve])
    return section(
        "What an accuracy costs",
        *(_drawing(chart) if chart else ()),
        html_table(table),
        explanation=_EXPLANATION,
    )


def style_of(line: AccuracyLine) -> str:
    """The class of a line in the style sheet."""
    return f"{line.sent.value} reckoned" if line.reckons else line.sent.value


def _drawing(chart: AccuracyChart) -> Iterator[Markup]:
    yield chart_legend([(style_of(line), line.name) for line in chart.lines], [])
    name = tag("span", *name_parts(chart.name), class_="words name")
    yield tag("figure", tag("figcaption", name), draw_accuracy(chart), class_="chart")


def draw_accuracy(chart: AccuracyChart) -> Markup:
    """The chart as an SVG element as wide as its place."""
    lines = [
        tag(
            "polyline",
            class_=style_of(line),
            points=" ".join(_point(chart, messages, error) for messages, error in line.points),
        )
        for line in chart.lines
    ]
    return tag(
        "svg",
        *_error_axis(chart),
        *_message_axis(chart),
        plot(*lines, view=(0.0, 0.0, 1.0, 1.0), y=_TOP, height=_HEIGHT),
        *(mark for line in chart.lines for mark in _marks(chart, line)),
        class_="accuracy",
        height=_TOP + _HEIGHT + _BOTTOM,
        role="img",
        aria_label=chart.meaning,
    )


def _point(chart: AccuracyChart, messages: float, error: float) -> str:
    return f"{number(chart.messages.share(messages))},{number(1 - chart.errors.share(error))}"


def _marks(chart: AccuracyChart, line: AccuracyLine) -> Iterator[Markup]:
    """A dot at each point, which says its numbers to who points at it."""
    for messages, error in line.points:
        said = f"{line.name}: {grouped(messages)} messages, {label(error, 3)} {chart.unit}".rstrip()
        yield tag(
            "circle",
            tag("title", said),
            class_=f"mark {line.sent.value}",
            cx=_percent(chart, messages),
            cy=_height(chart, error),
            r=_MARK_PX,
        )


def _error_axis(chart: AccuracyChart) -> Iterator[Markup]:
    for tick in chart.errors.ticks:
        at = _height(chart, tick)
        yield tag("line", class_="grid", x1=0.0, x2="100%", y1=at, y2=at)
        yield tag("text", label(tick), class_="tick", x=-6.0, y=at + 3.5, text_anchor="end")
    yield tag("text", chart.unit, class_="tick", x=-6.0, y=10.0, text_anchor="end")


def _message_axis(chart: AccuracyChart) -> Iterator[Markup]:
    foot = _TOP + _HEIGHT
    for tick in chart.messages.ticks:
        at = _percent(chart, tick)
        yield tag("line", class_="grid", x1=at, x2=at, y1=_TOP, y2=foot)
        yield tag("text", tick_label(tick), class_="tick", x=at, y=foot + 18, text_anchor="middle")
    yield tag("text", "messages", class_="axis", x="100%", y=foot + 36, text_anchor="end")


def _percent(chart: AccuracyChart, messages: float) -> str:
    return f"{number(round(100 * chart.messages.share(messages), 2))}%"


def _height(chart: AccuracyChart, error: float) -> float:
    return _TOP + (1 - chart.errors.share(error)) * _HEIGHT
