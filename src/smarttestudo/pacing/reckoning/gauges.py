# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Gauges of messages: their parts, how each moves, and how far two states of it are apart."""

from __future__ import annotations

import math
import struct
from collections.abc import Callable, Hashable, Mapping, Sequence
from contextlib import suppress
from typing import Any, NamedTuple, Protocol

from smarttestudo.domain.observation import Undecodable
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.pacing.cdr import FrameReader, JointReader, PoseReader, header_stamp_ns
from smarttestudo.pacing.cdr_walk import CdrWalk, byte_order
from smarttestudo.pacing.reckoning.motion import Rotation, SpatialPose, Twist, Vector3, moved, twist_between


class Distance(NamedTuple):
    """How far two states of a part are apart, and whether one says anything of the property.

    ``between`` is in the unit of the property; NaN where the states cannot be compared. ``has_value`` is
    false of a state whose value is not known: NaN, infinite, or no such thing.
    """

    between: Callable[[Any, Any], float]
    has_value: Callable[[Any], bool]


class MovingPart(NamedTuple):
    """Part of a message that says how one thing is: ``state`` at ``at_ns``.

    ``name`` is that of a child frame or joint, or empty where a message says one thing. States of different
    ``frames`` cannot be compared. Where the message ``has_stamp``, that is ``at_ns``, else its arrival.
    """

    name: str
    at_ns: int
    frames: Hashable
    state: Any
    has_stamp: bool


Reading = Sequence[MovingPart]


def can_be_reckoned(reading: Reading | None) -> bool:
    """Whether what a message says can be moved on, which both ends ask here: all its parts have stamps.

    Without one, a message does not say when the robot is there, and its arrival is another one at each end.
    """
    return bool(reading) and all(part.has_stamp for part in reading or ())


UNKNOWN_M = 1000.0
"""What stands for the bound of a position that has none."""
HALF_TURN = 180.0
"""No orientation is farther off."""


class Gauge(Protocol):
    """Reads messages of one type. ``distances`` are those of the properties that are bound."""

    distances: Mapping[str, Distance]

    @property
    def is_shared(self) -> bool:
        """Whether the publishers of a topic speak of the same parts, which are told apart by name.

        Else each publisher speaks of one thing.
        """

    @property
    def needs_every_message(self) -> bool:
        """Whether the motion of a part may come from its last two messages."""

    def read(self, payload: bytes, message: object | None, now_ns: int) -> Reading | None:
        """The parts of a message that arrived at ``now_ns``; ``None`` where they cannot be read."""

    def motion(self, before: MovingPart | None, part: MovingPart) -> Any:
        """How ``part`` moves on, given the part of that name that a receiver got ``before``."""

    def after(self, state: Any, motion: Any, elapsed_s: float) -> Any:
        """State that a receiver which reckons shows ``elapsed_s`` after ``state``."""

    def written(self, payload: bytes, parts: Reading, within: Mapping[str, float]) -> bytes | None:
        """``payload`` with these of its parts, moved on, and no others; ``None`` if its type stays.

        Bounds of properties, by which the parts may be off, become covariance where the type has one.
        """


class PoseState(NamedTuple):
    """A pose and, where the message has one, its twist."""

    pose: SpatialPose
    twist: Twist | None


class PoseGauge:
    """Odometry, which moves by its twist; PoseStamped and PoseWithCovarianceStamped, which stay."""

    is_shared = False
    needs_every_message = False

    def __init__(self, distances: Mapping[str, Distance], *, frame_count: int, has_twist: bool) -> None:
        self.distances = distances
        self._has_twist = has_twist
        self._reader = PoseReader(frame_count, has_twist=has_twist)

    def read(self, payload: bytes, _message: object | None, now_ns: int) -> Reading | None:
        """The one part of the message, at its header's stamp, or at ``now_ns`` where that is not set."""
        found = self._reader.read(payload)
        if found is None:
            return None
        frames, numbers = found
        twist = Twist(Vector3(*numbers[7:10]), Vector3(*numbers[10:13])) if len(numbers) > 7 else None
        state, stamp_ns = PoseState(_pose(numbers), twist), header_stamp_ns(payload)
        return (MovingPart("", stamp_ns or now_ns, frames, state, stamp_ns is not None),)

    def motion(self, _before: MovingPart | None, part: MovingPart) -> Twist | None:
        """The twist that the message holds."""
        state: PoseState = part.state
        return state.twist

    def after(self, state: PoseState, motion: Twist | None, elapsed_s: float) -> PoseState:
        return state if motion is None else PoseState(moved(state.pose, motion, elapsed_s), state.twist)

    def written(self, payload: bytes, parts: Reading, within: Mapping[str, float]) -> bytes | None:
        """An Odometry at another pose; the squares of the bounds come on top of its covariance."""
        if not self._has_twist:
            return None
        (part,) = parts
        bound_m = within.get("position", UNKNOWN_M)
        bound_rad = math.radians(within.get("orientation", HALF_TURN))
        # A power of too large a number raises, a product is infinite.
        variances = (*(bound_m * bound_m,) * 3, *(bound_rad * bound_rad,) * 3)
        return self._reader.moved(payload, part.at_ns, _numbers(part.state), variances)


class FrameGauge:
    """TFMessage: each child frame moves by the twist between the last two messages that held it."""

    is_shared = True
    needs_every_message = True

    def __init__(self, distances: Mapping[str, Distance]) -> None:
        self.distances = distances
        self._reader = FrameReader()

    def read(self, payload: bytes, _message: object | None, now_ns: int) -> Reading | None:
        """A part for each transform."""
        parts = [
            MovingPart(
                transform.child_frame,
                transform.stamp_ns or now_ns,
                transform.frame,
                PoseState(_pose(transform.numbers), None),
                transform.stamp_ns != 0,
            )
            for transform in self._reader.transforms(payload)
        ]
        return parts or None

    def motion(self, before: MovingPart | None, part: MovingPart) -> Twist | None:
        """The constant twist since ``before``."""
        if before is None or before.at_ns >= part.at_ns or before.frames != part.frames:
            return None
        return twist_between(before.state.pose, part.state.pose, (part.at_ns - before.at_ns) / NS_PER_S)

    def after(self, state: PoseState, motion: Twist | None, elapsed_s: float) -> PoseState:
        return state if motion is None else PoseState(moved(state.pose, motion, elapsed_s), None)

    def written(self, payload: bytes, parts: Reading, _within: Mapping[str, float]) -> bytes | None:
        return self._reader.moved(payload, {part.name: (part.at_ns, _numbers(part.state)) for part in parts})


class JointGauge:
    """JointState: each joint moves with the velocity of its message, else with that of the last two messages.

    A state is a position and a velocity, which is NaN where the message holds none.
    """

    is_shared = True
    needs_every_message = True

    def __init__(self, distances: Mapping[str, Distance]) -> None:
        self.distances = distances
        self._reader = JointReader()

    def read(self, payload: bytes, _message: object | None, now_ns: int) -> Reading | None:
        """A part for each joint with a position."""
        found = self._reader.read(payload)
        if found is None:
            return None
        names, positions, velocities = found
        if len(velocities) != len(names):
            velocities = (math.nan,) * len(names)
        stamp_ns = header_stamp_ns(payload)
        at_ns, has_stamp = stamp_ns or now_ns, stamp_ns is not None
        return [
            MovingPart(name, at_ns, None, (position, velocity), has_stamp)
            for name, position, velocity in zip(names, positions, velocities)  # noqa: B905 - as long as each is
        ]

    def motion(self, before: MovingPart | None, part: MovingPart) -> float:
        """The joint's velocity in rad/s or m/s, 0 where it is not known."""
        position, velocity = part.state
        if math.isfinite(velocity):
            return float(velocity)
        if before is None or before.at_ns >= part.at_ns:
            return 0.0
        return float((position - before.state[0]) * NS_PER_S / (part.at_ns - before.at_ns))

    def after(self, state: tuple[float, float], motion: float, elapsed_s: float) -> tuple[float, float]:
        return state[0] + motion * elapsed_s, state[1]

    def written(self, payload: bytes, parts: Reading, _within: Mapping[str, float]) -> bytes | None:
        """These joints at other positions."""
        return self._reader.moved(payload, parts[0].at_ns, {part.name: part.state[0] for part in parts})


class FieldGauge:
    """Fields of a decoded message of any type, each a state of its own; they stay as they are."""

    is_shared = False
    needs_every_message = False

    def __init__(
        self, distances: Mapping[str, Distance], readers: Mapping[str, Callable[[object], object]]
    ) -> None:
        self.distances = distances
        self._readers = readers

    def read(self, _payload: bytes, message: object | None, now_ns: int) -> Reading | None:
        """One part, whose state has the value of each field by property."""
        if message is None or isinstance(message, Undecodable):
            return None
        values = {name: read(message) for name, read in self._readers.items()}
        return (MovingPart("", now_ns, None, values, has_stamp=False),)

    def motion(self, _before: MovingPart | None, _part: MovingPart) -> None:
        """``None``: no motion is known."""

    def after(self, state: object, _motion: None, _elapsed_s: float) -> object:
        return state

    def written(self, _payload: bytes, _parts: Reading, _within: Mapping[str, float]) -> bytes | None:
        """``None``: nothing moves."""
        return None


def _numbers(state: PoseState) -> tuple[float, ...]:
    return (*state.pose.position, *state.pose.orientation)


def _pose(numbers: Sequence[float]) -> SpatialPose:
    return SpatialPose(Vector3(*numbers[:3]), Rotation(*numbers[3:7]))


_EQUATOR_M = 6_378_137.0
_FLATTENING = 1 / 298.257223563
_SQUARED_ECCENTRICITY = _FLATTENING * (2 - _FLATTENING)
_NO_FIX = -1


class Place(NamedTuple):
    """Where a receiver is; NaN stands for what it does not know, which is all of it without a fix."""

    latitude_deg: float
    longitude_deg: float
    altitude_m: float


_NOWHERE = Place(math.nan, math.nan, math.nan)


def places_distance_m(one: Place, other: Place) -> float:
    """The length of the way between two places; at the ellipsoid where the altitude of one is not known.

    NaN where one is nowhere.
    """
    if not (_is_on_earth(one) and _is_on_earth(other)):
        return math.nan
    has_altitudes = math.isfinite(one.altitude_m) and math.isfinite(other.altitude_m)
    return math.dist(_axes_m(one, has_altitude=has_altitudes), _axes_m(other, has_altitude=has_altitudes))


def _is_on_earth(place: Place) -> bool:
    return abs(place.latitude_deg) <= 90 and math.isfinite(place.longitude_deg)


def _axes_m(place: Place, *, has_altitude: bool) -> tuple[float, float, float]:
    latitude, longitude = math.radians(place.latitude_deg), math.radians(place.longitude_deg)
    height_m = place.altitude_m if has_altitude else 0.0
    normal_m = _EQUATOR_M / math.sqrt(1 - _SQUARED_ECCENTRICITY * math.sin(latitude) ** 2)
    from_axis_m = (normal_m + height_m) * math.cos(latitude)
    return (
        from_axis_m * math.cos(longitude),
        from_axis_m * math.sin(longitude),
        (normal_m * (1 - _SQUARED_ECCENTRICITY) + height_m) * math.sin(latitude),
    )


PLACE_DISTANCE = Distance(places_distance_m, _is_on_earth)


class FixGauge:
    """NavSatFix, which stays where it is."""

    is_shared = False
    needs_every_message = False

    def __init__(self, distances: Mapping[str, Distance]) -> None:
        self.distances = distances

    def read(self, payload: bytes, _message: object | None, now_ns: int) -> Reading | None:
        """The one part of the message, at its header's stamp, or at ``now_ns`` where that is not set."""
        place = _place(payload)
        if place is None:
            return None
        stamp_ns = header_stamp_ns(payload)
        return (MovingPart("", stamp_ns or now_ns, None, place, stamp_ns is not None),)

    def motion(self, _before: MovingPart | None, _part: MovingPart) -> None:
        """``None``: no motion is known."""

    def after(self, state: Place, _motion: None, _elapsed_s: float) -> Place:
        return state

    def written(self, _payload: bytes, _parts: Reading, _within: Mapping[str, float]) -> bytes | None:
        """``None``: nothing moves."""
        return None


def _place(payload: bytes) -> Place | None:
    order = byte_order(payload)
    if order is None:
        return None
    with suppress(struct.error):
        walk = CdrWalk(payload, order)
        walk.header()
        (status,) = struct.unpack_from(f"{order}b", payload, walk.skip(1, 1))
        walk.skip(2, 2)
        place = Place(*struct.unpack_from(f"{order}3d", payload, walk.skip(24, 8)))
        return _NOWHERE if status == _NO_FIX else place
    return None
