# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The properties that a KeepWithin can name, and how far two values of one are apart."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from operator import itemgetter
from types import MappingProxyType
from typing import Any, NamedTuple

from smarttestudo.domain.profile import LevelUnit
from smarttestudo.language.properties.field_path import MESSAGE_PREFIX, MOST, PropertySpec, part_reader
from smarttestudo.language.properties.readers import known_only
from smarttestudo.language.properties.table import properties_of, value_reader
from smarttestudo.pacing.reckoning.gauges import (
    PLACE_DISTANCE,
    Distance,
    FieldGauge,
    FixGauge,
    FrameGauge,
    Gauge,
    JointGauge,
    PoseGauge,
    PoseState,
)
from smarttestudo.pacing.reckoning.motion import (
    SpatialPose,
    orientation_distance_degrees,
    position_distance_m,
)

FULL_TURN = 360.0

_ODOMETRY = "nav_msgs/msg/Odometry"
_POSE_STAMPED = "geometry_msgs/msg/PoseStamped"
_POSE_WITH_COVARIANCE_STAMPED = "geometry_msgs/msg/PoseWithCovarianceStamped"
_TRANSFORMS = "tf2_msgs/msg/TFMessage"
_JOINTS = "sensor_msgs/msg/JointState"
_FIX = "sensor_msgs/msg/NavSatFix"

_POSE = (
    PropertySpec(name="position", unit="m", meaning="length of the difference of the positions", minimum=0.0),
    PropertySpec(
        name="orientation",
        unit="°",
        meaning="angle of the rotation between the orientations",
        minimum=0.0,
        maximum=180.0,
    ),
)
_SPECS: Mapping[str, tuple[PropertySpec, ...]] = MappingProxyType(
    {
        _ODOMETRY: _POSE,
        _POSE_STAMPED: _POSE,
        _POSE_WITH_COVARIANCE_STAMPED: _POSE,
        _TRANSFORMS: _POSE,
        _FIX: (
            PropertySpec(
                name="position",
                unit="m",
                meaning="length of the way between the places, of degrees in metres of WGS 84",
                minimum=0.0,
            ),
        ),
        _JOINTS: (
            PropertySpec(
                name="positions", unit="rad", meaning="largest difference of a joint's position", minimum=0.0
            ),
        ),
    }
)


class _WithPose(NamedTuple):
    pose: object


class _WithTwist(NamedTuple):
    twist: object


class _Odometry(NamedTuple):
    pose: _WithPose
    twist: _WithTwist


class _PoseType(NamedTuple):
    """A type that holds one pose; ``as_message`` makes a state look like a message of it."""

    frame_count: int
    fields: tuple[str, ...]
    as_message: Callable[[PoseState], object]


_POSE_TYPES: Mapping[str, _PoseType] = MappingProxyType(
    {
        _ODOMETRY: _PoseType(
            2,
            ("pose.pose.", "twist.twist."),
            lambda state: _Odometry(_WithPose(state.pose), _WithTwist(state.twist)),
        ),
        _POSE_STAMPED: _PoseType(1, ("pose.",), lambda state: _WithPose(state.pose)),
        _POSE_WITH_COVARIANCE_STAMPED: _PoseType(
            1, ("pose.pose.",), lambda state: _WithPose(_WithPose(state.pose))
        ),
    }
)


def _pose_distance(between: Callable[[SpatialPose, SpatialPose], float]) -> Distance:
    return Distance(
        lambda one, other: between(one.pose, other.pose),
        # NaN, an infinite number and the zero quaternion cannot be compared with themselves, either.
        lambda one: between(one.pose, one.pose) < math.inf and max(map(abs, one.pose.position)) < MOST,
    )


_POSE_DISTANCES: Mapping[str, Distance] = MappingProxyType(
    {
        "position": _pose_distance(position_distance_m),
        "orientation": _pose_distance(orientation_distance_degrees),
    }
)


def accuracy_properties_of(type_name: str) -> Mapping[str, PropertySpec]:
    """The named properties of ``type_name`` that a KeepWithin can name, those of checks included."""
    return {**{spec.name: spec for spec in _SPECS.get(type_name, ())}, **properties_of(type_name)}


def properties_for_bounds() -> Mapping[str, tuple[PropertySpec, ...]]:
    """By type, what a KeepWithin can name beside what checks read."""
    return _SPECS


def wraps(spec: PropertySpec) -> bool:
    """Whether the values are degrees in (−180, 180] that go round."""
    return spec.unit == "°" and (spec.minimum, spec.maximum) == (-FULL_TURN / 2, FULL_TURN / 2)


def gauges_for(
    type_name: str, names: Iterable[str], level_unit: LevelUnit | None = None, *, is_standard: bool = True
) -> tuple[Gauge, ...]:
    """The reader of these properties of messages of ``type_name``; what only some of them need comes last.

    Unless the type ``is_standard``, serialized messages do not have the bytes of its name, and are decoded.
    """
    reckoned: dict[str, Distance] = {}
    fields: list[str] = []
    for name in names:
        distance = _reckoned(type_name, name) if is_standard else None
        if distance is None:
            fields.append(name)
        else:
            reckoned[name] = distance
    gauges: list[Gauge] = [_reckoning(type_name, reckoned)] if reckoned else []
    if fields:
        gauges.append(_field_gauge(type_name, fields, level_unit))
    return tuple(gauges)


def needs_decoded(gauges: Iterable[Gauge]) -> bool:
    """Whether messages must be decoded for these gauges; the others read serialized ones."""
    return any(isinstance(gauge, FieldGauge) for gauge in gauges)


def _reckoned(type_name: str, name: str) -> Distance | None:
    """The distance of two states of what is read without decoding, ``None`` where it holds no such thing."""
    if name in (spec.name for spec in _SPECS.get(type_name, ())):
        return _OWN_DISTANCES.get(type_name) or _POSE_DISTANCES[name]
    pose_type = _POSE_TYPES.get(type_name)
    if pose_type is None:
        return None
    spec = properties_of(type_name).get(name)
    if spec is None and not name.removeprefix(MESSAGE_PREFIX).startswith(pose_type.fields):
        return None
    read, as_message = value_reader(type_name, name), pose_type.as_message
    is_angle = spec is not None and wraps(spec)
    return _value_distance(lambda state: read(as_message(state)), is_angle=is_angle)


def _reckoning(type_name: str, distances: Mapping[str, Distance]) -> Gauge:
    if type_name == _TRANSFORMS:
        return FrameGauge(distances)
    if type_name == _JOINTS:
        return JointGauge(distances)
    if type_name == _FIX:
        return FixGauge(distances)
    pose_type = _POSE_TYPES[type_name]
    return PoseGauge(distances, frame_count=pose_type.frame_count, has_twist=type_name == _ODOMETRY)


def _field_gauge(type_name: str, names: Iterable[str], level_unit: LevelUnit | None) -> FieldGauge:
    specs = properties_of(type_name)
    readers: dict[str, Callable[[object], object]] = {}
    distances: dict[str, Distance] = {}
    for name in names:
        spec = specs.get(name)
        readers[name] = (
            known_only(type_name, name, part_reader(name))
            if spec is None
            else value_reader(type_name, name, level_unit)
        )
        distances[name] = _value_distance(itemgetter(name), is_angle=spec is not None and wraps(spec))
    return FieldGauge(distances, readers)


def _value_distance(value: Callable[[Any], object], *, is_angle: bool = False) -> Distance:
    return Distance(
        lambda one, other: _apart(value(one), value(other), is_angle=is_angle),
        lambda one: _is_known(value(one)),
    )


_OWN_DISTANCES: Mapping[str, Distance] = MappingProxyType(
    {_JOINTS: _value_distance(itemgetter(0)), _FIX: PLACE_DISTANCE}
)
"""Of types whose property is no part of a pose."""


def _is_known(value: Any) -> bool:
    """Whether it is a text, or a number that can be measured."""
    if isinstance(value, str):
        return True
    try:
        return bool(abs(value) < MOST)
    except (TypeError, ValueError, OverflowError):
        return False


def _apart(one: Any, other: Any, *, is_angle: bool) -> float:
    """The absolute difference of numbers; 0 or infinite of texts; NaN of what cannot be compared.

    Two numbers that are both not known are alike.
    """
    if isinstance(one, str) and isinstance(other, str):
        return 0.0 if one == other else math.inf
    try:
        first, second = float(one), float(other)
    except (TypeError, ValueError, OverflowError):
        return math.nan
    if first == second or (math.isnan(first) and math.isnan(second)):
        return 0.0
    difference = first - second
    return (
        abs(math.remainder(difference, FULL_TURN))
        if is_angle and math.isfinite(difference)
        else abs(difference)
    )
