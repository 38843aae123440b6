# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Serialized messages as another implementation of ROS 2 writes them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from rosbags.typesys import Stores, get_typestore

from smarttestudo.pacing.reckoning.motion import Rotation, SpatialPose, Twist, Vector3

STORE = get_typestore(Stores.ROS2_JAZZY)
ODOMETRY = "nav_msgs/msg/Odometry"
POSE_STAMPED = "geometry_msgs/msg/PoseStamped"
POSE_WITH_COVARIANCE_STAMPED = "geometry_msgs/msg/PoseWithCovarianceStamped"
TRANSFORMS = "tf2_msgs/msg/TFMessage"
JOINTS = "sensor_msgs/msg/JointState"
NO_TWIST = Twist(Vector3(0, 0, 0), Vector3(0, 0, 0))


def serialized(type_name: str, message: object) -> bytes:
    return bytes(STORE.serialize_cdr(message, type_name))


def planar(x: float, y: float, yaw: float) -> SpatialPose:
    return SpatialPose(Vector3(x, y, 0.0), Rotation(0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2)))


def odometry(
    stamp_ns: int, pose: SpatialPose, twist: Twist = NO_TWIST, frames: tuple[str, str] = ("odom", "base")
) -> bytes:
    types = STORE.types
    covariance = np.zeros(36)
    message = types[ODOMETRY](
        _header(stamp_ns, frames[0]),
        frames[1],
        types["geometry_msgs/msg/PoseWithCovariance"](_pose(pose), covariance),
        types["geometry_msgs/msg/TwistWithCovariance"](
            types["geometry_msgs/msg/Twist"](_vector(twist.linear), _vector(twist.angular)), covariance
        ),
    )
    return serialized(ODOMETRY, message)


def pose_stamped(stamp_ns: int, pose: SpatialPose) -> bytes:
    return serialized(POSE_STAMPED, STORE.types[POSE_STAMPED](_header(stamp_ns, "map"), _pose(pose)))


def pose_with_covariance_stamped(stamp_ns: int, pose: SpatialPose) -> bytes:
    with_covariance = STORE.types["geometry_msgs/msg/PoseWithCovariance"](_pose(pose), np.zeros(36))
    message = STORE.types[POSE_WITH_COVARIANCE_STAMPED](_header(stamp_ns, "map"), with_covariance)
    return serialized(POSE_WITH_COVARIANCE_STAMPED, message)


def transforms(stamp_ns: int, poses: Mapping[str, SpatialPose], parent: str = "odom") -> bytes:
    types = STORE.types
    stamped = [
        types["geometry_msgs/msg/TransformStamped"](
            _header(stamp_ns, parent),
            child,
            types["geometry_msgs/msg/Transform"](
                _vector(pose.position), types["geometry_msgs/msg/Quaternion"](*map(float, pose.orientation))
            ),
        )
        for child, pose in poses.items()
    ]
    return serialized(TRANSFORMS, types[TRANSFORMS](stamped))


def joints(
    stamp_ns: int, positions: Mapping[str, float], velocities: Sequence[float] = (), frame: str = ""
) -> bytes:
    message = STORE.types[JOINTS](
        _header(stamp_ns, frame),
        [*positions],
        np.array([*positions.values()], dtype=np.float64),
        np.array(velocities, dtype=np.float64),
        np.array([], dtype=np.float64),
    )
    return serialized(JOINTS, message)


def _header(stamp_ns: int, frame: str) -> Any:
    stamp = STORE.types["builtin_interfaces/msg/Time"](stamp_ns // 10**9, stamp_ns % 10**9)
    return STORE.types["std_msgs/msg/Header"](stamp, frame)


def _vector(vector: Vector3) -> Any:
    return STORE.types["geometry_msgs/msg/Vector3"](*map(float, vector))


def _pose(pose: SpatialPose) -> Any:
    types = STORE.types
    return types["geometry_msgs/msg/Pose"](
        types["geometry_msgs/msg/Point"](*map(float, pose.position)),
        types["geometry_msgs/msg/Quaternion"](*map(float, pose.orientation)),
    )
