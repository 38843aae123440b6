# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Poses and velocities: Odometry, Twist, Imu, JointState."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Protocol

from smarttestudo.language.properties.field_path import Reader


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
    return math.sqrt(vector.x * vector.x + vector.y * vector.y + vector.z * vector.z)


def roll_degrees(q: QuaternionMessage) -> float:
    """Rotation about x of the intrinsic z-y-x angles, in (−180, 180]; NaN for the zero quaternion."""
    return _degrees(q, 2 * (q.w * q.x + q.y * q.z), q.w * q.w - q.x * q.x - q.y * q.y + q.z * q.z)


def pitch_degrees(q: QuaternionMessage) -> float:
    """Rotation about y, in [−90, 90]; NaN for the zero quaternion."""
    norm = _squared_norm(q)
    if not norm > 0:
        return math.nan
    sine = 2 * (q.w * q.y - q.z * q.x) / norm
    return math.degrees(math.asin(max(-1.0, min(1.0, sine))))


def yaw_degrees(q: QuaternionMessage) -> float:
    """Rotation about z, in (−180, 180]; NaN for the zero quaternion."""
    return _degrees(q, 2 * (q.w * q.z + q.x * q.y), q.w * q.w + q.x * q.x - q.y * q.y - q.z * q.z)


def _degrees(q: QuaternionMessage, sine: float, cosine: float) -> float:
    if not _squared_norm(q) > 0:
        return math.nan
    degrees = math.degrees(math.atan2(sine, cosine))
    return 180.0 if degrees <= -180.0 else degrees


def _squared_norm(q: QuaternionMessage) -> float:
    return q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z


def greatest_magnitude(field: str) -> Reader:
    """Read the greatest absolute value of the array ``field``; NaN entries are skipped."""

    def read(message: object) -> float:
        values: Iterable[float] = getattr(message, field, ())
        return max((abs(float(value)) for value in values if not math.isnan(value)), default=math.nan)

    return read
