# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Where a robot was: by a pose in the frame of its map, else by its odometry or its transforms."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from numbers import Real
from typing import Any, Protocol, cast

from smarttestudo.bags.definitions import RosbagDecoder
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.floor_plan import FloorZone, Rectangle
from smarttestudo.domain.recording import Channel, first_of_topics
from smarttestudo.domain.units import NS_PER_S, counted, grouped
from smarttestudo.language.normal_form import Every, Form, InRegion, Some, merged, over_states
from smarttestudo.language.properties import part_reader, value_reader
from smarttestudo.language.properties.field_path import field_reader
from smarttestudo.language.properties.readers import yaw_degrees
from smarttestudo.language.region import Region
from smarttestudo.language.rule_set import RuleSet
from smarttestudo.pacing.cdr_walk import HEADER_BYTES


@dataclass(frozen=True, slots=True, kw_only=True)
class PathPoint:
    """Where the robot was, ``t_s`` seconds after the run's start."""

    t_s: float
    x_m: float
    y_m: float


_X = ("pose_x", "pose.pose.position.x", "pose.position.x")
_Y = ("pose_y", "pose.pose.position.y", "pose.position.y")
_ANYWHERE = (-math.inf, math.inf)


def rule_zones(rule_set: RuleSet) -> tuple[FloorZone, ...]:
    """A zone for each stretch of floor that a block's condition bounds by the x and y of a robot's place.

    A condition may ask for more than the place: its zone is where it can hold. Of an OR, the parts that
    bound both x and y have a zone each. What says the place in another way has none.
    """
    return tuple(
        FloorZone(name=block.label, area=area)
        for block in rule_set.blocks
        for area in _areas(merged(over_states(block.form)))
    )


def _areas(form: Form) -> Iterator[Rectangle]:
    is_choice = isinstance(form, Some)
    for part in form.parts if isinstance(form, Some) else (form,):
        x, y = _bounds(part, _X), _bounds(part, _Y)
        is_bound = x and y if is_choice else x or y
        if is_bound:
            (min_x_m, max_x_m), (min_y_m, max_y_m) = x or _ANYWHERE, y or _ANYWHERE
            yield Rectangle(min_x_m=min_x_m, max_x_m=max_x_m, min_y_m=min_y_m, max_y_m=max_y_m)


def _bounds(form: Form, names: Sequence[str]) -> tuple[float, float] | None:
    """From where to where ``form`` lets the properties of ``names`` be; ``None`` where it says no stretch."""
    parts = form.parts if isinstance(form, Every) else (form,)
    within = [part for part in parts if isinstance(part, InRegion) and part.signal.property in names]
    regions = [part.region for part in within if isinstance(part.region, Region)]
    common = Region.intersection_of(regions)
    if not regions or len(common.pieces) != 1:
        return None
    ((low, high),) = common.pieces
    return low[0], high[0]


_STEP_NS = NS_PER_S // 5
_MAP_FRAME = "map"
_ODOMETRY = "nav_msgs/msg/Odometry"
_LOCALIZED = "geometry_msgs/msg/PoseWithCovarianceStamped"
_SAID_BY_PEOPLE = "initialpose"
_TRANSFORMS = "tf2_msgs/msg/TFMessage"
_ROBOT_FRAMES = ("base_footprint", "base_link")
_MOST_LINKS = 50
_PLACE = ("pose.pose.position.x", "pose.pose.position.y")
_TRANSFORM = ("transform.translation.x", "transform.translation.y", "transform.rotation.w")
_EMPTY, _BROKEN = "in an empty message", "in a message that cannot be decoded"
_NO_NUMBER, _NO_FIELD = "that is NaN or infinite", "without the field that says it"


class PathReader(Protocol):
    """Follows a robot through the messages of its recording."""

    @property
    def path(self) -> Sequence[PathPoint]:
        """The places where the robot was so far, at most five a second."""

    @property
    def source(self) -> str:
        """The topic that says so."""

    @property
    def frame(self) -> str:
        """The frame of its places; empty while no message was read."""

    def on_message(self, channel: Channel, stamp_ns: int, payload: bytes) -> None:
        """Read the next message of the recording.

        Raises:
            RecordingError: the message should say where the robot is, and does not.
        """


class PosePlaces:
    """The positions that one topic of odometry or poses gives."""

    __slots__ = ("_channel", "_decoder", "_due_ns", "_read_x", "_read_y", "_start_ns", "frame", "path")

    def __init__(self, channel: Channel, decoder: RosbagDecoder, start_ns: int) -> None:
        self.path: list[PathPoint] = []
        self.frame = ""
        self._channel = channel
        self._read_x, self._read_y = (value_reader(channel.type_name, name) for name in ("pose_x", "pose_y"))
        self._decoder = decoder
        self._start_ns = start_ns
        self._due_ns = start_ns

    @property
    def source(self) -> str:
        return self._channel.topic

    def on_message(self, channel: Channel, stamp_ns: int, payload: bytes) -> None:
        if stamp_ns < self._due_ns or channel.topic != self._channel.topic:
            return
        if channel.type_name != self._channel.type_name:
            return
        self._due_ns = stamp_ns + _STEP_NS
        message = _decoded(self._decoder, channel, payload)
        self.frame = _frame(message, "header.frame_id")
        t_s = (stamp_ns - self._start_ns) / NS_PER_S
        x_m, y_m = self._read_x(message), self._read_y(message)
        if not (math.isfinite(x_m) and math.isfinite(y_m)):
            raise RecordingError(_why_unknown(message, _PLACE), place=channel.topic)
        self.path.append(PathPoint(t_s=t_s, x_m=x_m, y_m=y_m))


class BestPlaces:
    """Of several readers the first with places in the frame of a map, else the first that is ``usual``.

    Which frame a topic has only its messages say, so that all are followed.
    """

    __slots__ = ("_readers", "_usual")

    def __init__(self, readers: Sequence[PathReader], usual: PathReader) -> None:
        self._readers = readers
        self._usual = usual

    @property
    def path(self) -> Sequence[PathPoint]:
        return self._best.path

    @property
    def source(self) -> str:
        return self._best.source

    @property
    def frame(self) -> str:
        return self._best.frame

    def on_message(self, channel: Channel, stamp_ns: int, payload: bytes) -> None:
        for reader in self._readers:
            reader.on_message(channel, stamp_ns, payload)

    @property
    def _best(self) -> PathReader:
        return next((reader for reader in self._readers if reader.frame == _MAP_FRAME), self._usual)


class TransformPlaces:
    """The place of the robot's base in the root of its transforms, seen from above.

    Frames may turn about the vertical axis; the height is left out.
    """

    __slots__ = ("_channels", "_decoder", "_due_ns", "_links", "_start_ns", "frame", "path")

    def __init__(self, channels: Sequence[Channel], decoder: RosbagDecoder, start_ns: int) -> None:
        self.path: list[PathPoint] = []
        self.frame = ""
        self._channels = channels
        self._decoder = decoder
        self._start_ns = start_ns
        self._due_ns = start_ns
        self._links: dict[str, tuple[str, float, float, float]] = {}

    @property
    def source(self) -> str:
        return self._channels[0].topic

    def on_message(self, channel: Channel, stamp_ns: int, payload: bytes) -> None:
        if not any(channel is own for own in self._channels):
            return
        message = _decoded(self._decoder, channel, payload)
        unknown: object = None
        for link in _listed(message):
            x_m, y_m, yaw_rad = _read_x(link), _read_y(link), math.radians(_yaw_degrees(link))
            if math.isfinite(x_m + y_m + yaw_rad):
                parent = _frame(link, "header.frame_id")
                self._links[_frame(link, "child_frame_id")] = parent, x_m, y_m, yaw_rad
            else:
                unknown = link
        self._go_to(stamp_ns)
        if unknown is not None:
            raise RecordingError(_why_unknown(unknown, _TRANSFORM), place=channel.topic)

    def _go_to(self, stamp_ns: int) -> None:
        """The robot is where its links say."""
        frame = next((name for name in _ROBOT_FRAMES if name in self._links), None)
        if frame is not None and stamp_ns >= self._due_ns:
            self._due_ns = stamp_ns + _STEP_NS
            x_m, y_m = self._in_root(frame)
            t_s = (stamp_ns - self._start_ns) / NS_PER_S
            self.path.append(PathPoint(t_s=t_s, x_m=x_m, y_m=y_m))

    def _in_root(self, frame: str) -> tuple[float, float]:
        x_m = y_m = 0.0
        for _ in range(_MOST_LINKS):
            if frame not in self._links:
                break
            frame, move_x_m, move_y_m, yaw_rad = self._links[frame]
            self.frame = frame
            cos, sin = math.cos(yaw_rad), math.sin(yaw_rad)
            x_m, y_m = move_x_m + cos * x_m - sin * y_m, move_y_m + sin * x_m + cos * y_m
        return x_m, y_m


def _decoded(decoder: RosbagDecoder, channel: Channel, payload: bytes) -> object:
    """The message. Raises ``RecordingError`` with a cause that all messages of one kind share."""
    try:
        return decoder.decode(channel, payload)
    except RecordingError as error:
        is_empty = len(payload) <= HEADER_BYTES
        raise RecordingError(_EMPTY if is_empty else _BROKEN, place=channel.topic) from error


def _why_unknown(message: object, paths: Iterable[str]) -> str:
    is_there = all(isinstance(part_reader(path)(message), Real) for path in paths)
    return _NO_NUMBER if is_there else _NO_FIELD


def notice_of_unknown(places: Counter[str]) -> Iterator[str]:
    """A line about messages that should say where the robot is, and do not, by the causes of their errors."""
    if places:
        listed = ", ".join(f"{grouped(count)} {why}" for why, count in places.items())
        yield f"{counted(places.total(), 'place')} of the robot not known: {listed}"


def places_in(
    channels: Sequence[Channel], decoder: RosbagDecoder, start_ns: int, *, by_transforms: bool
) -> PathReader | None:
    """Reader of the robot's places in a recording with ``channels``; ``None`` if nothing says them.

    That is a topic whose poses are in the frame ``map``, ``/amcl_pose`` before others. Else it is the
    odometry, ``/odom`` before others, else the transforms; ``by_transforms`` takes those before any topic.
    """
    known = [channel for channel in channels if decoder.why_undecodable(channel) is None]
    transforms = [channel for channel in known if channel.type_name == _TRANSFORMS]
    if transforms and by_transforms:
        return TransformPlaces(transforms, decoder, start_ns)
    of_topics = first_of_topics(known).values()
    localized = _by_name(of_topics, _LOCALIZED, "/amcl_pose")
    odometry = _by_name(of_topics, _ODOMETRY, "/odom")
    poses = [
        PosePlaces(channel, decoder, start_ns)
        for channel in (*localized, *odometry)
        if not channel.topic.endswith(f"/{_SAID_BY_PEOPLE}")
    ]
    readers: list[PathReader] = [*poses]
    if odometry:
        usual = next(reader for reader in readers if reader.source == odometry[0].topic)
    elif transforms:
        usual = TransformPlaces(transforms, decoder, start_ns)
        readers.append(usual)
    elif poses:
        usual = poses[0]
    else:
        return None
    return usual if len(readers) == 1 else BestPlaces(readers, usual)


_read_x, _read_y = field_reader("transform.translation.x"), field_reader("transform.translation.y")


def _yaw_degrees(link: object) -> float:
    try:
        return yaw_degrees(cast("Any", link).transform.rotation)
    except (AttributeError, TypeError):
        return math.nan


def _listed(message: object) -> Sequence[object]:
    """The transforms of a message; none of one that a recording defines without."""
    transforms = part_reader("transforms")(message)
    return transforms if isinstance(transforms, list | tuple) else ()


def _frame(message: object, path: str) -> str:
    """The frame that is named there; empty where none is."""
    name = part_reader(path)(message)
    return name.lstrip("/") if isinstance(name, str) else ""


def _by_name(channels: Iterable[Channel], type_name: str, first: str) -> list[Channel]:
    alike = (channel for channel in channels if channel.type_name == type_name)
    return sorted(alike, key=lambda channel: (channel.topic != first, channel.topic))
