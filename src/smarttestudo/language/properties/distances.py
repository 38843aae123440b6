# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How far two values of a property are apart."""

from __future__ import annotations

import math
from collections.abc import Callable
from operator import itemgetter
from typing import Any

from smarttestudo.language.properties.field_path import MOST, PropertySpec
from smarttestudo.pacing.reckoning.gauges import Distance
from smarttestudo.pacing.reckoning.motion import (
    SpatialPose,
    orientation_distance_degrees,
    position_distance_m,
)

FULL_TURN = 360.0


def wraps(spec: PropertySpec) -> bool:
    """Whether the values are degrees in (−180, 180] that go round."""
    return spec.unit == "°" and (spec.minimum, spec.maximum) == (-FULL_TURN / 2, FULL_TURN / 2)


def _pose_distance(between: Callable[[SpatialPose, SpatialPose], float]) -> Distance:
    return Distance(
        lambda one, other: between(one.pose, other.pose),
        # NaN, an infinite number and the zero quaternion cannot be compared with themselves, either.
        lambda one: between(one.pose, one.pose) < math.inf and max(map(abs, one.pose.position)) < MOST,
    )


def value_distance(value: Callable[[Any], object], *, is_angle: bool = False) -> Distance:
    """Distance of what ``value`` reads of a state, in degrees that go round where it ``is_angle``."""
    return Distance(
        lambda one, other: _apart(value(one), value(other), is_angle=is_angle),
        lambda one: _is_known(value(one)),
    )


POSITION = _pose_distance(position_distance_m)
ORIENTATION = _pose_distance(orientation_distance_degrees)
JOINT_POSITION = value_distance(itemgetter(0))


def _is_known(value: Any) -> bool:
    """Whether it is a text, or a number that can be measured."""
    if isinstance(value, str):
        return True
    try:
        return bool(abs(value) < MOST)
    except (TypeError, ValueError, OverflowError):
        return False


def _apart(one: Any, other: Any, *, is_angle: bool) -> float:
    """The absolute difference of numbers; 0 or infinite of texts; NaN of what cannot be compared.

    Two numbers that are both not known are alike.
    """
    if isinstance(one, str) and isinstance(other, str):
        return 0.0 if one == other else math.inf
    try:
        first, second = float(one), float(other)
    except (TypeError, ValueError, OverflowError):
        return math.nan
    if first == second or (math.isnan(first) and math.isnan(second)):
        return 0.0
    difference = first - second
    return (
        abs(math.remainder(difference, FULL_TURN))
        if is_angle and math.isfinite(difference)
        else abs(difference)
    )
