# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""From values to places on paper, and the round values to label there."""

from __future__ import annotations

import math
from bisect import bisect_right
from dataclasses import dataclass

_ROUND_STEPS = (1.0, 2.0, 5.0, 10.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Scale:
    """A piecewise linear map through ``(values[i], places[i])``, constant beyond both ends; values rise."""

    values: tuple[float, ...]
    places: tuple[float, ...]

    def __call__(self, value: float) -> float:
        """The place of ``value``."""
        if value <= self.values[0]:
            return self.places[0]
        if value >= self.values[-1]:
            return self.places[-1]
        index = bisect_right(self.values, value)
        low, high = self.values[index - 1 : index + 1]
        start, end = self.places[index - 1 : index + 1]
        return start + (value - low) / (high - low) * (end - start)


def linear(values: tuple[float, float], places: tuple[float, float]) -> Scale:
    """The straight map from one stretch to another."""
    return Scale(values=values, places=places)


def multiples(step: float, low: float, high: float) -> list[float]:
    """The multiples of ``step`` from ``low`` to ``high``."""
    first = math.ceil(low / step - 1e-9)
    last = math.floor(high / step + 1e-9)
    return [index * step for index in range(first, last + 1)]


def round_step(wanted: float) -> float:
    """The least of 1, 2, 5 times a power of ten that is at least ``wanted`` (> 0)."""
    power = 10.0 ** math.floor(math.log10(wanted))
    return power * next(step for step in _ROUND_STEPS if step * power >= wanted * (1 - 1e-9))


def label(value: float, digits: int = 6) -> str:
    """``value`` in at most ``digits`` significant digits, with a true minus."""
    return f"{value + 0.0:.{digits}g}".replace("-", "−")
