# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Poses and velocities: Odometry, Twist, Imu, JointState."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Protocol

from smarttestudo.language.properties.field_path import Reader, number


class VectorMessage(Protocol):
    """A geometry_msgs Vector3 or Point."""

    x: float
    y: float
    z: float


class QuaternionMessage(VectorMessage, Protocol):
    """A geometry_msgs QuaternionMessage."""

    w: float


def length(vector: VectorMessage) -> float:
    """The Euclidean length."""
    x, y, z = number(vector.x), number(vector.y), number(vector.z)
    return math.sqrt(x * x + y * y + z * z)


def roll_degrees(q: QuaternionMessage) -> float:
    """Rotation about x of the intrinsic z-y-x angles, in (−180, 180]; NaN for the zero quaternion."""
    x, y, z, w = _numbers(q)
    return _degrees(2 * (w * x + y * z), w * w - x * x - y * y + z * z)


def pitch_degrees(q: QuaternionMessage) -> float:
    """Rotation about y, in [−90, 90]; NaN for the zero quaternion."""
    x, y, z, w = _numbers(q)
    sine = 2 * (w * y - z * x) / (w * w + x * x + y * y + z * z)
    # In this order NaN stays.
    return math.degrees(math.asin(max(min(sine, 1.0), -1.0)))


def yaw_degrees(q: QuaternionMessage) -> float:
    """Rotation about z, in (−180, 180]; NaN for the zero quaternion."""
    x, y, z, w = _numbers(q)
    return _degrees(2 * (w * z + x * y), w * w + x * x - y * y - z * z)


def _degrees(sine: float, cosine: float) -> float:
    degrees = math.degrees(math.atan2(sine, cosine))
    return 180.0 if degrees <= -180.0 else degrees


def _numbers(q: QuaternionMessage) -> tuple[float, float, float, float]:
    """All NaN where they are no quaternion: zero, or beyond what can be squared."""
    x, y, z, w = number(q.x), number(q.y), number(q.z), number(q.w)
    is_one = 0 < w * w + x * x + y * y + z * z < math.inf
    return (x, y, z, w) if is_one else (math.nan,) * 4


def greatest_magnitude(field: str) -> Reader:
    """Read the greatest absolute value of the array ``field``; NaN entries are skipped."""

    def read(message: object) -> float:
        values: Iterable[float] = getattr(message, field, ())
        return max((abs(float(value)) for value in values if not math.isnan(value)), default=math.nan)

    return read
