# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The simulated TurtleBot3 and its drive."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol, TypeVar

from smarttestudo.domain.units import NS_PER_S
from smarttestudo.simulation.geometry import BodyVelocity, FrameTransform, Pose, Quaternion, Vector, clamped

MAP_FRAME = "map"
ODOM_FRAME = "odom"
BASE_FRAME = "base_footprint"
BASE_LINK = "base_link"
SCAN_FRAME = "base_scan"
IMU_FRAME = "imu_link"
CAMERA_FRAME = "camera_rgb_frame"
RANGE_FRAME = "range_link"
OPTICAL_FRAME = "camera_rgb_optical_frame"
WHEEL_LINKS = ("wheel_left_link", "wheel_right_link")
WHEEL_JOINTS = ("wheel_left_joint", "wheel_right_joint")

_QUARTER_TURN = math.pi / 2
_LEVEL = Quaternion(0.0, 0.0, 0.0, 1.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class DriveModel:
    """A differential-drive robot.

    ``radius_m`` is that of the circle around its footprint, ``scan_x_m`` and ``camera_x_m`` are how far in
    front of the axle its LiDAR and camera sit, ``camera_height_m`` is above the floor.
    """

    wheel_radius_m: float = 0.033
    wheel_separation_m: float = 0.287
    wheel_acceleration_m_per_s2: float = 1.0
    max_linear_m_per_s: float = 0.26
    max_angular_rad_per_s: float = 1.82
    radius_m: float = 0.22
    scan_x_m: float = -0.064
    camera_x_m: float = 0.076
    camera_height_m: float = 0.103


def fixed_frames(model: DriveModel) -> tuple[FrameTransform, ...]:
    """The frames that never move against their parent."""
    return (
        FrameTransform(BASE_FRAME, BASE_LINK, Vector(0.0, 0.0, 0.010), _LEVEL),
        FrameTransform(BASE_LINK, SCAN_FRAME, Vector(model.scan_x_m, 0.0, 0.122), _LEVEL),
        FrameTransform(BASE_LINK, IMU_FRAME, Vector(0.0, 0.0, 0.068), _LEVEL),
        FrameTransform(BASE_LINK, "camera_link", Vector(0.073, -0.011, 0.084), _LEVEL),
        FrameTransform("camera_link", CAMERA_FRAME, Vector(0.003, 0.011, 0.009), _LEVEL),
        FrameTransform(CAMERA_FRAME, OPTICAL_FRAME, Vector(0.0, 0.0, 0.0), optical_rotation()),
    )


def optical_rotation() -> Quaternion:
    """From a camera that looks along x to one that looks along z (REP 103)."""
    return Quaternion.from_yaw(-_QUARTER_TURN).then(Quaternion.from_roll(-_QUARTER_TURN))


def wheel_frames(model: DriveModel, angles_rad: tuple[float, float]) -> tuple[FrameTransform, ...]:
    """The two wheels, left first, each turned by its angle about its axle."""
    upright = Quaternion.from_roll(-_QUARTER_TURN)
    return tuple(
        FrameTransform(
            BASE_LINK,
            link,
            Vector(0.0, side * model.wheel_separation_m / 2, 0.023),
            upright.then(Quaternion.from_yaw(angle_rad)),
        )
        for link, side, angle_rad in zip(WHEEL_LINKS, (1, -1), angles_rad, strict=True)
    )


class Body(Protocol):
    """A robot's body, which moves as time goes on."""

    now_ns: int

    @property
    def pose(self) -> Pose:
        """The true pose on the floor."""

    def command(self, velocity: BodyVelocity) -> None:
        """Make for ``velocity`` from now on."""

    def advance_to(self, now_ns: int) -> None:
        """Move on to ``now_ns``."""

    def skip(self, lost_ns: int) -> None:
        """Let ``lost_ns`` pass in which nothing moves."""


BodyT = TypeVar("BodyT", bound=Body)

_MAX_STEP_NS = 5_000_000


class DifferentialDrive:
    """The true motion of the robot: two wheels that follow a command within their acceleration.

    ``rim_m_per_s`` and ``rim_m_per_s2`` are the speeds and accelerations at the rims of the left and the
    right wheel, ``angles_rad`` how far they have turned.
    """

    __slots__ = ("_target", "angles_rad", "model", "now_ns", "pose", "rim_m_per_s", "rim_m_per_s2")

    def __init__(self, model: DriveModel, *, pose: Pose, now_ns: int) -> None:
        self.model = model
        self.pose = pose
        self.now_ns = now_ns
        self.rim_m_per_s = (0.0, 0.0)
        self.rim_m_per_s2 = (0.0, 0.0)
        self.angles_rad = (0.0, 0.0)
        self._target = (0.0, 0.0)

    @property
    def velocity(self) -> BodyVelocity:
        left, right = self.rim_m_per_s
        return BodyVelocity((left + right) / 2, (right - left) / self.model.wheel_separation_m)

    @property
    def forward_m_per_s2(self) -> float:
        return sum(self.rim_m_per_s2) / 2

    def command(self, velocity: BodyVelocity) -> None:
        half_turn = velocity.angular_rad_per_s * self.model.wheel_separation_m / 2
        self._target = (velocity.linear_m_per_s - half_turn, velocity.linear_m_per_s + half_turn)

    def advance_to(self, now_ns: int) -> None:
        """Move on to ``now_ns`` in steps of at most 5 ms."""
        while self.now_ns < now_ns:
            step_ns = min(now_ns - self.now_ns, _MAX_STEP_NS)
            self._step(step_ns / NS_PER_S)
            self.now_ns += step_ns

    def skip(self, lost_ns: int) -> None:
        self.now_ns += lost_ns

    def _step(self, dt_s: float) -> None:
        """Second-order Runge-Kutta: the mean speeds of the step along its middle heading."""
        limit = self.model.wheel_acceleration_m_per_s2 * dt_s
        speeds = self.rim_m_per_s
        changes = [clamped(target - speed, limit) for target, speed in zip(self._target, speeds, strict=True)]
        left_m, right_m = ((speed + change / 2) * dt_s for speed, change in zip(speeds, changes, strict=True))
        self.pose = rolled(self.pose, left_m, right_m, self.model.wheel_separation_m)
        radius_m = self.model.wheel_radius_m
        self.angles_rad = (self.angles_rad[0] + left_m / radius_m, self.angles_rad[1] + right_m / radius_m)
        self.rim_m_per_s = (speeds[0] + changes[0], speeds[1] + changes[1])
        self.rim_m_per_s2 = (changes[0] / dt_s, changes[1] / dt_s)


def rolled(pose: Pose, left_m: float, right_m: float, separation_m: float) -> Pose:
    """Where two wheels bring a robot that roll so far, along its middle heading."""
    turn_rad = (right_m - left_m) / separation_m
    middle = Pose(pose.x_m, pose.y_m, pose.yaw_rad + turn_rad / 2).ahead((left_m + right_m) / 2)
    return Pose(middle.x_m, middle.y_m, pose.yaw_rad + turn_rad)
