# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Sets of floating-point numbers as unions of intervals: where a comparison holds."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import reduce
from types import MappingProxyType

from smarttestudo.language.syntax import Operator

Bound = tuple[float, int]
"""A cut of the number line: ``(v, -1)`` lies just below ``v``, ``(v, 1)`` just above it."""

Piece = tuple[Bound, Bound]

_LOWEST: Bound = (-math.inf, -1)
_HIGHEST: Bound = (math.inf, 1)
_SIGNIFICANT_DIGITS = 17
_NOT_EQUAL = Operator.NOT_EQUAL
_SIDES: Mapping[Operator, tuple[int, int]] = MappingProxyType(
    {
        Operator.GREATER: (1, 0),
        Operator.GREATER_EQUAL: (-1, 0),
        Operator.LESS: (0, -1),
        Operator.LESS_EQUAL: (0, 1),
        Operator.EQUAL: (-1, 1),
    }
)
"""Beside which side of the value the numbers of a comparison begin and end; 0 for not at the value."""


@dataclass(frozen=True, slots=True)
class Region:
    """A union of disjoint, non-touching intervals in rising order, each from one cut to the next.

    Cuts between numbers make open and closed ends alike: ``x > 3`` is ``((3, 1), (inf, 1))``. Values are
    floating-point numbers, so an interval between two neighbours among them holds none and is left out.
    """

    pieces: tuple[Piece, ...]

    @staticmethod
    def everything() -> Region:
        """All numbers."""
        return Region(((_LOWEST, _HIGHEST),))

    @staticmethod
    def nothing() -> Region:
        """No number."""
        return Region(())

    @staticmethod
    def where(operator: Operator, value: float) -> Region:
        """The numbers x for which ``x operator value`` holds."""
        pieces = _compared(operator, value)
        if math.isfinite(value):
            return Region(pieces)
        return Region(tuple(piece for piece in pieces if _holds_a_number(*piece)))

    @staticmethod
    def between(minimum: float | None, maximum: float | None, *, includes_minimum: bool = True) -> Region:
        """The numbers from ``minimum`` to ``maximum``; ``None`` leaves that side open."""
        low = _LOWEST if minimum is None else (minimum, -1 if includes_minimum else 1)
        return _joined([(low, _HIGHEST if maximum is None else (maximum, 1))])

    @staticmethod
    def union_of(regions: Iterable[Region]) -> Region:
        """The values in any of ``regions``."""
        return _joined(piece for region in regions for piece in region.pieces)

    @staticmethod
    def intersection_of(regions: Iterable[Region]) -> Region:
        """The values in all of ``regions``; everything if there are none."""
        given = [*regions]
        if all(len(region.pieces) == 1 for region in given):
            return reduce(Region.intersection, given, Region.everything())
        # One after the other, many regions with gaps would take quadratic time.
        return Region.union_of(region.complement() for region in given).complement()

    @property
    def comparison(self) -> tuple[Operator, float] | None:
        """The comparison with one number that holds here only, ``None`` where there is none."""
        for value, _ in self.cuts[:1]:
            for operator in Operator:
                if Region.where(operator, value) == self:
                    return operator, value
        return None

    @property
    def is_inverse(self) -> bool:
        """Whether it is the one, of a region and its complement, that goes down without end."""
        return self.contains(-math.inf)

    @property
    def is_empty(self) -> bool:
        """Whether no number is in it."""
        return not self.pieces

    @property
    def cuts(self) -> tuple[Bound, ...]:
        """The finite cuts at which membership changes, rising."""
        ends = (cut for piece in self.pieces for cut in piece)
        return tuple(cut for cut in ends if cut not in (_LOWEST, _HIGHEST))

    def contains(self, value: float) -> bool:
        """Whether ``value`` is in it; NaN never is."""
        return any(low < (value, 0) < high for low, high in self.pieces)

    def is_within(self, other: Region) -> bool:
        """Whether ``other`` holds all of it."""
        if len(other.pieces) != 1:
            return self.intersection(other.complement()).is_empty
        ((low, high),) = other.pieces
        return not any(
            _holds_a_number(start, min(low, end)) or _holds_a_number(max(start, high), end)
            for start, end in self.pieces
        )

    def intersection(self, other: Region) -> Region:
        """The values in both, in one walk over the pieces."""
        if len(self.pieces) != 1 or len(other.pieces) != 1:
            return Region(tuple(_common_pieces(self.pieces, other.pieces)))
        ((my_low, my_high),) = self.pieces
        ((their_low, their_high),) = other.pieces
        low = max(their_low, my_low)
        high = min(their_high, my_high)
        if low is their_low and high is their_high:
            return other
        if low is my_low and high is my_high:
            return self
        return Region(((low, high),) if _holds_a_number(low, high) else ())

    def complement(self) -> Region:
        """The values outside it."""
        pieces: list[Piece] = []
        start = _LOWEST
        for low, high in self.pieces:
            if _holds_a_number(start, low):
                pieces.append((start, low))
            start = high
        if _holds_a_number(start, _HIGHEST):
            pieces.append((start, _HIGHEST))
        return Region(tuple(pieces))

    def union(self, other: Region) -> Region:
        """The values in either."""
        return Region.union_of((self, other))

    def sample(self) -> float:
        """A number in it, a finite and round one where it can be; ``ValueError`` when it is empty."""
        if self.is_empty:
            raise ValueError("an empty region holds no number")
        for piece in map(_finite, self.pieces):
            if _holds_a_number(*piece):
                return _roundest(piece)
        return next(end for end in (-math.inf, math.inf) if self.contains(end))


def _holds_a_number(low: Bound, high: Bound) -> bool:
    """Whether a floating-point number lies between two cuts: none does between neighbours."""
    if low >= high:
        return False
    return low[1] < 0 or high[1] > 0 or math.nextafter(low[0], math.inf) < high[0]


def _compared(operator: Operator, value: float) -> tuple[Piece, ...]:
    """Where ``x operator value`` holds, as pieces in rising order that may be empty for infinite values."""
    if operator is _NOT_EQUAL:
        return (_LOWEST, (value, -1)), ((value, 1), _HIGHEST)
    low_side, high_side = _SIDES[operator]
    low = (value, low_side) if low_side else _LOWEST
    return ((low, (value, high_side) if high_side else _HIGHEST),)


def _joined(pieces: Iterable[Piece]) -> Region:
    """The union of ``pieces``, which may overlap, touch, be empty and come in any order."""
    joined: list[Piece] = []
    for low, high in sorted(piece for piece in pieces if _holds_a_number(*piece)):
        if joined and not _holds_a_number(joined[-1][1], low):
            joined[-1] = (joined[-1][0], max(joined[-1][1], high))
        else:
            joined.append((low, high))
    return Region(tuple(joined))


def _common_pieces(mine: tuple[Piece, ...], theirs: tuple[Piece, ...]) -> Iterator[Piece]:
    i = j = 0
    while i < len(mine) and j < len(theirs):
        (my_low, my_high), (their_low, their_high) = mine[i], theirs[j]
        low = max(their_low, my_low)
        high = min(their_high, my_high)
        if _holds_a_number(low, high):
            yield low, high
        if my_high < their_high:
            i += 1
        else:
            j += 1


def _finite(piece: Piece) -> Piece:
    """The piece without the infinities themselves."""
    return max(piece[0], (-math.inf, 1)), min(piece[1], (math.inf, -1))


def _roundest(piece: Piece) -> float:
    """The number in ``piece`` with the fewest digits among those near its middle, or near its finite end."""
    target = _target(piece)
    low, high = piece
    for digits in range(1, _SIGNIFICANT_DIGITS + 1):
        rounded = float(f"{target:.{digits}g}")
        if low < (rounded, 0) < high:
            return rounded + 0.0
    lowest, side = low
    return lowest if side < 0 else min(math.nextafter(lowest, math.inf), high[0])


def _target(piece: Piece) -> float:
    """Where to look for a round number: the middle, or the whole number next to the only finite end."""
    (low, low_side), (high, high_side) = piece
    if math.isinf(low) and math.isinf(high):
        return 0.0
    if math.isinf(low):
        return float(high if high_side > 0 else math.ceil(high) - 1)
    if math.isinf(high):
        return float(low if low_side < 0 else math.floor(low) + 1)
    return low / 2 + high / 2
