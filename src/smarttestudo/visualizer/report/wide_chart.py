# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The frame of charts as wide as the page: time along its foot."""

from __future__ import annotations

from collections.abc import Iterator

from smarttestudo.visualizer.report.markup import Markup, coordinate, tag
from smarttestudo.visualizer.report.scale import Scale, label, linear, multiples, round_step

WIDTH = 1000.0
LEFT, RIGHT, TOP, BOTTOM = 64.0, 24.0, 22.0, 30.0
_TIME_TICKS = 10
_VALUE_TICKS = 4
_TIME_TOLERANCE = 1.005
_HEADROOM = 1.08


def time_scale(duration_s: float, left: float = LEFT) -> Scale:
    """From seconds to places between the frame's sides."""
    return linear((0.0, max(duration_s, 1e-3)), (left, WIDTH - RIGHT))


def value_scale(highest: float, foot: float) -> Scale:
    """From 0 to a little above ``highest``, upwards from ``foot``."""
    return linear((0.0, highest * _HEADROOM or 1.0), (foot, TOP))


def time_axis(x: Scale, height: float) -> Iterator[Markup]:
    """Labels at round times under a chart of ``height``; the last one has the unit."""
    times_s = multiples(round_step(x.values[1] / _TIME_TICKS), 0.0, x.values[1] * _TIME_TOLERANCE)
    for value in times_s:
        unit = " s" if value == times_s[-1] else ""
        yield tag("text", label(value) + unit, class_="tick", x=x(value), y=height - 8, text_anchor="middle")


def value_axis(y: Scale, unit: str) -> Iterator[Markup]:
    """Lines at round values, labelled to their left, ``unit`` on top."""
    for value in value_ticks(y):
        at = y(value)
        yield tag("line", class_="grid", x1=LEFT, x2=WIDTH - RIGHT, y1=at, y2=at)
        yield tag("text", f"{value:,g}", class_="tick", x=LEFT - 6, y=at + 3.5, text_anchor="end")
    yield tag("text", unit, class_="tick", x=LEFT - 6, y=12.0, text_anchor="end")


def value_ticks(y: Scale) -> list[float]:
    """The values to label."""
    return multiples(round_step(y.values[-1] / _VALUE_TICKS), 0.0, y.values[-1])


def wide_svg(*content: Markup, height: float, meaning: str, css_class: str) -> Markup:
    """The drawing as an element that says what it shows."""
    return tag(
        "svg",
        *content,
        class_=f"static {css_class}",
        viewBox=f"0 0 {coordinate(WIDTH)} {coordinate(height)}",
        role="img",
        aria_label=meaning,
    )
