# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Stretches of time, as many as can be told apart."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import TypeVar

from smarttestudo.visualizer.rule_timeline import RuleSpan
from smarttestudo.visualizer.targets import TargetSpan


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
