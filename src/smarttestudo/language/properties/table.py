# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The properties of each type, what rules may do with them, and the types that topics have by their names."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import Enum
from operator import attrgetter
from types import MappingProxyType
from typing import Any

from smarttestudo.domain.names import is_source
from smarttestudo.domain.profile import LevelUnit
from smarttestudo.language.properties import readers
from smarttestudo.language.properties.distances import JOINT_POSITION, ORIENTATION, POSITION
from smarttestudo.language.properties.field_path import (
    MESSAGE_PREFIX,
    PropertySpec,
    Reader,
    field_reader,
    number,
)
from smarttestudo.language.properties.vitals import VITALS
from smarttestudo.pacing.reckoning.gauges import (
    PLACE_DISTANCE,
    Distance,
    FixGauge,
    FrameGauge,
    Gauge,
    JointGauge,
    PoseGauge,
)
from smarttestudo.pacing.reckoning.motion import Rotation, SpatialPose, Twist, Vector3


class MessagePart(Enum):
    """A part of a message; a gauge of poses reads the pose and the twist without decoding the rest."""

    MESSAGE = "message"
    POSE = "pose"
    TWIST = "twist"

    def has_number(self, path: str) -> bool:
        """Whether the pose or twist has a number at the field ``path``."""
        return not math.isnan(field_reader(path)(_AT_REST[self]))


_NOWHERE = Vector3(0.0, 0.0, 0.0)
_AT_REST: Mapping[MessagePart, object] = MappingProxyType(
    {
        MessagePart.POSE: SpatialPose(_NOWHERE, Rotation(0.0, 0.0, 0.0, 1.0)),
        MessagePart.TWIST: Twist(_NOWHERE, _NOWHERE),
    }
)


@dataclass(frozen=True, slots=True, kw_only=True)
class ValueProperty:
    """A number of a message: a CheckValue compares it, a KeepWithin bounds how far two of them are apart.

    ``read_of`` makes what reads it of the ``part``, given the unit of a battery's level. ``known_by`` is the
    field that says whether it is known, where that has another name.
    """

    spec: PropertySpec
    read_of: Callable[[LevelUnit | None], Callable[[Any], float]]
    part: MessagePart = MessagePart.MESSAGE
    known_by: str = ""

    def __post_init__(self) -> None:
        """Raise what ``read_of`` does where the part that it is declared for holds no such thing."""
        if self.part in _AT_REST:
            self.read_of(None)(_AT_REST[self.part])

    def reader(self, level_unit: LevelUnit | None = None) -> Reader:
        """Read it of its part; unknown where a type of that name holds no such value."""
        read = self.read_of(level_unit)

        def reader(part: object) -> float:
            try:
                return number(read(part))
            except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError):
                return math.nan

        return reader


@dataclass(frozen=True, slots=True, kw_only=True)
class DistanceProperty:
    """A distance of two messages, which a KeepWithin bounds; a message alone has no such value."""

    spec: PropertySpec
    distance: Distance


@dataclass(frozen=True, slots=True, kw_only=True)
class MessageType:
    """The properties of a type, by what rules may do with them, and where messages have their parts.

    ``gauge`` reads serialized messages: what ``distances`` compare, and the parts in ``paths``.
    """

    values: tuple[ValueProperty, ...] = ()
    distances: tuple[DistanceProperty, ...] = ()
    paths: Mapping[MessagePart, str] = field(default_factory=dict)
    gauge: Callable[[Mapping[str, Distance]], Gauge] | None = None

    def __post_init__(self) -> None:
        """Raise ``ValueError`` for a property that nothing could read."""
        for value in self.values:
            if value.part is not MessagePart.MESSAGE and value.part not in self.paths:
                raise ValueError(f"{value.spec.name} is of a {value.part.value}, which this type has not")
        if self.distances and self.gauge is None:
            raise ValueError("distances are of what a gauge reads")

    def value(self, name: str) -> ValueProperty | None:
        """The property ``name`` that messages have a value of."""
        return next((declared for declared in self.values if declared.spec.name == name), None)

    def part_at(self, path: str) -> tuple[MessagePart, str] | None:
        """The part that holds the field ``path``, and the path in it."""
        plain = path.removeprefix(MESSAGE_PREFIX)
        inside = ((part, f"{start}.") for part, start in self.paths.items() if start)
        return next(
            ((part, plain.removeprefix(start)) for part, start in inside if plain.startswith(start)), None
        )


def _value(
    name: str,
    unit: str,
    meaning: str,
    read: Callable[[Any], float],
    *,
    part: MessagePart = MessagePart.MESSAGE,
    minimum: float | None = None,
    maximum: float | None = None,
    known_by: str = "",
) -> ValueProperty:
    spec = PropertySpec(name=name, unit=unit, meaning=meaning, minimum=minimum, maximum=maximum)
    return ValueProperty(spec=spec, read_of=lambda _unit: read, part=part, known_by=known_by)


def _angle(
    name: str,
    meaning: str,
    read: Callable[[Any], float],
    *,
    part: MessagePart = MessagePart.MESSAGE,
    known_by: str = "",
) -> ValueProperty:
    spec = PropertySpec(
        name=name, unit="°", meaning=meaning, minimum=-180.0, maximum=180.0, includes_minimum=False
    )
    return ValueProperty(spec=spec, read_of=lambda _unit: read, part=part, known_by=known_by)


def _position(meaning: str, distance: Distance) -> DistanceProperty:
    return DistanceProperty(
        spec=PropertySpec(name="position", unit="m", meaning=meaning, minimum=0.0), distance=distance
    )


_LEVEL = ValueProperty(
    spec=PropertySpec(name="level", unit="%", meaning="charge left", minimum=0.0, maximum=100.0),
    read_of=readers.BatteryLevel,
    known_by="percentage",
)
_GOAL = ValueProperty(
    spec=PropertySpec(
        name="goal", unit="", meaning="status of the goal that was accepted last", minimum=0.0, maximum=6.0
    ),
    read_of=lambda _unit: readers.LatestGoal(),
    known_by="status_list",
)
_OF_POSE = (
    _value("pose_x", "m", "position along x", lambda pose: pose.position.x, part=MessagePart.POSE),
    _value("pose_y", "m", "position along y", lambda pose: pose.position.y, part=MessagePart.POSE),
    _value("pose_z", "m", "position along z", lambda pose: pose.position.z, part=MessagePart.POSE),
    _angle("yaw", "heading", lambda pose: readers.yaw_degrees(pose.orientation), part=MessagePart.POSE),
)
_OF_TWIST = (
    _value(
        "vel",
        "m/s",
        "signed forward velocity (linear.x)",
        lambda twist: twist.linear.x,
        part=MessagePart.TWIST,
    ),
    _value(
        "speed",
        "m/s",
        "length of the linear velocity",
        lambda twist: readers.length(twist.linear),
        part=MessagePart.TWIST,
        minimum=0.0,
    ),
    _value(
        "yaw_rate",
        "rad/s",
        "signed turning rate (angular.z)",
        lambda twist: twist.angular.z,
        part=MessagePart.TWIST,
    ),
)
_OF_IMU = (
    _angle("roll", "rotation about x", lambda m: readers.roll_degrees(m.orientation), known_by="orientation"),
    _value(
        "pitch",
        "°",
        "rotation about y",
        lambda m: readers.pitch_degrees(m.orientation),
        minimum=-90.0,
        maximum=90.0,
        known_by="orientation",
    ),
    _angle("yaw", "rotation about z", lambda m: readers.yaw_degrees(m.orientation), known_by="orientation"),
    _value(
        "acceleration",
        "m/s²",
        "length of the linear acceleration",
        lambda m: readers.length(m.linear_acceleration),
        minimum=0.0,
        known_by="linear_acceleration",
    ),
    _value(
        "angular_speed",
        "rad/s",
        "length of the angular velocity",
        lambda m: readers.length(m.angular_velocity),
        minimum=0.0,
        known_by="angular_velocity",
    ),
)
_OF_JOINTS = (
    _value(
        "max_velocity",
        "rad/s",
        "greatest joint velocity, either way",
        readers.greatest_magnitude("velocity"),
        minimum=0.0,
    ),
    _value(
        "max_effort",
        "N m",
        "greatest joint effort, either way",
        readers.greatest_magnitude("effort"),
        minimum=0.0,
    ),
)
_POSE_DISTANCES = (
    _position("length of the difference of the positions", POSITION),
    DistanceProperty(
        spec=PropertySpec(
            name="orientation",
            unit="°",
            meaning="angle of the rotation between the orientations",
            minimum=0.0,
            maximum=180.0,
        ),
        distance=ORIENTATION,
    ),
)
_JOINT_DISTANCE = DistanceProperty(
    spec=PropertySpec(
        name="positions", unit="rad", meaning="largest difference of a joint's position", minimum=0.0
    ),
    distance=JOINT_POSITION,
)


def _still_pose(distances: Mapping[str, Distance]) -> PoseGauge:
    return PoseGauge(distances, frame_count=1, has_twist=False)


_TYPES: Mapping[str, MessageType] = MappingProxyType(
    {
        "nav_msgs/msg/Odometry": MessageType(
            values=(*_OF_POSE, *_OF_TWIST),
            distances=_POSE_DISTANCES,
            paths={MessagePart.POSE: "pose.pose", MessagePart.TWIST: "twist.twist"},
            gauge=lambda distances: PoseGauge(distances, frame_count=2, has_twist=True),
        ),
        "geometry_msgs/msg/PoseStamped": MessageType(
            values=_OF_POSE, distances=_POSE_DISTANCES, paths={MessagePart.POSE: "pose"}, gauge=_still_pose
        ),
        "geometry_msgs/msg/PoseWithCovarianceStamped": MessageType(
            values=_OF_POSE,
            distances=_POSE_DISTANCES,
            paths={MessagePart.POSE: "pose.pose"},
            gauge=_still_pose,
        ),
        "tf2_msgs/msg/TFMessage": MessageType(distances=_POSE_DISTANCES, gauge=FrameGauge),
        "sensor_msgs/msg/NavSatFix": MessageType(
            distances=(
                _position(
                    "length of the way between the places, of degrees in metres of WGS 84", PLACE_DISTANCE
                ),
            ),
            gauge=FixGauge,
        ),
        "geometry_msgs/msg/Twist": MessageType(values=_OF_TWIST, paths={MessagePart.TWIST: ""}),
        "geometry_msgs/msg/TwistStamped": MessageType(values=_OF_TWIST, paths={MessagePart.TWIST: "twist"}),
        "sensor_msgs/msg/LaserScan": MessageType(
            values=(
                _value("distance", "m", "smallest range in sight", readers.nearest_distance_m, minimum=0.0),
            )
        ),
        "sensor_msgs/msg/BatteryState": MessageType(values=(_LEVEL,)),
        "action_msgs/msg/GoalStatusArray": MessageType(values=(_GOAL,)),
        "sensor_msgs/msg/Imu": MessageType(values=_OF_IMU),
        "sensor_msgs/msg/JointState": MessageType(
            values=_OF_JOINTS, distances=(_JOINT_DISTANCE,), gauge=JointGauge
        ),
    }
)
_NO_PROPERTIES = MessageType()

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
"""Properties of every topic, for checks alone; they need nothing decoded and are never unknown."""


def message_type(type_name: str) -> MessageType:
    """The declared properties of ``type_name``, none of a type that is not in the table."""
    return _TYPES.get(type_name, _NO_PROPERTIES)


def known_types() -> tuple[str, ...]:
    """The types that have named properties for checks."""
    return tuple(name for name, known in _TYPES.items() if known.values)


def properties_of(type_name: str) -> Mapping[str, PropertySpec]:
    """The named properties of ``type_name`` for checks, without those of every topic.

    Those of the machine and the link are named by what stands for the topic.
    """
    if is_source(type_name):
        return VITALS.get(type_name, {})
    return {declared.spec.name: declared.spec for declared in message_type(type_name).values}


def properties_for_bounds() -> Mapping[str, tuple[PropertySpec, ...]]:
    """By type, what a KeepWithin can name beside what checks read."""
    return {
        name: tuple(distance.spec for distance in known.distances)
        for name, known in _TYPES.items()
        if known.distances
    }


def accuracy_properties_of(type_name: str) -> Mapping[str, PropertySpec]:
    """The named properties of ``type_name`` that a KeepWithin can name, those of checks included."""
    distances = {distance.spec.name: distance.spec for distance in message_type(type_name).distances}
    return {**distances, **properties_of(type_name)}


def property_spec(type_name: str | None, name: str) -> PropertySpec | None:
    """The description of property ``name``; with the type unknown, whatever all types agree on."""
    if type_name is not None and is_source(type_name):
        return properties_of(type_name).get(name)
    if name in ARRIVAL_PROPERTIES:
        return ARRIVAL_PROPERTIES[name]
    if type_name is not None:
        return properties_of(type_name).get(name)
    found = [table[name] for table in map(properties_of, _TYPES) if name in table]
    ranges = {(spec.minimum, spec.maximum) for spec in found}
    return found[0] if len(ranges) == 1 else None


def value_reader(type_name: str, name: str, level_unit: LevelUnit | None = None) -> Reader:
    """Read property ``name`` of messages of ``type_name``, or the field path ``name``.

    A reader belongs to one topic: that of a battery's level remembers the unit it saw.
    """
    known = message_type(type_name)
    value = known.value(name)
    if value is None:
        return readers.known_only(type_name, name, field_reader(name))
    read = _of_messages(value.reader(level_unit), known.paths.get(value.part, ""))
    return readers.known_only(type_name, value.known_by or name, read)


def _of_messages(read: Reader, path: str) -> Reader:
    """``read`` of the part of a message at ``path``, unknown where a message has none."""
    if not path:
        return read
    part_of = attrgetter(path)

    def reader(message: object) -> float:
        try:
            part = part_of(message)
        except AttributeError:
            return math.nan
        return read(part)

    return reader
