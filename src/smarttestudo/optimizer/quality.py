# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""QUPER quality levels as rates: intervals of levels, levels of rates, and what a rate is worth."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

from smarttestudo.domain.rate import Tier
from smarttestudo.optimizer.problem import Piece

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
        (tier for tier in reversed(list(Tier)[1:5]) if rate_hz > tiers_hz[tier.level - 1]),
        Tier.UNACCEPTABLE,
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
