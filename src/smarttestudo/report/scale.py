# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Axes: values to places on a chart."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

from smarttestudo.bags.targets import TargetSpan
from smarttestudo.report.rule_styles import RuleStyle

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


def tick_label(value: float) -> str:
    """A value on an axis: at most six significant digits, thousands apart."""
    return f"{value:,g}".replace(",", " ")


@dataclass(frozen=True, slots=True, kw_only=True)
class StyleSpan:
    """From ``start_s`` to ``end_s``: the style of what is drawn, and what is written on it."""

    start_s: float
    end_s: float
    style: RuleStyle
    text: str = ""


_Span = TypeVar("_Span", TargetSpan, StyleSpan)


def long_enough(spans: Iterable[_Span], shortest_s: float) -> Iterator[_Span]:
    """``spans`` without those shorter than ``shortest_s``, each of which becomes part of the next."""
    start_s: float | None = None
    for span in spans:
        start_s = span.start_s if start_s is None else start_s
        if span.end_s - start_s >= shortest_s:
            yield span if start_s == span.start_s else replace(span, start_s=start_s)
            start_s = None


def bounded(spans: Sequence[_Span], most: int) -> Sequence[_Span]:
    """``spans`` in at most about ``most``."""
    if len(spans) <= most:
        return spans
    return tuple(long_enough(spans, (spans[-1].end_s - spans[0].start_s) / most))
