# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What is relayed in ``live_cost.py``."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any


@dataclass(frozen=True, kw_only=True)
class Topic:
    """A source with the rate that its relay aims at; an infinite one passes every message."""

    name: str
    type: str
    hz: float
    target_hz: float
    size_bytes: int

    def to_json(self) -> dict[str, Any]:
        """For ``roles.py``."""
        return dict(vars(self))


IMU_TYPE, IMU_BYTES = "sensor_msgs/msg/Imu", 324
IMAGE_TYPE, IMAGE_BYTES = "sensor_msgs/msg/Image", 6_220_860
# The TurtleBot3 of 'testudo demo', its sources on the left, its default rates on the right. PyPI has no
# tf2_msgs, and the stamp needs a header: so /tf is a TransformStamped and /cmd_vel a TwistStamped.
TURTLEBOT3 = [
    Topic(name="/cmd_vel", type="geometry_msgs/msg/TwistStamped", hz=10, target_hz=7, size_bytes=76),
    Topic(name="/odom", type="nav_msgs/msg/Odometry", hz=25.5, target_hz=10, size_bytes=724),
    Topic(name="/camera/camera_info", type="sensor_msgs/msg/CameraInfo", hz=29, target_hz=3, size_bytes=380),
    Topic(
        name="/camera/image_raw/compressed",
        type="sensor_msgs/msg/CompressedImage",
        hz=29,
        target_hz=3,
        size_bytes=60_000,
    ),
    Topic(name="/camera/image_raw", type=IMAGE_TYPE, hz=29, target_hz=3, size_bytes=IMAGE_BYTES),
    Topic(name="/imu", type=IMU_TYPE, hz=195, target_hz=10, size_bytes=IMU_BYTES),
    Topic(name="/joint_states", type="sensor_msgs/msg/JointState", hz=30, target_hz=3, size_bytes=150),
    Topic(name="/scan", type="sensor_msgs/msg/LaserScan", hz=5, target_hz=3, size_bytes=2_940),
    Topic(name="/tf", type="geometry_msgs/msg/TransformStamped", hz=30, target_hz=10, size_bytes=120),
]


def imu(hz: float, target_hz: float) -> list[Topic]:
    """One small topic."""
    return [Topic(name="/imu", type=IMU_TYPE, hz=hz, target_hz=target_hz, size_bytes=IMU_BYTES)]


def imus(count: int, hz: float, target_hz: float) -> list[Topic]:
    """Small topics of the same kind."""
    return [replace(one, name=f"/imu{number}") for number in range(count) for one in imu(hz, target_hz)]


def image(target_hz: float) -> list[Topic]:
    """One large topic."""
    return [Topic(name="/image", type=IMAGE_TYPE, hz=29, target_hz=target_hz, size_bytes=IMAGE_BYTES)]


CASES = {
    "nine TurtleBot3 topics": TURTLEBOT3,
    "eight, without the raw image": [topic for topic in TURTLEBOT3 if topic.type != IMAGE_TYPE],
    "Imu 200 → 50 Hz": imu(200, 50),
    "Imu 1000 → 100 Hz": imu(1000, 100),
    "Imu 5000 → 100 Hz": imu(5000, 100),
    "Imu 200 → Full": imu(200, math.inf),
    "6.22 MB images 29 → 3 Hz": image(3),
    "6.22 MB images 29 → Full": image(math.inf),
}
