# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Upright rectangles of the floor."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class ZoneRectangle:
    """An upright rectangle in metres; ``None`` is a side that nothing bounds."""

    min_x_m: float | None
    max_x_m: float | None
    min_y_m: float | None
    max_y_m: float | None

    @property
    def is_empty(self) -> bool:
        """Whether no place lies in it."""
        low_x, high_x, low_y, high_y = self._ends()
        return low_x >= high_x or low_y >= high_y

    def common(self, other: ZoneRectangle) -> ZoneRectangle | None:
        """What lies in both, ``None`` if nothing does."""
        mine, theirs = self._ends(), other._ends()
        low_x, low_y = max(mine[0], theirs[0]), max(mine[2], theirs[2])
        high_x, high_y = min(mine[1], theirs[1]), min(mine[3], theirs[3])
        found = ZoneRectangle(
            min_x_m=_side(low_x), max_x_m=_side(high_x), min_y_m=_side(low_y), max_y_m=_side(high_y)
        )
        return None if found.is_empty else found

    def _ends(self) -> tuple[float, float, float, float]:
        return (
            -math.inf if self.min_x_m is None else self.min_x_m,
            math.inf if self.max_x_m is None else self.max_x_m,
            -math.inf if self.min_y_m is None else self.min_y_m,
            math.inf if self.max_y_m is None else self.max_y_m,
        )


def _side(end: float) -> float | None:
    return None if math.isinf(end) else end
