# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The TurtleBot3 Waffle Pi: dimensions, limits and frames.

Source: ROBOTIS e-Manual (specification) and ``turtlebot3_waffle_pi.urdf`` of ``turtlebot3_description``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from smarttestudo.simulation.geometry import FrameTransform, Quaternion, Vector

ODOM_FRAME = "odom"
BASE_FRAME = "base_footprint"
BASE_LINK = "base_link"
SCAN_FRAME = "base_scan"
IMU_FRAME = "imu_link"
CAMERA_FRAME = "camera_rgb_frame"
OPTICAL_FRAME = "camera_rgb_optical_frame"
WHEEL_LINKS = ("wheel_left_link", "wheel_right_link")
WHEEL_JOINTS = ("wheel_left_joint", "wheel_right_joint")

_QUARTER_TURN = math.pi / 2
_LEVEL = Quaternion(0.0, 0.0, 0.0, 1.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotModel:
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


def fixed_frames(model: RobotModel) -> tuple[FrameTransform, ...]:
    """The frames that never move against their parent."""
    optical = Quaternion.from_yaw(-_QUARTER_TURN).then(Quaternion.from_roll(-_QUARTER_TURN))
    return (
        FrameTransform(BASE_FRAME, BASE_LINK, Vector(0.0, 0.0, 0.010), _LEVEL),
        FrameTransform(BASE_LINK, SCAN_FRAME, Vector(model.scan_x_m, 0.0, 0.122), _LEVEL),
        FrameTransform(BASE_LINK, IMU_FRAME, Vector(0.0, 0.0, 0.068), _LEVEL),
        FrameTransform(BASE_LINK, "camera_link", Vector(0.073, -0.011, 0.084), _LEVEL),
        FrameTransform("camera_link", CAMERA_FRAME, Vector(0.003, 0.011, 0.009), _LEVEL),
        FrameTransform(CAMERA_FRAME, OPTICAL_FRAME, Vector(0.0, 0.0, 0.0), optical),
    )


def wheel_frames(model: RobotModel, angles_rad: tuple[float, float]) -> tuple[FrameTransform, ...]:
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
