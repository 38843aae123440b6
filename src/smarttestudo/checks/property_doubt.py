# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Properties that messages may not have."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from smarttestudo.checks import wording
from smarttestudo.checks.context import CheckContext
from smarttestudo.checks.lint_rule import Found
from smarttestudo.domain.finding import Fix, Span
from smarttestudo.domain.names import is_source
from smarttestudo.domain.signal import Signal
from smarttestudo.language.parser.cursor import closest, did_you_mean
from smarttestudo.language.properties import (
    ARRIVAL_PROPERTIES,
    PropertySpec,
    conventional_types,
    known_types,
    properties_of,
)
from smarttestudo.language.properties.field_path import MESSAGE_PREFIX, is_field_path

_PLAIN_NAME = re.compile(r"\w+\Z")
_FIRST_FIELD = re.compile(r"\w+")
_STANDARD = "Bool Byte Char Float32 Float64 Int8 Int16 Int32 Int64 String UInt8 UInt16 UInt32 UInt64"
_FIELDS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        name: tuple(fields.split())
        for name, fields in (
            ("nav_msgs/msg/Odometry", "header child_frame_id pose twist"),
            ("geometry_msgs/msg/Point", "x y z"),
            ("geometry_msgs/msg/PointStamped", "header point"),
            ("geometry_msgs/msg/PoseStamped", "header pose"),
            ("geometry_msgs/msg/PoseWithCovarianceStamped", "header pose"),
            ("geometry_msgs/msg/Twist", "linear angular"),
            ("geometry_msgs/msg/TwistStamped", "header twist"),
            ("geometry_msgs/msg/Vector3", "x y z"),
            ("geometry_msgs/msg/Wrench", "force torque"),
            ("geometry_msgs/msg/WrenchStamped", "header wrench"),
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
            (
                "sensor_msgs/msg/CameraInfo",
                "header height width distortion_model d k r p binning_x binning_y roi",
            ),
            ("sensor_msgs/msg/CompressedImage", "header format data"),
            ("sensor_msgs/msg/FluidPressure", "header fluid_pressure variance"),
            ("sensor_msgs/msg/Illuminance", "header illuminance variance"),
            ("sensor_msgs/msg/Image", "header height width encoding is_bigendian step data"),
            ("sensor_msgs/msg/JointState", "header name position velocity effort"),
            (
                "sensor_msgs/msg/NavSatFix",
                "header status latitude longitude altitude position_covariance position_covariance_type",
            ),
            (
                "sensor_msgs/msg/Range",
                "header radiation_type field_of_view min_range max_range range variance",
            ),
            ("sensor_msgs/msg/RelativeHumidity", "header relative_humidity variance"),
            ("sensor_msgs/msg/Temperature", "header temperature variance"),
            *((f"std_msgs/msg/{name}", "data") for name in _STANDARD.split()),
            ("tf2_msgs/msg/TFMessage", "transforms"),
            ("turtlesim/msg/Pose", "x y theta linear_velocity angular_velocity"),
        )
    }
)
_TEXTS = frozenset(
    {
        ("sensor_msgs/msg/BatteryState", "location"),
        ("sensor_msgs/msg/BatteryState", "serial_number"),
        ("sensor_msgs/msg/CameraInfo", "distortion_model"),
        ("sensor_msgs/msg/CompressedImage", "format"),
        ("sensor_msgs/msg/Image", "encoding"),
        ("std_msgs/msg/String", "data"),
    }
)
_NAMES_OF_FRAMES = ("frame_id", "child_frame_id")
_ALL_FIELDS = tuple(sorted({field for fields in _FIELDS.values() for field in fields}))
_PROPERTIES_OF_ANY_TYPE = tuple(
    dict.fromkeys(name for type_name in known_types() for name in properties_of(type_name))
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Doubt:
    """Why a property is not there; ``close`` is one that may be meant."""

    message: str
    hint: str
    close: str | None


Named = Callable[[str], Mapping[str, PropertySpec]]
"""The named properties of a type."""


def doubt_about(signal: Signal, context: CheckContext, named: Named = properties_of) -> Doubt | None:
    """Why messages of the topic may not have that property, where they may not."""
    topic, name = signal.topic, signal.property
    if is_source(topic):
        # Behind a blank is a constant that nobody knows.
        return _not_in_vitals(topic, name.partition(" ")[0])
    if not is_field_path(name):
        return Doubt(
            message=f"no message has a property or field {name}",
            hint="fields are called by letters a to z, digits and '_', and start with a letter",
            close=None,
        )
    type_name = context.known_type(topic)
    types = (type_name,) if type_name else conventional_types(topic)
    if name in ARRIVAL_PROPERTIES or any(_may_have(candidate, name, named) for candidate in types):
        return None
    if type_name:
        return _not_in_type(f"{type_name}, the type of {topic},", name, named(type_name), type_name)
    if name.startswith(MESSAGE_PREFIX):
        return None  # Who writes that knows the type.
    if types:
        other = f"; if it is of another type, {context.way_to_profile}"
        return _not_in_type(
            f"{topic} is usually {' or '.join(types)}, which", name, named(types[0]), types[0], other
        )
    if not _PLAIN_NAME.match(name) or name in _PROPERTIES_OF_ANY_TYPE or name in _ALL_FIELDS:
        return None
    common = (*_PROPERTIES_OF_ANY_TYPE, *ARRIVAL_PROPERTIES)
    close = closest(name, common) or closest(name, _ALL_FIELDS)
    remedy = f"if it is a field of {topic}, write msg.{name} or {context.way_to_profile}"
    return Doubt(
        message=f"no common type has a property or field {name}, and the type of {topic} is not known",
        hint=f"{did_you_mean(close)} {remedy}" if close else remedy,
        close=close,
    )


def _not_in_vitals(source: str, name: str) -> Doubt | None:
    names = tuple(properties_of(source))
    if name in names:
        return None
    close = closest(name, names)
    return Doubt(
        message=f"{source} has no property {name}",
        hint=did_you_mean(close) if close else f"it has {wording.listed(names)}",
        close=close,
    )


def is_text(type_name: str | None, name: str) -> bool:
    """Whether a field of a common type is known to be a text."""
    path = name.removeprefix(MESSAGE_PREFIX)
    return (type_name, path) in _TEXTS or path.rpartition(".")[2] in _NAMES_OF_FRAMES


def _may_have(type_name: str, name: str, named: Named) -> bool:
    fields = _FIELDS.get(type_name)
    if fields is None or name in named(type_name):
        return True
    first = _FIRST_FIELD.match(name.removeprefix(MESSAGE_PREFIX))
    return first is not None and first.group() in fields


def _not_in_type(
    beginning: str, name: str, properties: Iterable[str], type_name: str, other: str = ""
) -> Doubt:
    names = tuple(properties) or _FIELDS.get(type_name) or ()
    close = closest(name, (*names, *ARRIVAL_PROPERTIES))
    return Doubt(
        message=f"{beginning} has no property or field {name}",
        hint=did_you_mean(close) if close else f"it has {wording.listed(names)}{other}",
        close=close,
    )


def found_in(path: str, span: Span, doubt: Doubt) -> Found:
    """The finding on a property written at ``span``."""
    close = doubt.close
    return Found(
        path=path,
        span=span,
        message=doubt.message,
        hint=doubt.hint,
        fix=Fix(span=span, replacement=close, title=f"write '{close}'") if close else None,
    )
