# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The scale, ticks, axes and legend of every chart of a page."""

from __future__ import annotations

import itertools
import math
from bisect import bisect_right
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from smarttestudo.report.markup import Markup, tag

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


def multiples(step: float, low: float, high: float) -> list[float]:
    """The multiples of ``step`` from ``low`` to ``high``."""
    first = math.ceil(low / step - 1e-9)
    last = math.floor(high / step + 1e-9)
    return [index * step for index in range(first, last + 1)]


def round_step(wanted: float) -> float:
    """The least of 1, 2, 5 times a power of ten that is at least ``wanted`` (> 0)."""
    power = 10.0 ** math.floor(math.log10(wanted))
    return power * next(step for step in _ROUND_STEPS if step * power >= wanted * (1 - 1e-9))


_MARGIN = 1.15
_LOG_STEPS = ((1, 2, 3, 5), (1, 2, 5), (1,))
_LEAST_TICKS, _MOST_TICKS = 3, 7


@dataclass(frozen=True, slots=True, kw_only=True)
class LogScale:
    """A logarithmic map from ``low`` … ``high`` to 0 … 1, and the values to label."""

    low: float
    high: float
    ticks: tuple[float, ...]

    def __call__(self, value: float) -> float:
        """The place of ``value``."""
        return math.log(value / self.low) / math.log(self.high / self.low)


def log_scale(values: Iterable[float]) -> LogScale:
    """A little wider than ``values``, which are above 0, with at most ``_MOST_TICKS`` round ones."""
    known = sorted(values)
    low, high = known[0] / _MARGIN, known[-1] * _MARGIN
    powers = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    for steps in _LOG_STEPS:
        ticks = [step * 10.0**power for power, step in itertools.product(powers, steps)]
        shown = tuple(tick for tick in ticks if low <= tick <= high)
        if len(shown) <= _MOST_TICKS:
            break
    else:
        shown = shown[:: -(-len(shown) // _MOST_TICKS)]
    if len(shown) < _LEAST_TICKS:
        # Within less than a decade they are as far apart as on any other axis.
        shown = tuple(multiples(round_step((high - low) / _MOST_TICKS), low, high)[:_MOST_TICKS])
    return LogScale(low=low, high=high, ticks=shown)


def label(value: float, digits: int = 6) -> str:
    """``value`` in at most ``digits`` significant digits, with a true minus."""
    return f"{value + 0.0:.{digits}g}".replace("-", "−")


def tick_label(value: float) -> str:
    """A value on an axis: at most six significant digits, thousands apart."""
    return f"{value:,g}".replace(",", " ")


# Layers are read as differences of heights.
DIGITS = 7
_MOST_DECIMALS = 6


def number(value: float, digits: int = DIGITS) -> str:
    """``value`` in ``digits`` significant digits, at most six of them decimals, and no exponent."""
    if value == 0:
        return "0"
    whole = len(str(int(abs(value)))) if abs(value) >= 1 else 0
    text = f"{value:.{min(max(digits - whole, 0), _MOST_DECIMALS)}f}"
    return text.rstrip("0").rstrip(".") if "." in text else text


def percent_place(part: float, whole: float = 1.0) -> str:
    """``part`` in percent of ``whole``, which is a place at any width."""
    return f"{number(round(100 * part / whole, 2))}%"


def value_axis(
    ticks: Iterable[tuple[str, float]],
    unit: str | None = None,
    *,
    left: float = 0.0,
    right: float | str = "100%",
) -> Iterator[Markup]:
    """A line at the height of each tick, with its label to the left of it, and the unit on top."""
    for text, at in ticks:
        yield tag("line", class_="grid", x1=left, x2=right, y1=at, y2=at)
        yield tag("text", text, class_="tick", x=left - 6, y=at + 3.5, text_anchor="end")
    if unit is not None:
        yield tag("text", unit, class_="tick", x=left - 6, y=10.0, text_anchor="end")


def foot_axis(ticks: Iterable[tuple[str, float | str]], *, top: float, foot: float) -> Iterator[Markup]:
    """A line at the place of each tick, with its label under it."""
    for text, at in ticks:
        yield tag("line", class_="grid", x1=at, x2=at, y1=top, y2=foot)
        yield tag("text", text, class_="tick", x=at, y=foot + 18, text_anchor="middle")


_TIME_TOLERANCE = 1.005


def time_axis(duration_s: float, most: int) -> Iterator[Markup]:
    """Labels at round times; the last one has the unit."""
    times_s = multiples(round_step(duration_s / most), 0.0, duration_s * _TIME_TOLERANCE)
    for time_s in times_s:
        unit = " s" if time_s == times_s[-1] else ""
        yield tag("text", label(time_s) + unit, x=percent_place(time_s, duration_s), text_anchor="middle")


def plot(*content: Markup, view: tuple[float, float, float, float], y: float, height: float) -> Markup:
    """``content`` in its own units, ``view`` of which are as wide as the chart; the rest is cut off."""
    return tag(
        "svg",
        *content,
        class_="plot",
        viewBox=" ".join(map(number, view)),
        preserveAspectRatio="none",
        y=y,
        width="100%",
        height=height,
    )


def legend(*entries: Markup, kind: str = "") -> Markup:
    """``entries`` beside each other, below each other where the style sheet says so of this ``kind``."""
    return tag("ul", *entries, class_=f"legend {kind}".rstrip())


def line_entry(css_class: str, name: str, note: str = "") -> Markup:
    """The line of a class with its name, and a ``note`` on it."""
    return _entry(tag("path", class_=css_class, d="M1 6H33"), name, note)


def area_entry(css_class: str, name: str, note: str = "") -> Markup:
    """The area of a class, as ``line_entry``."""
    return _entry(tag("rect", class_=css_class, x=1.0, y=1.0, width=32.0, height=10.0), name, note)


def _entry(shape: Markup, name: str, note: str) -> Markup:
    sample = tag("svg", shape, class_="sample", viewBox="0 0 34 12", aria_hidden="true")
    more = [tag("span", note, class_="quiet")] if note else []
    return tag("li", sample, tag("span", name, class_="words"), *more)
