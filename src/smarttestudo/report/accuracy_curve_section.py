# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The cost of an accuracy as a drawing and a table."""

from __future__ import annotations

from collections.abc import Iterator

from smarttestudo.accuracy.accuracy_curve import AccuracyCurve
from smarttestudo.domain.units import grouped
from smarttestudo.report.accuracy_chart import AccuracyChart, AccuracyLine, accuracy_chart
from smarttestudo.report.accuracy_curve_table import accuracy_table
from smarttestudo.report.axes import (
    foot_axis,
    label,
    legend,
    line_entry,
    number,
    percent_place,
    plot,
    tick_label,
    value_axis,
)
from smarttestudo.report.markup import Markup, html_table, name_parts, tag
from smarttestudo.report.sections import section

_TOP, _HEIGHT, _BOTTOM = 22.0, 220.0, 44.0
_FOOT = _TOP + _HEIGHT
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
    yield legend(*(line_entry(style_of(line), line.name) for line in chart.lines))
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
        *value_axis(((label(tick), _height(chart, tick)) for tick in chart.errors.ticks), chart.unit),
        *foot_axis(
            ((tick_label(tick), percent_place(chart.messages(tick))) for tick in chart.messages.ticks),
            top=_TOP,
            foot=_FOOT,
        ),
        tag("text", "messages", class_="axis", x="100%", y=_FOOT + 36, text_anchor="end"),
        plot(*lines, view=(0.0, 0.0, 1.0, 1.0), y=_TOP, height=_HEIGHT),
        *(mark for line in chart.lines for mark in _marks(chart, line)),
        class_="accuracy",
        height=_FOOT + _BOTTOM,
        role="img",
        aria_label=chart.meaning,
    )


def _point(chart: AccuracyChart, messages: float, error: float) -> str:
    return f"{number(chart.messages(messages))},{number(1 - chart.errors(error))}"


def _marks(chart: AccuracyChart, line: AccuracyLine) -> Iterator[Markup]:
    """A dot at each point, which says its numbers to who points at it."""
    for messages, error in line.points:
        said = f"{line.name}: {grouped(messages)} messages, {label(error, 3)} {chart.unit}".rstrip()
        yield tag(
            "circle",
            tag("title", said),
            class_=f"mark {line.sent.value}",
            cx=percent_place(chart.messages(messages)),
            cy=_height(chart, error),
            r=_MARK_PX,
        )


def _height(chart: AccuracyChart, error: float) -> float:
    return _TOP + (1 - chart.errors(error)) * _HEIGHT
