# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Polygons as upright rectangles that cover them, which is all that conditions can say.

The polygon is cut into strips at its corners, and strips with slanted sides into thinner ones; then
neighbours are joined where that covers the least beside the polygon. All in whole centimetres, so that
nothing is lost to rounding.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations, pairwise
from math import ceil, floor

from smarttestudo.domain.errors import TestudoError

Corner = tuple[int, int]
"""x and y in centimetres."""

_Interval = tuple[int, int]

MAX_CORNERS = 100
USUAL_RECTANGLES = 8
MAX_RECTANGLES = 40
TOLERANCE = 0.02
"""Strips are joined as long as less than this share of the polygon's area is covered beside it."""
_MAX_STRIPS = 120


class PolygonError(TestudoError):
    """An outline that encloses no area, crosses itself, or has too many corners."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CoverRectangle:
    """One rectangle of a cover, in centimetres."""

    min_x_cm: int
    max_x_cm: int
    min_y_cm: int
    max_y_cm: int

    @property
    def area_cm2(self) -> int:
        """Its area."""
        return (self.max_x_cm - self.min_x_cm) * (self.max_y_cm - self.min_y_cm)


@dataclass(frozen=True, slots=True, kw_only=True)
class Cover:
    """Rectangles that share no area and together hold a polygon of ``polygon_cm2``."""

    rectangles: tuple[CoverRectangle, ...]
    polygon_cm2: float

    @property
    def over_cm2(self) -> float:
        """What they cover beside the polygon."""
        return sum(one.area_cm2 for one in self.rectangles) - self.polygon_cm2


def covering_rectangles(
    corners: Sequence[Corner], *, max_rectangles: int = USUAL_RECTANGLES, tolerance: float = TOLERANCE
) -> Cover:
    """The rectangles for a polygon: few that cover little beside it.

    There are at most ``max_rectangles``, unless one strip holds more separate parts of the polygon than
    that; an upright rectangle is its own cover. Raises ``PolygonError``.
    """
    corners = _without_repeats(corners)
    _require_polygon(corners)
    area = Fraction(abs(_doubled_area(corners)), 2)
    upright = _strips(corners, area, max_rectangles, tolerance)
    lying = _strips([(y, x) for x, y in corners], area, max_rectangles, tolerance)
    is_upright_better = _cost(upright, area, tolerance) <= _cost(lying, area, tolerance)
    rectangles = [
        CoverRectangle(min_x_cm=left, max_x_cm=right, min_y_cm=low, max_y_cm=high)
        if is_upright_better
        else CoverRectangle(min_x_cm=low, max_x_cm=high, min_y_cm=left, max_y_cm=right)
        for (left, right), spans in (upright if is_upright_better else lying)
        for low, high in spans
    ]
    return Cover(rectangles=tuple(rectangles), polygon_cm2=float(area))


def _without_repeats(corners: Sequence[Corner]) -> list[Corner]:
    return [corner for at, corner in enumerate(corners) if corner != corners[at - 1] or len(corners) == 1]


def _require_polygon(corners: Sequence[Corner]) -> None:
    if len(corners) > MAX_CORNERS:
        raise PolygonError(
            f"the outline has {len(corners)} corners", remedy=f"draw it with at most {MAX_CORNERS}"
        )
    sides = list(_sides(corners))
    for (at, one), (other_at, other) in combinations(enumerate(sides), 2):
        is_next = other_at - at in (1, len(sides) - 1)
        if not is_next and _meet(one, other):
            raise PolygonError("the outline crosses or touches itself", remedy="draw it in one round")
    if _doubled_area(corners) == 0:
        raise PolygonError("the outline encloses no area", remedy="give three or more corners, not in a line")


_Strip = tuple[_Interval, list[_Interval]]
"""From which x to which, and the stretches of y that the polygon reaches between them."""


def _strips(corners: Sequence[Corner], area: Fraction, most: int, tolerance: float) -> list[_Strip]:
    outline = _Outline(corners)
    strips = [(ends, outline.reach(*ends)) for ends in pairwise(_cuts(corners))]
    allowed = area + Fraction(tolerance) * area
    covered = sum(map(_area, strips))
    joins = [outline.join(*pair) for pair in pairwise(strips)]
    while joins:
        pairs = zip(joins, pairwise(strips), strict=True)
        costs = [_area(join) - _area(one) - _area(other) for join, (one, other) in pairs]
        at = min(range(len(costs)), key=lambda i: (costs[i], len(joins[i][1])))
        is_too_many = sum(len(spans) for _, spans in strips) > most
        if not is_too_many and covered + costs[at] > allowed:
            break
        covered += costs[at]
        strips[at : at + 2] = [joins[at]]
        joins[max(at - 1, 0) : at + 2] = [
            outline.join(strips[i], strips[i + 1])
            for i in range(max(at - 1, 0), min(at + 1, len(strips) - 1))
        ]
    return strips


def _cost(strips: Sequence[_Strip], area: Fraction, tolerance: float) -> tuple[bool, int, Fraction]:
    """What makes a cover worse: too much area, then the number of rectangles, then area."""
    over = sum(map(_area, strips)) - area
    is_loose = over > Fraction(tolerance) * area
    count = sum(len(spans) for _, spans in strips)
    return (is_loose, 0 if is_loose else count, over)


def _cuts(corners: Sequence[Corner]) -> list[int]:
    """The x of all corners, with more between them as far apart as makes about ``_MAX_STRIPS`` strips."""
    stops = sorted({x for x, _ in corners})
    step = max(1, (stops[-1] - stops[0]) // max(1, _MAX_STRIPS - len(stops)))
    return sorted({x for left, right in pairwise(stops) for x in (*range(left, right, step), right)})


def _area(strip: _Strip) -> int:
    (left, right), spans = strip
    return (right - left) * sum(high - low for low, high in spans)


class _Outline:
    """The sides of a polygon, each from its left end to its right one."""

    def __init__(self, corners: Sequence[Corner]) -> None:
        self._sides = [(min(side), max(side)) for side in _sides(corners)]

    def join(self, left: _Strip, right: _Strip) -> _Strip:
        ends = (left[0][0], right[0][1])
        return (ends, self.reach(*ends))

    def reach(self, left: int, right: int) -> list[_Interval]:
        """The stretches of y of the polygon between two x: those of its sides and of both cuts."""
        spans = [*self._along(left, right), *self._across(left, 1), *self._across(right, -1)]
        joined: list[_Interval] = []
        for low, high in sorted((floor(low), ceil(high)) for low, high in spans):
            if joined and low <= joined[-1][1]:
                joined[-1] = (joined[-1][0], max(joined[-1][1], high))
            else:
                joined.append((low, high))
        return [span for span in joined if span[0] < span[1]]

    def _along(self, left: int, right: int) -> Iterator[tuple[Fraction, Fraction]]:
        for side in self._sides:
            (start, low), (end, high) = side
            if start == end:
                if left < start < right:
                    yield Fraction(low), Fraction(high)
            elif start < right and end > left:
                ends = (_height(side, max(left, start)), _height(side, min(right, end)))
                yield min(ends), max(ends)

    def _across(self, x: int, way: int) -> Iterator[tuple[Fraction, Fraction]]:
        """Where the line just beside ``x``, on the side of ``way``, runs inside the polygon."""
        crossed = [
            (_height(side, x), way * _slope(side))
            for side in self._sides
            if (side[0][0] <= x < side[1][0] if way > 0 else side[0][0] < x <= side[1][0])
        ]
        heights = [height for height, _ in sorted(crossed)]
        yield from zip(heights[::2], heights[1::2], strict=True)


_Side = tuple[Corner, Corner]


def _sides(corners: Sequence[Corner]) -> Iterator[_Side]:
    closed = [*corners, *corners[:1]]
    return ((one, other) for one, other in pairwise(closed))


def _slope(side: _Side) -> Fraction:
    (start, low), (end, high) = side
    return Fraction(high - low, end - start)


def _height(side: _Side, x: int) -> Fraction:
    return side[0][1] + _slope(side) * (x - side[0][0])


def _doubled_area(corners: Sequence[Corner]) -> int:
    return sum(x * next_y - next_x * y for (x, y), (next_x, next_y) in _sides(corners))


def _meet(one: _Side, other: _Side) -> bool:
    """Whether two sides share a point."""
    turns = (_turn(*one, other[0]), _turn(*one, other[1]), _turn(*other, one[0]), _turn(*other, one[1]))
    if turns[0] != turns[1] and turns[2] != turns[3]:
        return True
    ends = ((one, other[0]), (one, other[1]), (other, one[0]), (other, one[1]))
    return any(turn == 0 and _is_beside(side, end) for turn, (side, end) in zip(turns, ends, strict=True))


def _turn(start: Corner, end: Corner, point: Corner) -> int:
    cross = (end[0] - start[0]) * (point[1] - start[1]) - (end[1] - start[1]) * (point[0] - start[0])
    return (cross > 0) - (cross < 0)


def _is_beside(side: _Side, point: Corner) -> bool:
    return all(min(side[0][at], side[1][at]) <= point[at] <= max(side[0][at], side[1][at]) for at in (0, 1))
