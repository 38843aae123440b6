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

    @property
    def place(self) -> Point:
        return Point(self.x_m, self.y_m)

    def ahead(self, forward_m: float) -> Point:
        """The place ``forward_m`` metres in front of this pose (behind it where negative)."""
        return Point(
            self.x_m + forward_m * math.cos(self.yaw_rad), self.y_m + forward_m * math.sin(self.yaw_rad)
        )


def bearing_rad(start: Point, end: Point) -> float:
    """The direction from ``start`` to ``end``, anticlockwise from the x axis."""
    return math.atan2(end.y_m - start.y_m, end.x_m - start.x_m)


def clamped(value: float, limit: float) -> float:
    """The nearest number that is at most ``limit`` away from 0."""
    return min(max(value, -limit), limit)


@dataclass(frozen=True, slots=True)
class BodyVelocity:
    """How a robot moves: forwards in m/s, anticlockwise in rad/s; only one that flies also left and up."""

    linear_m_per_s: float
    angular_rad_per_s: float
    lateral_m_per_s: float = 0.0
    climb_m_per_s: float = 0.0


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
    def from_roll_pitch_yaw(roll_rad: float, pitch_rad: float, yaw_rad: float) -> Quaternion:
        """The rotation by ``yaw_rad`` about z, then about the turned y, then about the turned x."""
        pitched = Quaternion(0.0, math.sin(pitch_rad / 2), 0.0, math.cos(pitch_rad / 2))
        return Quaternion.from_yaw(yaw_rad).then(pitched).then(Quaternion.from_roll(roll_rad))

    @staticmethod
    def from_roll(roll_rad: float) -> Quaternion:
        """The rotation by ``roll_rad`` about x."""
        return Quaternion(math.sin(roll_rad / 2), 0.0, 0.0, math.cos(roll_rad / 2))

    @property
    def roll_pitch_yaw_rad(self) -> tuple[float, float, float]:
        """The rotation as turns about x, then the turned y, then the turned z (REP 103), within ±π."""
        x, y, z, w = self.x, self.y, self.z, self.w
        roll = math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))
        pitch = math.asin(min(max(2 * (w * y - z * x), -1.0), 1.0))
        return roll, pitch, math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))

    @property
    def yaw_rad(self) -> float:
        """The heading, within ±π."""
        return self.roll_pitch_yaw_rad[2]

    def then(self, other: Quaternion) -> Quaternion:
        """This rotation followed by ``other`` about the turned axes (the Hamilton product)."""
        return Quaternion(
            self.w * other.x + self.x * other.w + self.y * other.z - self.z * other.y,
            self.w * other.y - self.x * other.z + self.y * other.w + self.z * other.x,
            self.w * other.z + self.x * other.y - self.y * other.x + self.z * other.w,
            self.w * other.w - self.x * other.x - self.y * other.y - self.z * other.z,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Lens:
    """A pinhole camera of ``width`` × ``height`` pixels, read out in blocks of ``binning`` × ``binning``.

    ``focal_px`` counts in pixels of the whole sensor.
    """

    width: int
    height: int
    focal_px: float
    binning: int

    @property
    def image_size(self) -> tuple[int, int]:
        """Width and height of the images, in pixels."""
        return self.width // self.binning, self.height // self.binning


@dataclass(frozen=True, slots=True)
class FrameTransform:
    """Where the frame ``child`` lies in the frame ``parent``; the translation is in metres."""

    parent: str
    child: str
    translation: Vector
    rotation: Quaternion
