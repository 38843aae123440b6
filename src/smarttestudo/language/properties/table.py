# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The properties of each type, and how to read them."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any

from smarttestudo.domain.profile import LevelUnit
from smarttestudo.language.properties import motion, sensors
from smarttestudo.language.properties.field_path import PropertySpec, Reader, field_reader, number

_ODOMETRY = "nav_msgs/msg/Odometry"
_POSE_STAMPED = "geometry_msgs/msg/PoseStamped"
_POSE_WITH_COVARIANCE_STAMPED = "geometry_msgs/msg/PoseWithCovarianceStamped"
_TWIST = "geometry_msgs/msg/Twist"
_TWIST_STAMPED = "geometry_msgs/msg/TwistStamped"
_SCAN = "sensor_msgs/msg/LaserScan"
_BATTERY = "sensor_msgs/msg/BatteryState"
_IMU = "sensor_msgs/msg/Imu"
_JOINTS = "sensor_msgs/msg/JointState"

_Entry = tuple[PropertySpec, Callable[[LevelUnit | None], Reader]]


def _entry(
    name: str,
    unit: str,
    meaning: str,
    read: Callable[[Any], float],
    *,
    minimum: float | None = None,
    maximum: float | None = None,
) -> _Entry:
    spec = PropertySpec(name=name, unit=unit, meaning=meaning, minimum=minimum, maximum=maximum)
    return spec, lambda _unit: _guarded(read)


def _angle(name: str, meaning: str, read: Callable[[Any], float]) -> _Entry:
    spec = PropertySpec(
        name=name, unit="°", meaning=meaning, minimum=-180.0, maximum=180.0, includes_minimum=False
    )
    return spec, lambda _unit: _guarded(read)


def _guarded(read: Callable[[Any], float]) -> Reader:
    """A message of a type that is only called as one of ROS 2 holds no such value: that is unknown."""

    def reader(message: object) -> float:
        try:
            return number(read(message))
        except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError):
            return math.nan

    return reader


def _twist_entries(twist: Callable[[Any], Any]) -> tuple[_Entry, ...]:
    return (
        _entry("vel", "m/s", "signed forward velocity (linear.x)", lambda m: twist(m).linear.x),
        _entry(
            "speed",
            "m/s",
            "length of the linear velocity",
            lambda m: motion.length(twist(m).linear),
            minimum=0.0,
        ),
        _entry("yaw_rate", "rad/s", "signed turning rate (angular.z)", lambda m: twist(m).angular.z),
    )


def _pose_entries(pose: Callable[[Any], Any]) -> tuple[_Entry, ...]:
    return (
        _entry("pose_x", "m", "position along x", lambda m: pose(m).position.x),
        _entry("pose_y", "m", "position along y", lambda m: pose(m).position.y),
        _entry("pose_z", "m", "position along z", lambda m: pose(m).position.z),
        _angle("yaw", "heading", lambda m: motion.yaw_degrees(pose(m).orientation)),
    )


_LEVEL: _Entry = (
    PropertySpec(name="level", unit="%", meaning="charge left", minimum=0.0, maximum=100.0),
    lambda unit: _guarded(sensors.BatteryLevel(unit)),
)

_TABLE: Mapping[str, tuple[_Entry, ...]] = MappingProxyType(
    {
        _ODOMETRY: (
            *_pose_entries(lambda m: m.pose.pose),
            *_twist_entries(lambda m: m.twist.twist),
        ),
        _POSE_STAMPED: _pose_entries(lambda m: m.pose),
        _POSE_WITH_COVARIANCE_STAMPED: _pose_entries(lambda m: m.pose.pose),
        _TWIST: _twist_entries(lambda m: m),
        _TWIST_STAMPED: _twist_entries(lambda m: m.twist),
        _SCAN: (_entry("distance", "m", "smallest range in sight", sensors.nearest_distance_m, minimum=0.0),),
        _BATTERY: (_LEVEL,),
        _IMU: (
            _angle("roll", "rotation about x", lambda m: motion.roll_degrees(m.orientation)),
            _entry(
                "pitch",
                "°",
                "rotation about y",
                lambda m: motion.pitch_degrees(m.orientation),
                minimum=-90.0,
                maximum=90.0,
            ),
            _angle("yaw", "rotation about z", lambda m: motion.yaw_degrees(m.orientation)),
            _entry(
                "acceleration",
                "m/s²",
                "length of the linear acceleration",
                lambda m: motion.length(m.linear_acceleration),
                minimum=0.0,
            ),
            _entry(
                "angular_speed",
                "rad/s",
                "length of the angular velocity",
                lambda m: motion.length(m.angular_velocity),
                minimum=0.0,
            ),
        ),
        _JOINTS: (
            _entry(
                "max_velocity",
                "rad/s",
                "greatest joint velocity, either way",
                motion.greatest_magnitude("velocity"),
                minimum=0.0,
            ),
            _entry(
                "max_effort",
                "N m",
                "greatest joint effort, either way",
                motion.greatest_magnitude("effort"),
                minimum=0.0,
            ),
        ),
    }
)

_FIELD_OF = MappingProxyType(
    {
        "level": "percentage",
        **dict.fromkeys(("roll", "pitch", "yaw"), "orientation"),
        "acceleration": "linear_acceleration",
        "angular_speed": "angular_velocity",
    }
)
"""The field that says whether a property is known, where its type has a habit for that."""

ARRIVAL_PROPERTIES: Mapping[str, PropertySpec] = MappingProxyType(
    {
        "rate": PropertySpec(
            name="rate", unit="Hz", meaning="arrivals of the last 2 s, by second", minimum=0.0
        ),
        "bandwidth": PropertySpec(
            name="bandwidth", unit="KB/s", meaning="bytes of the last 2 s, by second", minimum=0.0
        ),
        "age": PropertySpec(
            name="age", unit="s", meaning="time since the last message, or since the start", minimum=0.0
        ),
    }
)
"""Properties of every topic; they need nothing decoded and are never unknown."""


def known_types() -> tuple[str, ...]:
    """The types that have named properties."""
    return tuple(_TABLE)


def properties_of(type_name: str) -> Mapping[str, PropertySpec]:
    """The named properties of ``type_name``, without those of every topic."""
    return {spec.name: spec for spec, _ in _TABLE.get(type_name, ())}


def property_spec(type_name: str | None, name: str) -> PropertySpec | None:
    """The description of property ``name``; with the type unknown, whatever all types agree on."""
    if name in ARRIVAL_PROPERTIES:
        return ARRIVAL_PROPERTIES[name]
    if type_name is not None:
        return properties_of(type_name).get(name)
    found = [table[name] for table in map(properties_of, _TABLE) if name in table]
    ranges = {(spec.minimum, spec.maximum) for spec in found}
    return found[0] if len(ranges) == 1 else None


def value_reader(type_name: str, name: str, level_unit: LevelUnit | None = None) -> Reader:
    """Read property ``name`` of messages of ``type_name``, or the field path ``name``.

    A reader belongs to one topic: that of a battery's level remembers the unit it saw.
    """
    for spec, make_reader in _TABLE.get(type_name, ()):
        if spec.name == name:
            return sensors.known_only(type_name, _FIELD_OF.get(name, name), make_reader(level_unit))
    return sensors.known_only(type_name, name, field_reader(name))
