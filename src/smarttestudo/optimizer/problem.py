# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The problem that every model of OBI comes down to: rates worth most, within a budget."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from typing import NamedTuple

_RELATIVE_SLACK = 1e-9
_STEPS_PER_HZ = 1000


class Piece(NamedTuple):
    """A segment of a topic's rates, ``width_hz`` wide, in which one Hz more gains ``gain_per_hz``."""

    width_hz: float
    gain_per_hz: float


class Demand(NamedTuple):
    """The demand of one topic: at least ``least_hz``, and what more is worth.

    ``pieces`` follow each other from ``least_hz`` up to the highest rate that may be given; their gain never
    rises (a concave worth). ``size_kb`` is the mean message size in KB.
    """

    topic: str
    size_kb: float
    least_hz: float
    pieces: tuple[Piece, ...]

    @property
    def most_hz(self) -> float:
        """The highest rate that may be given."""
        return self.least_hz + sum(piece.width_hz for piece in self.pieces)

    @property
    def least_kb_per_s(self) -> float:
        """The KB/s that the topic takes at its lowest rate."""
        return self.size_kb * self.least_hz


@dataclass(frozen=True, slots=True, kw_only=True)
class Allocation:
    """The best rates in Hz by topic.

    ``price`` is what one KB/s more of the budget would gain, 0 where it would gain nothing.
    """

    rates_hz: Mapping[str, float]
    price: float


def used_kb_per_s(loads: Iterable[tuple[float, float]]) -> float:
    """``Σ size·rate`` over pairs of KB and Hz; the order of the pairs does not matter."""
    return math.fsum([size_kb * rate_hz for size_kb, rate_hz in loads])


def exact_sum(values: Collection[float]) -> list[float]:
    """Few numbers whose sum without rounding is that of ``values``."""
    parts: list[float] = []
    while rest := math.fsum((*values, *(-part for part in parts))):
        parts.append(rest)
    return parts


def fits(needed_kb_per_s: float, limit_kb_per_s: float) -> bool:
    """Whether ``needed`` is within ``limit``, where sums of decimal numbers may be off by float noise."""
    return needed_kb_per_s <= limit_kb_per_s + _RELATIVE_SLACK * max(1.0, abs(limit_kb_per_s))


def round_down(rate_hz: float) -> float:
    """``rate_hz`` in whole steps of 0.001 Hz; what misses a step by float noise only has reached it."""
    steps = rate_hz * _STEPS_PER_HZ
    nearest = round(steps)
    if nearest != steps and not math.isclose(steps, nearest, rel_tol=1e-12, abs_tol=1e-9):
        return math.floor(steps) / _STEPS_PER_HZ
    return nearest / _STEPS_PER_HZ
