# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Poses, vectors and rotations, in metres and radians, axes as in REP 103."""

from __future__ import annotations

import math
from dataclasses import dataclass

from smarttestudo.domain.floor_plan import Point


@dataclass(frozen=True, slots=True)
class Pose:
    """A place on the floor and a heading counted anticlockwise from the x axis, not wrapped."""

    x_m: float
    y_m: float
    yaw_rad: float

    def ahead(self, forward_m: float) -> Point:
        """The place ``forward_m`` metres in front of this pose (behind it where negative)."""
        return Point(
            self.x_m + forward_m * math.cos(self.yaw_rad), self.y_m + forward_m * math.sin(self.yaw_rad)
        )


@dataclass(frozen=True, slots=True)
class BodyVelocity:
    """How a ground robot moves: forwards in m/s, anticlockwise in rad/s."""

    linear_m_per_s: float
    angular_rad_per_s: float


@dataclass(frozen=True, slots=True)
class Vector:
    """Three components along x, y and z."""

    x: float
    y: float
    z: float


@dataclass(frozen=True, slots=True)
class Quaternion:
    """A rotation, as a unit quaternion."""

    x: float
    y: float
    z: float
    w: float

    @staticmethod
    def from_yaw(yaw_rad: float) -> Quaternion:
        """The rotation by ``yaw_rad`` about z."""
        return Quaternion(0.0, 0.0, math.sin(yaw_rad / 2), math.cos(yaw_rad / 2))

    @staticmethod
    def from_roll(roll_rad: float) -> Quaternion:
        """The rotation by ``roll_rad`` about x."""
        return Quaternion(math.sin(roll_rad / 2), 0.0, 0.0, math.cos(roll_rad / 2))

    def then(self, other: Quaternion) -> Quaternion:
        """This rotation followed by ``other`` about the turned axes (the Hamilton product)."""
        return Quaternion(
            self.w * other.x + self.x * other.w + self.y * other.z - self.z * other.y,
            self.w * other.y - self.x * other.z + self.y * other.w + self.z * other.x,
            self.w * other.z + self.x * other.y - self.y * other.x + self.z * other.w,
            self.w * other.w - self.x * other.x - self.y * other.y - self.z * other.z,
        )


@dataclass(frozen=True, slots=True)
class FrameTransform:
    """Where the frame ``child`` lies in the frame ``parent``; the translation is in metres."""

    parent: str
    child: str
    translation: Vector
    rotation: Quaternion
