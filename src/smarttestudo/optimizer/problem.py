# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The problem that every model comes down to: rates worth most, within a budget, by a greedy over quality."""

from __future__ import annotations

import itertools
import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from smarttestudo.domain.rate import Tier

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


ABOVE_SATURATION_HZ = 10.0
_COLLINEAR = 1e-12
_EXCESSIVE_LEVEL = Tier.EXCESSIVE.level

Point = tuple[float, float]
"""A rate in Hz and the quality it brings, 0 … 5."""


def interval_hz(tier: Tier, tiers_hz: Sequence[float]) -> tuple[float, float]:
    """The lowest and highest rate of a level (Riccardi 2025, QUPER model), from τ0 … τ5."""
    level = tier.level
    if level == 0:
        return 0.0, tiers_hz[0]
    if level == _EXCESSIVE_LEVEL:
        return tiers_hz[level], tiers_hz[level] + ABOVE_SATURATION_HZ
    return tiers_hz[level - 1], tiers_hz[level]


def tier_of(rate_hz: float, tiers_hz: Sequence[float]) -> Tier:
    """The level of a rate: the lowest one whose interval holds it; between τ4 and τ5 it is Competitive."""
    if rate_hz >= tiers_hz[5]:
        return Tier.EXCESSIVE
    return next(
        (tier for tier in reversed(list(Tier)[1:5]) if rate_hz > tiers_hz[tier.level - 1]), Tier.UNACCEPTABLE
    )


def quality_points(tiers_hz: Sequence[float]) -> list[Point]:
    """(0, 0), (τ0, 1) … (τ4, 5): the rate at which each level above Unacceptable is reached in full."""
    return [(0.0, 0.0), *((rate_hz, float(level)) for level, rate_hz in enumerate(tiers_hz[:5], start=1))]


def upper_envelope(points: Sequence[Point]) -> list[Point]:
    """The least concave curve above rising ``points``, by its corners (monotone chain)."""
    corners: list[Point] = []
    for point in points:
        while corners and corners[-1][0] == point[0] and corners[-1][1] <= point[1]:
            corners.pop()
        while len(corners) > 1 and _turn(corners[-2], corners[-1], point) >= -_COLLINEAR:
            corners.pop()
        corners.append(point)
    return corners


def skipped_thresholds(tiers_hz: Sequence[float]) -> list[int]:
    """The levels τ0 … τ4 that lie below the envelope, so that no rate is drawn to them."""
    corners = upper_envelope(quality_points(tiers_hz))
    points = list(enumerate(quality_points(tiers_hz)[1:]))
    return [index for index, (rate, quality) in points if _value(corners, rate) > quality + 1e-9]


def envelope_pieces(
    tiers_hz: Sequence[float], *, least_hz: float, most_hz: float, priority: float
) -> tuple[Piece, ...]:
    """The envelope from ``least_hz`` to ``most_hz`` as pieces of worth ``priority`` times quality."""
    corners = upper_envelope(quality_points(tiers_hz))
    pieces: list[Piece] = []
    for (start_hz, low), (end_hz, high) in itertools.pairwise(corners):
        width_hz = min(end_hz, most_hz) - max(start_hz, least_hz)
        if width_hz > 0:
            pieces.append(Piece(width_hz, priority * (high - low) / (end_hz - start_hz)))
    flat_hz = most_hz - max(corners[-1][0], least_hz)
    if flat_hz > 0:
        pieces.append(Piece(flat_hz, 0.0))
    return tuple(pieces)


def _turn(a: Point, b: Point, c: Point) -> float:
    """Above 0 where a → b → c turns left, that is, where b lies below the line from a to c."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _value(corners: Sequence[Point], rate_hz: float) -> float:
    for (start_hz, low), (end_hz, high) in itertools.pairwise(corners):
        if rate_hz <= end_hz:
            return low + (high - low) * max(0.0, rate_hz - start_hz) / (end_hz - start_hz)
    return corners[-1][1]


_SIGNIFICANT_DIGITS = 12

Segment = tuple[float, int, float, float]
"""The gain for each KB, the index of the topic, the width in Hz, the cost in KB/s."""


def allocate(demands: Sequence[Demand], budget_kb_per_s: float) -> Allocation | None:
    """The rates of the greatest gain with ``Σ size·rate`` within the budget, ``None`` where none fit.

    It fills the pieces of best gain per KB first, which is exact for concave worths. Pieces of equal gain are
    filled by the same share, so neither names nor order decide.
    """
    least_kb_per_s = math.fsum([demand.size_kb * demand.least_hz for demand in demands])
    if not fits(least_kb_per_s, budget_kb_per_s):
        return None
    rates = [demand.least_hz for demand in demands]
    segments = [
        (_density(piece.gain_per_hz, demand.size_kb), index, piece.width_hz, piece.width_hz * demand.size_kb)
        for index, demand in enumerate(demands)
        for piece in demand.pieces
        if piece.gain_per_hz > 0 and piece.width_hz > 0
    ]
    price = fill(rates, segments, budget_kb_per_s - least_kb_per_s)
    return Allocation(
        rates_hz={demand.topic: rate for demand, rate in zip(demands, rates, strict=True)}, price=price
    )


def fill(rates_hz: list[float], segments: list[Segment], left_kb_per_s: float) -> float:
    """Raise ``rates_hz`` along ``segments`` while KB/s are left, best gain first, equal gains by one share.

    Returns the price: the gain of the next KB, 0 where all segments are filled.
    """
    groups: dict[float, list[Segment]] = {}
    for segment in segments:
        groups.setdefault(segment[0], []).append(segment)
    for density in sorted(groups, reverse=True):
        cost = math.fsum(segment[3] for segment in groups[density])
        share = 1.0 if cost <= 0 or fits(cost, left_kb_per_s) else max(0.0, left_kb_per_s) / cost
        for _, index, width_hz, _ in groups[density]:
            rates_hz[index] += share * width_hz
        if share < 1.0:
            return density
        # Below 0 by float noise once at most: it is not forgiven for each group anew.
        left_kb_per_s -= cost
    return 0.0


def _density(gain_per_hz: float, size_kb: float) -> float:
    """Gain per KB, so rounded that equal quotients of different numbers are equal."""
    if size_kb <= 0:
        return math.inf
    return float(f"{gain_per_hz / size_kb:.{_SIGNIFICANT_DIGITS}g}")
