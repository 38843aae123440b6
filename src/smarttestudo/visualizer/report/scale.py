# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Axes: values to places on a chart."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import TypeVar

from smarttestudo.visualizer.report.markup import Markup, coordinate, tag
from smarttestudo.visualizer.rule_timeline import RuleSpan
from smarttestudo.visualizer.targets import TargetSpan

_ROUND_STEPS = (1.0, 2.0, 5.0, 10.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Scale:
    """A piecewise linear map through ``(values[i], places[i])``, constant beyond both ends; values rise."""

    values: tuple[float, ...]
    places: tuple[float, ...]

    def __call__(self, value: float) -> float:
        """The place of ``value``."""
        if value <= self.values[0]:
            return self.places[0]
        if value >= self.values[-1]:
            return self.places[-1]
        index = bisect_right(self.values, value)
        low, high = self.values[index - 1 : index + 1]
        start, end = self.places[index - 1 : index + 1]
        return start + (value - low) / (high - low) * (end - start)


def linear(values: tuple[float, float], places: tuple[float, float]) -> Scale:
    """The straight map from one stretch to another."""
    return Scale(values=values, places=places)


def multiples(step: float, low: float, high: float) -> list[float]:
    """The multiples of ``step`` from ``low`` to ``high``."""
    first = math.ceil(low / step - 1e-9)
    last = math.floor(high / step + 1e-9)
    return [index * step for index in range(first, last + 1)]


def round_step(wanted: float) -> float:
    """The least of 1, 2, 5 times a power of ten that is at least ``wanted`` (> 0)."""
    power = 10.0 ** math.floor(math.log10(wanted))
    return power * next(step for step in _ROUND_STEPS if step * power >= wanted * (1 - 1e-9))


def label(value: float, digits: int = 6) -> str:
    """``value`` in at most ``digits`` significant digits, with a true minus."""
    return f"{value + 0.0:.{digits}g}".replace("-", "−")


@dataclass(frozen=True, slots=True, kw_only=True)
class LaneSpan:
    """From ``start_s`` to ``end_s``: what is written on the bar, and its look."""

    start_s: float
    end_s: float
    text: str
    css_class: str


_Span = TypeVar("_Span", RuleSpan, TargetSpan, LaneSpan)


def long_enough(spans: Iterable[_Span], shortest_s: float) -> Iterator[_Span]:
    """``spans`` without those shorter than ``shortest_s``, each of which becomes part of the next."""
    start_s: float | None = None
    for span in spans:
        start_s = span.start_s if start_s is None else start_s
        if span.end_s - start_s >= shortest_s:
            yield span if start_s == span.start_s else replace(span, start_s=start_s)
            start_s = None


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
    """The drawing as an element with a description."""
    return tag(
        "svg",
        *content,
        class_=f"static {css_class}",
        viewBox=f"0 0 {coordinate(WIDTH)} {coordinate(height)}",
        role="img",
        aria_label=meaning,
    )
