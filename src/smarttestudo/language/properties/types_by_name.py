# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Types that topics may be expected to have by their names."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

_CONVENTIONAL_TYPES: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "_action/status": ("action_msgs/msg/GoalStatusArray",),
        "amcl_pose": ("geometry_msgs/msg/PoseWithCovarianceStamped",),
        "battery_state": ("sensor_msgs/msg/BatteryState",),
        "camera_info": ("sensor_msgs/msg/CameraInfo",),
        "cmd_vel": ("geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped"),
        "diagnostics": ("diagnostic_msgs/msg/DiagnosticArray",),
        "diagnostics_agg": ("diagnostic_msgs/msg/DiagnosticArray",),
        "fix": ("sensor_msgs/msg/NavSatFix",),
        "goal_pose": ("geometry_msgs/msg/PoseStamped",),
        "image_raw": ("sensor_msgs/msg/Image",),
        "image_raw/compressed": ("sensor_msgs/msg/CompressedImage",),
        "imu": ("sensor_msgs/msg/Imu",),
        "imu/data": ("sensor_msgs/msg/Imu",),
        "imu/data_raw": ("sensor_msgs/msg/Imu",),
        "initialpose": ("geometry_msgs/msg/PoseWithCovarianceStamped",),
        "joint_states": ("sensor_msgs/msg/JointState",),
        "odom": ("nav_msgs/msg/Odometry",),
        "odometry/filtered": ("nav_msgs/msg/Odometry",),
        "rosout": ("rcl_interfaces/msg/Log",),
        "scan": ("sensor_msgs/msg/LaserScan",),
        "tf": ("tf2_msgs/msg/TFMessage",),
        "tf_static": ("tf2_msgs/msg/TFMessage",),
        "transition_event": ("lifecycle_msgs/msg/TransitionEvent",),
    }
)
"""By the end of the name; the likeliest type first."""
_MOST_PARTS = max(name.count("/") + 1 for name in _CONVENTIONAL_TYPES)


def conventional_types(topic: str) -> tuple[str, ...]:
    """The types that ``topic`` may be expected to have by its name, in whatever namespace; a guess."""
    parts = topic.split("/")
    ends = ("/".join(parts[-count:]) for count in range(_MOST_PARTS, 0, -1))
    return next((_CONVENTIONAL_TYPES[end] for end in ends if end in _CONVENTIONAL_TYPES), ())
