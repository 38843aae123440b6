# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""LaserScan and BatteryState."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Protocol

from smarttestudo.domain.profile import LevelUnit


class ScanMessage(Protocol):
    """A sensor_msgs LaserScan."""

    range_min: float
    range_max: float
    ranges: Iterable[float]


class Battery(Protocol):
    """A sensor_msgs BatteryState."""

    percentage: float


def nearest_distance_m(scan: ScanMessage) -> float:
    """The smallest range in m.

    −inf (too near, REP 117) counts as range_min, +inf (nothing there) as range_max; NaN, 0 and values
    out of range are skipped; NaN when nothing is left.
    """
    low, high = float(scan.range_min), float(scan.range_max)
    nearest = math.inf
    found = False
    for value in _plain(scan.ranges):
        if math.isinf(value):
            value = high if value > 0 else low  # noqa: PLW2901
        elif value == 0 or not low <= value <= high:
            continue
        found = True
        nearest = min(nearest, value)
    return nearest if found else math.nan


def _plain(values: Iterable[float]) -> Iterable[float]:
    """Python floats, which are much faster to compare one by one than an array's own."""
    to_list = getattr(values, "tolist", None)
    listed: Iterable[float] = to_list() if to_list else values
    return listed


class BatteryLevel:
    """Reads the battery level in percent.

    ``percentage`` is 0…1 by its definition, yet some robots (TurtleBot3) publish 0…100: once a value above 1
    was seen, this topic is in percent for good. ``unit`` settles it beforehand.
    """

    def __init__(self, unit: LevelUnit | None) -> None:
        self._unit = unit

    def __call__(self, message: Battery) -> float:
        """Percent, NaN where the robot does not know."""
        value = float(message.percentage)
        if self._unit is None and value > 1:
            self._unit = LevelUnit.PERCENT
        return value if self._unit is LevelUnit.PERCENT else value * 100
