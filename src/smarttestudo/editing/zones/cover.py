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
_Side = tuple[Corner, Corner]

MAX_CORNERS = 100
USUAL_RECTANGLES = 8
MAX_RECTANGLES = 40
TOLERANCE = 0.02
"""Strips are joined as long as less than this share of the polygon's area is covered beside it."""
_STRIPS = 60


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
        """The area in cm²."""
        return (self.max_x_cm - self.min_x_cm) * (self.max_y_cm - self.min_y_cm)


@dataclass(frozen=True, slots=True, kw_only=True)
class Cover:
    """Rectangles that share no area and together hold a polygon of ``polygon_cm2``."""

    rectangles: tuple[CoverRectangle, ...]
    polygon_cm2: float

    @property
    def over_cm2(self) -> float:
        """The area that they cover beside the polygon."""
        return sum(rectangle.area_cm2 for rectangle in self.rectangles) - self.polygon_cm2


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
    strips = [(ends, outline.reach(*ends)) for ends in pairwise(outline.cuts())]
    allowed = area + Fraction(tolerance) * area
    covered, count = sum(map(_area, strips)), sum(len(spans) for _, spans in strips)
    joins = [outline.join(*pair) for pair in pairwise(strips)]
    while joins:
        at = min(range(len(joins)), key=lambda i: joins[i].cost)
        join = joins[at]
        if count <= most and covered + join.cost[0] > allowed:
            break
        covered += join.cost[0]
        count += len(join.strip[1]) - len(strips[at][1]) - len(strips[at + 1][1])
        strips[at : at + 2] = [join.strip]
        first = max(at - 1, 0)
        last = min(at + 1, len(strips) - 1)
        joins[first : at + 2] = [outline.join(strips[i], strips[i + 1]) for i in range(first, last)]
    return strips


def _cost(strips: Sequence[_Strip], area: Fraction, tolerance: float) -> tuple[bool, int, Fraction]:
    """The cost of a cover: too much area, then the number of rectangles, then area."""
    over = sum(map(_area, strips)) - area
    is_loose = over > Fraction(tolerance) * area
    count = sum(len(spans) for _, spans in strips)
    return (is_loose, 0 if is_loose else count, over)


def _area(strip: _Strip) -> int:
    (left, right), spans = strip
    return (right - left) * sum(high - low for low, high in spans)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Join:
    """Two strips as one; ``cost`` is the area that this adds, then how many rectangles it is."""

    strip: _Strip
    cost: tuple[int, int]


class _Outline:
    """The sides of a polygon, each from its left end to its right one."""

    def __init__(self, corners: Sequence[Corner]) -> None:
        self._sides = [(min(side), max(side)) for side in _sides(corners)]
        self._crossings: dict[tuple[int, int], list[_Interval]] = {}

    def cuts(self) -> list[int]:
        """The x of all corners, and where sides are slanted more between them, some tens in all."""
        stops = sorted({x for side in self._sides for x, _ in side})
        step = max(1, (stops[-1] - stops[0]) // _STRIPS)
        cuts = [stops[0]]
        for left, right in pairwise(stops):
            is_slanted = any(
                one[1] != other[1] and _is_over((one, other), left, right) for one, other in self._sides
            )
            cuts += [*(range(left + step, right, step) if is_slanted else ()), right]
        return cuts

    def join(self, left: _Strip, right: _Strip) -> _Join:
        """Both strips as one."""
        ends = (left[0][0], right[0][1])
        strip = (ends, self.reach(*ends))
        return _Join(strip=strip, cost=(_area(strip) - _area(left) - _area(right), len(strip[1])))

    def reach(self, left: int, right: int) -> list[_Interval]:
        """The stretches of y of the polygon between two x: those of its sides and of both cuts."""
        spans = [*self._along(left, right), *self._across(left, 1), *self._across(right, -1)]
        joined: list[_Interval] = []
        for low, high in sorted(spans):
            if joined and low <= joined[-1][1]:
                joined[-1] = (joined[-1][0], max(joined[-1][1], high))
            else:
                joined.append((low, high))
        return [span for span in joined if span[0] < span[1]]

    def _along(self, left: int, right: int) -> Iterator[_Interval]:
        for side in self._sides:
            (start, low), (end, high) = side
            if start == end:
                if left < start < right:
                    yield low, high
            elif _is_over(side, left, right):
                yield _span(_height(side, max(left, start)), _height(side, min(right, end)))

    def _across(self, x: int, way: int) -> list[_Interval]:
        """Where the line just beside ``x``, on the side of ``way``, runs inside the polygon."""
        known = self._crossings.get((x, way))
        if known is None:
            crossed = sorted(
                (_height(side, x), way * _slope(side))
                for side in self._sides
                if (side[0][0] <= x < side[1][0] if way > 0 else side[0][0] < x <= side[1][0])
            )
            known = [
                _span(low, high) for (low, _), (high, _) in zip(crossed[::2], crossed[1::2], strict=True)
            ]
            self._crossings[x, way] = known
        return known


def _is_over(side: _Side, left: int, right: int) -> bool:
    """Whether a side has a part between two x; one that is upright has not."""
    return side[0][0] < right and side[1][0] > left and side[0][0] != side[1][0]


def _span(one: Fraction, other: Fraction) -> _Interval:
    return floor(min(one, other)), ceil(max(one, other))


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
