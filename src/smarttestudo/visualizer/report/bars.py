# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A few numbers as bars to one scale."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from smarttestudo.visualizer.report.markup import Markup, tag


@dataclass(frozen=True, slots=True, kw_only=True)
class Bar:
    """A number of at least 0, what it is called, how it reads with its unit, and its look."""

    name: str
    value: float
    text: str
    css_class: str


def bars(entries: Sequence[Bar]) -> Markup:
    """A list that names each number and shows it."""
    most = max((entry.value for entry in entries), default=0.0)
    return tag("dl", *(_entry(entry, most) for entry in entries), class_="bars")


def _entry(entry: Bar, most: float) -> Markup:
    share = 100 * entry.value / most if most > 0 else 0.0
    bar = tag("rect", class_=entry.css_class, x=0.0, y=0.0, width=share, height=10.0)
    drawing = tag("svg", bar, viewBox="0 0 100 10", preserveAspectRatio="none", aria_hidden="true")
    return tag("div", tag("dt", entry.name), tag("dd", drawing, tag("span", entry.text)))
