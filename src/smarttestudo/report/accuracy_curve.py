# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The cost of an accuracy: a chart, the same in whichever form it is drawn, and its section."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from enum import Enum

from smarttestudo.accuracy.accuracy_curve import AccuracyCurve
from smarttestudo.accuracy.arms import PacedPicture
from smarttestudo.domain.units import grouped
from smarttestudo.report.accuracy_tables import accuracy_table
from smarttestudo.report.axes import (
    LogScale,
    foot_axis,
    label,
    legend,
    line_entry,
    log_scale,
    number,
    percent_place,
    plot,
    tick_label,
    value_axis,
)
from smarttestudo.report.markup import Markup, tag
from smarttestudo.report.page import figure, folded_tables, topic_name

_LEAST = 1e-300
"""An error that is smaller counts as none: there is no room for a margin among the numbers."""


class Sent(Enum):
    """How messages were chosen; the value is its line's class in the style sheet."""

    FIXED = "before"
    WITHIN = "after"


@dataclass(frozen=True, slots=True, kw_only=True)
class AccuracyLine:
    """Messages and worst error of one way to send, the fewest messages first.

    ``reckons``: for a receiver that shows dead reckoning.
    """

    sent: Sent
    reckons: bool
    points: tuple[tuple[int, float], ...]

    @property
    def name(self) -> str:
        """Its name in a legend."""
        way = "Bound" if self.sent is Sent.WITHIN else "Fixed rate"
        return f"{way}, {'dead reckoning' if self.reckons else 'last message held'}"


@dataclass(frozen=True, slots=True, kw_only=True)
class AccuracyChart:
    """Messages to the right, the worst error upwards, in ``unit``."""

    name: str
    unit: str
    messages: LogScale
    errors: LogScale
    lines: tuple[AccuracyLine, ...]

    @property
    def meaning(self) -> str:
        """The text for a reader who cannot see it."""
        return f"Worst error of {self.name} against messages, in {self.unit or 'its unit'}"


def accuracy_chart(curve: AccuracyCurve) -> AccuracyChart | None:
    """The chart of one property; ``None`` where no error is left to show.

    Where every message passes there is none, which has no place on a logarithmic axis.
    """
    held = [point.hold for point in curve.points]
    reckoned = [point.reckoned for point in curve.points if point.reckoned is not None]
    lines = [
        AccuracyLine(sent=sent, reckons=reckons, points=_points(errors))
        for reckons, costs in ((False, held), (True, reckoned))
        for sent, errors in (
            (Sent.FIXED, [cost.fixed for cost in costs]),
            (Sent.WITHIN, [cost.within for cost in costs]),
        )
    ]
    shown = tuple(line for line in lines if line.points)
    if not shown:
        return None
    points = [point for line in shown for point in line.points]
    return AccuracyChart(
        name=f"{curve.topic} {curve.property_name}",
        unit=curve.unit,
        messages=log_scale([messages for messages, _ in points]),
        errors=log_scale([error for _, error in points]),
        lines=shown,
    )


def _points(errors: Iterable[PacedPicture]) -> tuple[tuple[int, float], ...]:
    known = {(error.messages, error.worst) for error in errors if _LEAST < error.worst < math.inf}
    return tuple(sorted(known, key=lambda point: (point[0], -point[1])))


_TOP, _HEIGHT, _BOTTOM = 22.0, 220.0, 44.0
_FOOT = _TOP + _HEIGHT
_MARK_PX = 2.5
_EXPLANATION = (
    "How many messages the robot must send for the operator's picture to be at most so much off: messages "
    "that a bound (KeepWithin) lets pass, beside a fixed rate of as many. Lower and further left is better."
)


def accuracy_curve_parts(curve: AccuracyCurve) -> Iterator[Markup]:
    """The worst error against the messages, and all numbers beneath."""
    chart = accuracy_chart(curve)
    yield tag("p", _EXPLANATION, class_="explanation")
    if chart:
        yield legend(*(line_entry(style_of(line), line.name) for line in chart.lines))
        yield figure(draw_accuracy(chart), topic_name(chart.name))
    yield from folded_tables([accuracy_table([curve])])


def style_of(line: AccuracyLine) -> str:
    """The class of a line in the style sheet."""
    return f"{line.sent.value} reckoned" if line.reckons else line.sent.value


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
