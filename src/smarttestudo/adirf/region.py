# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Sets of real numbers as unions of intervals: where a comparison holds."""

from __future__ import annotations

import math
from dataclasses import dataclass

from smarttestudo.adirf.syntax import Operator

Bound = tuple[float, int]
"""A cut of the number line: ``(v, -1)`` lies just below ``v``, ``(v, 1)`` just above it."""

_LOWEST: Bound = (-math.inf, -1)
_HIGHEST: Bound = (math.inf, 1)


@dataclass(frozen=True, slots=True)
class Region:
    """A union of disjoint, non-touching intervals in rising order, each from one cut to the next.

    Cuts between numbers make open and closed ends alike: ``x > 3`` is ``((3, 1), (inf, 1))``.
    """

    pieces: tuple[tuple[Bound, Bound], ...]

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
        below, above = (value, -1), (value, 1)
        pieces: dict[Operator, tuple[tuple[Bound, Bound], ...]] = {
            Operator.GREATER: ((above, _HIGHEST),),
            Operator.GREATER_EQUAL: ((below, _HIGHEST),),
            Operator.LESS: ((_LOWEST, below),),
            Operator.LESS_EQUAL: ((_LOWEST, above),),
            Operator.EQUAL: ((below, above),),
            Operator.NOT_EQUAL: ((_LOWEST, below), (above, _HIGHEST)),
        }
        return Region(pieces[operator])

    @property
    def is_empty(self) -> bool:
        """Whether no number is in it."""
        return not self.pieces

    @property
    def is_everything(self) -> bool:
        """Whether every number is in it."""
        return self.pieces == ((_LOWEST, _HIGHEST),)

    @property
    def cuts(self) -> tuple[Bound, ...]:
        """The finite cuts at which membership changes, rising."""
        ends = (cut for piece in self.pieces for cut in piece)
        return tuple(cut for cut in ends if cut not in (_LOWEST, _HIGHEST))

    def contains(self, value: float) -> bool:
        """Whether ``value`` is in it; NaN never is."""
        return any(low < (value, 0) < high for low, high in self.pieces)

    def intersection(self, other: Region) -> Region:
        """What is in both."""
        pieces = [
            (max(a[0], b[0]), min(a[1], b[1]))
            for a in self.pieces
            for b in other.pieces
            if max(a[0], b[0]) < min(a[1], b[1])
        ]
        return Region(tuple(sorted(pieces)))

    def complement(self) -> Region:
        """What is not in it."""
        pieces: list[tuple[Bound, Bound]] = []
        start = _LOWEST
        for low, high in self.pieces:
            if start < low:
                pieces.append((start, low))
            start = high
        if start < _HIGHEST:
            pieces.append((start, _HIGHEST))
        return Region(tuple(pieces))

    def union(self, other: Region) -> Region:
        """What is in either."""
        return self.complement().intersection(other.complement()).complement()

    def sample(self) -> float:
        """A plain number in it, a round one where it can be; ``ValueError`` when it is empty."""
        if self.is_empty:
            raise ValueError("an empty region holds no number")
        (low, low_side), (high, high_side) = self.pieces[0]
        if math.isinf(low) and math.isinf(high):
            return 0.0
        if math.isinf(low):
            return high if high_side > 0 else math.floor(high - 1e-9)
        if math.isinf(high):
            return low if low_side < 0 else math.ceil(low + 1e-9)
        return low if low == high else _roundest_between(low, high)


def _roundest_between(low: float, high: float) -> float:
    middle = (low + high) / 2
    for digits in range(17):
        rounded = round(middle, digits)
        if low < rounded < high:
            return rounded
    return middle
