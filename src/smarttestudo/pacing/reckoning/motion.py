# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Poses that move with a constant twist, and distances between poses.

The fields are called as in geometry_msgs. A twist is in the body's own frame, in m/s and rad/s; moving by it
is the exponential map of SE(3), which in a plane and without sideways motion is the unicycle.
"""

from __future__ import annotations

import math
from typing import NamedTuple

SMALL_ANGLE = 1e-6
"""Below it, in rad, the series of the coefficients are as exact as a double can be."""
LARGE_ANGLE = 1e100
"""From it on, in rad, a turn says nothing, and its cube is beyond all numbers."""


class Vector3(NamedTuple):
    """A geometry_msgs Vector3 or Point."""

    x: float
    y: float
    z: float


class Rotation(NamedTuple):
    """A geometry_msgs Quaternion; it need not be of unit length."""

    x: float
    y: float
    z: float
    w: float


class SpatialPose(NamedTuple):
    """A geometry_msgs Pose."""

    position: Vector3
    orientation: Rotation


class Twist(NamedTuple):
    """A geometry_msgs Twist, in the frame of the body."""

    linear: Vector3
    angular: Vector3


def moved(pose: SpatialPose, twist: Twist, elapsed_s: float) -> SpatialPose:
    """Where ``pose`` is after ``elapsed_s`` of a constant ``twist``; NaN where that is beyond all numbers."""
    # This runs for every message that is compared: in plain numbers it takes a third of the time.
    (lx, ly, lz), (ax, ay, az) = twist
    ax, ay, az = ax * elapsed_s, ay * elapsed_s, az * elapsed_s
    lx, ly, lz = lx * elapsed_s, ly * elapsed_s, lz * elapsed_s
    angle = math.sqrt(ax * ax + ay * ay + az * az)
    if not angle < LARGE_ANGLE:
        return _NOWHERE
    if angle < SMALL_ANGLE:
        first, second, share = 0.5, 1 / 6, 0.5
    else:
        first = (1 - math.cos(angle)) / angle**2
        second = (angle - math.sin(angle)) / angle**3
        share = math.sin(angle / 2) / angle
    # The way in the body's frame: (I + first [a] + second [a]²) · l, as in _jacobian_product.
    ox, oy, oz = ay * lz - az * ly, az * lx - ax * lz, ax * ly - ay * lx
    wx = lx + first * ox + second * (ay * oz - az * oy)
    wy = ly + first * oy + second * (az * ox - ax * oz)
    wz = lz + first * oz + second * (ax * oy - ay * ox)
    (px, py, pz), orientation = pose
    x, y, z, w = _unit(orientation)
    # That way turned by the orientation, as in _rotated.
    ox, oy, oz = (y * wz - z * wy) * 2.0, (z * wx - x * wz) * 2.0, (x * wy - y * wx) * 2.0
    position = Vector3(
        px + (wx + w * ox + (y * oz - z * oy)),
        py + (wy + w * oy + (z * ox - x * oz)),
        pz + (wz + w * oz + (x * oy - y * ox)),
    )
    tx, ty, tz, tw = ax * share, ay * share, az * share, math.cos(angle / 2)
    turned = Rotation(
        w * tx + x * tw + y * tz - z * ty,
        w * ty - x * tz + y * tw + z * tx,
        w * tz + x * ty - y * tx + z * tw,
        w * tw - x * tx - y * ty - z * tz,
    )
    return SpatialPose(position, turned)


def twist_between(before: SpatialPose, after: SpatialPose, elapsed_s: float) -> Twist:
    """The constant twist that moves ``before`` to ``after``; of the two ways to turn, the shorter one."""
    inverse = _conjugate(_unit(before.orientation))
    way = _rotated(inverse, _difference(after.position, before.position))
    turned = _rotation_vector(_product(inverse, _unit(after.orientation)))
    angle = _length(turned)
    half = angle / 2
    second = 1 / 12 if angle < SMALL_ANGLE else (1 - half / math.tan(half)) / angle**2
    way = _jacobian_product(turned, way, -0.5, second)
    return Twist(_scaled(way, 1 / elapsed_s), _scaled(turned, 1 / elapsed_s))


def position_distance_m(one: SpatialPose, other: SpatialPose) -> float:
    """The length of the difference of the positions, in m."""
    return math.dist(one.position, other.position)


def orientation_distance_degrees(one: SpatialPose, other: SpatialPose) -> float:
    """The angle of the rotation between the orientations, 0 … 180°; NaN for the zero quaternion."""
    between = _product(_conjugate(one.orientation), other.orientation)
    sine = math.sqrt(between.x * between.x + between.y * between.y + between.z * between.z)
    if sine == 0 and between.w == 0:
        return math.nan
    return math.degrees(2 * math.atan2(sine, abs(between.w)))


_NOWHERE = SpatialPose(
    Vector3(math.nan, math.nan, math.nan), Rotation(math.nan, math.nan, math.nan, math.nan)
)


def _jacobian_product(axis: Vector3, vector: Vector3, first: float, second: float) -> Vector3:
    """(I + first [axis] + second [axis]²) · vector, with [axis] the matrix of the cross product."""
    once = _cross(axis, vector)
    twice = _cross(axis, once)
    return Vector3(
        vector.x + first * once.x + second * twice.x,
        vector.y + first * once.y + second * twice.y,
        vector.z + first * once.z + second * twice.z,
    )


def _rotation_vector(q: Rotation) -> Vector3:
    sign = -1.0 if q.w < 0 else 1.0
    sine = math.sqrt(q.x * q.x + q.y * q.y + q.z * q.z)
    share = 2 * sign if sine < SMALL_ANGLE else 2 * sign * math.atan2(sine, sign * q.w) / sine
    return Vector3(q.x * share, q.y * share, q.z * share)


def _rotated(q: Rotation, vector: Vector3) -> Vector3:
    """``vector`` turned by the unit quaternion ``q``."""
    axis = Vector3(q.x, q.y, q.z)
    once = _scaled(_cross(axis, vector), 2.0)
    twice = _cross(axis, once)
    return Vector3(
        vector.x + q.w * once.x + twice.x,
        vector.y + q.w * once.y + twice.y,
        vector.z + q.w * once.z + twice.z,
    )


def _product(a: Rotation, b: Rotation) -> Rotation:
    return Rotation(
        a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
        a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
        a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w,
        a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z,
    )


def _conjugate(q: Rotation) -> Rotation:
    return Rotation(-q.x, -q.y, -q.z, q.w)


def _unit(q: Rotation) -> Rotation:
    """The quaternion of length one; a quaternion of zeros, as in an unset message, turns by nothing."""
    length = math.sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w)
    if length == 0:
        return Rotation(0.0, 0.0, 0.0, 1.0)
    return Rotation(q.x / length, q.y / length, q.z / length, q.w / length)


def _cross(a: Vector3, b: Vector3) -> Vector3:
    return Vector3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)


def _difference(a: Vector3, b: Vector3) -> Vector3:
    return Vector3(a.x - b.x, a.y - b.y, a.z - b.z)


def _scaled(vector: Vector3, factor: float) -> Vector3:
    return Vector3(vector.x * factor, vector.y * factor, vector.z * factor)


def _length(vector: Vector3) -> float:
    return math.sqrt(vector.x * vector.x + vector.y * vector.y + vector.z * vector.z)
