# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The fields of the message types that have named properties."""

from __future__ import annotations

import re
from collections.abc import Mapping
from types import MappingProxyType

from smarttestudo.adirf.properties.field_path import MESSAGE_PREFIX

_FIRST_FIELD = re.compile(r"[A-Za-z0-9_]+")

_FIELDS: Mapping[str, frozenset[str]] = MappingProxyType(
    {
        name: frozenset(fields.split())
        for name, fields in (
            ("nav_msgs/msg/Odometry", "header child_frame_id pose twist"),
            ("geometry_msgs/msg/Twist", "linear angular"),
            ("geometry_msgs/msg/TwistStamped", "header twist"),
            (
                "sensor_msgs/msg/LaserScan",
                "header angle_min angle_max angle_increment time_increment scan_time range_min range_max "
                "ranges intensities",
            ),
            (
                "sensor_msgs/msg/BatteryState",
                "header voltage temperature current charge capacity design_capacity percentage "
                "power_supply_status power_supply_health power_supply_technology present cell_voltage "
                "cell_temperature location serial_number",
            ),
            (
                "sensor_msgs/msg/Imu",
                "header orientation orientation_covariance angular_velocity angular_velocity_covariance "
                "linear_acceleration linear_acceleration_covariance",
            ),
            ("sensor_msgs/msg/JointState", "header name position velocity effort"),
        )
    }
)


def has_field(type_name: str, path: str) -> bool:
    """Whether the first field of ``path`` is one of ``type_name``; true for types that are not listed."""
    fields = _FIELDS.get(type_name)
    first = _FIRST_FIELD.match(path.removeprefix(MESSAGE_PREFIX))
    return fields is None or (first is not None and first.group() in fields)
