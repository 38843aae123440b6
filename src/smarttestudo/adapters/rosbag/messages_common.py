# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The parts that most ROS messages share."""

from __future__ import annotations

from rosbags.typesys.stores.ros2_humble import builtin_interfaces__msg__Time as TimeMessage
from rosbags.typesys.stores.ros2_humble import geometry_msgs__msg__Quaternion as QuaternionMessage
from rosbags.typesys.stores.ros2_humble import geometry_msgs__msg__Vector3 as VectorMessage
from rosbags.typesys.stores.ros2_humble import std_msgs__msg__Header as HeaderMessage

from smarttestudo.domain.units import NS_PER_S
from smarttestudo.simulation.geometry import Quaternion, Vector


def header(stamp_ns: int, frame_id: str) -> HeaderMessage:
    """A header with the time of measurement."""
    sec, nanosec = divmod(stamp_ns, NS_PER_S)
    return HeaderMessage(stamp=TimeMessage(sec=sec, nanosec=nanosec), frame_id=frame_id)


def vector(value: Vector) -> VectorMessage:
    """A Vector3."""
    return VectorMessage(x=value.x, y=value.y, z=value.z)


def quaternion(value: Quaternion) -> QuaternionMessage:
    """A Quaternion."""
    return QuaternionMessage(x=value.x, y=value.y, z=value.z, w=value.w)
