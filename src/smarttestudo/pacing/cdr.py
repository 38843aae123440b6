# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Reads the few fields that are needed of serialized messages (CDR, either endian), and writes texts.

Plain CDR as ROS 2 writes it: a 4-byte encapsulation header, then the fields, each aligned to its size
counted from the end of that header (OMG DDS-XTYPES 1.3, 7.4.1 and 7.6.2). Nothing here raises on any bytes.
"""

from __future__ import annotations

import hashlib
import struct
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from functools import partial
from types import MappingProxyType
from typing import NamedTuple

from smarttestudo.domain.units import NS_PER_S
from smarttestudo.pacing.cdr_walk import (
    HEADER_BYTES,
    MAX_ITEMS,
    STAMP_BYTES,
    CdrWalk,
    Payload,
    TooLongError,
    aligned,
    byte_order,
    text_at,
    text_end,
)

STAMPED_BYTES = HEADER_BYTES + STAMP_BYTES
MAX_KNOWN_LAYOUTS = 64

DELETE, DELETE_ALL = 2, 3
"""Actions of a visualization_msgs/msg/Marker."""

_LENGTH_END = HEADER_BYTES + 4
_LITTLE_ENDIAN = b"\x00\x01"
_STAMP = MappingProxyType({order: struct.Struct(f"{order}iI") for order in "<>"})
_TRANSFORM = MappingProxyType({order: struct.Struct(f"{order}7d") for order in "<>"})
_POSE_BYTES = 7 * 8
_LEVEL_BYTES = 1
_MOST_PADDING = 8
_MOST_LETTERS = 255
_SECONDS = 2**31
"""What the seconds of a stamp, an int32, stay below."""
_COVARIANCE = MappingProxyType({order: struct.Struct(f"{order}36d") for order in "<>"})
_POSE_AND_TWIST = MappingProxyType({order: struct.Struct(f"{order}7d288x6d") for order in "<>"})


def header_stamp(payload: Payload) -> bytes | None:
    """``header.stamp`` of a message that begins with a std_msgs/Header; ``None`` if it cannot be one.

    The first ``STAMPED_BYTES`` of it are enough. What comes back are the 8 bytes of sec (int32) and nanosec
    (uint32), always in little endian: equal stamps are equal bytes.
    """
    stamp = _header_stamp(payload)
    return None if stamp is None else struct.pack("<iI", *stamp)


def header_stamp_ns(payload: Payload) -> int | None:
    """The same in ns since the epoch; ``None``, too, for one that was never set, which is 0."""
    sec, nanosec = _header_stamp(payload) or (0, 0)
    return sec * NS_PER_S + nanosec or None


def string_message(text: str) -> bytes:
    data = text.encode() + b"\0"
    return _LITTLE_ENDIAN + bytes(2) + struct.pack("<I", len(data)) + data


def string_text(payload: Payload) -> str | None:
    """The text of a serialized std_msgs/msg/String; ``None`` if it cannot be one."""
    order = byte_order(payload)
    if order is None or len(payload) <= _LENGTH_END:
        return None
    (length,) = struct.unpack_from(f"{order}I", payload, HEADER_BYTES)
    data = bytes(payload[_LENGTH_END : _LENGTH_END + length])
    if len(data) != length or not data.endswith(b"\0"):
        return None
    try:
        return data[:-1].decode()
    except UnicodeDecodeError:
        return None


class Transform(NamedTuple):
    """One transform of a TFMessage: ``numbers`` are its translation x y z and its rotation x y z w."""

    frame: str
    child_frame: str
    stamp_ns: int
    numbers: tuple[float, ...]


class StreamReader:
    """The streams that the messages of a topic belong to, by ``STREAM_TYPES``, one message after the other.

    Messages of one sender mostly differ in stamps and numbers only: what decides the streams is compared with
    the last message of the same length in one go.
    """

    __slots__ = ("_known", "_ways")

    def __init__(self, type_name: str) -> None:
        self._ways = STREAM_TYPES.get(type_name, ())
        self._known: dict[int, _Streams] = {}

    def streams(self, payload: Payload) -> tuple[str, ...]:
        """The names of its streams, each once, in their order; none where it cannot be of the type."""
        return self._read(payload).names

    def streams_and_deletion(self, payload: Payload) -> tuple[tuple[str, ...], int]:
        """The same, and ``DELETE_ALL`` or ``DELETE`` where a marker of it says so, else 0."""
        found = self._read(payload)
        return found.names, found.deletion

    def _read(self, payload: Payload) -> _Streams:
        known = self._known.get(len(payload))
        if known is not None and known.layout.unpack(payload) == known.constant:
            return known
        streams = _read_streams(payload, self._ways)
        if streams.names:
            if len(self._known) >= MAX_KNOWN_LAYOUTS:
                self._known.clear()
            self._known[len(payload)] = streams
        return streams


class FrameReader(StreamReader):
    """The child frames and transforms of a TFMessage, one message after the other."""

    __slots__ = ()

    def __init__(self) -> None:
        super().__init__(_TRANSFORMS)

    def transforms(self, payload: Payload) -> list[Transform]:
        """The transforms of ``payload``, in their order; none if it cannot be a TFMessage."""
        order = byte_order(payload)
        if order is None:
            return []
        stamp, numbers = _STAMP[order], _TRANSFORM[order]
        transforms = []
        for child_frame, frame, stamp_at, _, numbers_at, _ in self._read(payload).places:
            sec, nanosec = stamp.unpack_from(payload, stamp_at)
            at_ns = sec * NS_PER_S + nanosec
            transforms.append(Transform(frame, child_frame, at_ns, numbers.unpack_from(payload, numbers_at)))
        return transforms

    def moved(self, payload: bytes, transforms: Mapping[str, tuple[int, Sequence[float]]]) -> bytes | None:
        """The transforms of ``payload`` to these child frames, each with another time and other numbers."""
        order = byte_order(payload)
        places = [place for place in self._read(payload).places if place.stream in transforms]
        if order is None or not all(_can_be_stamp(at_ns) for at_ns, _ in transforms.values()):
            return None
        data = bytearray(payload[:HEADER_BYTES]) + struct.pack(f"{order}I", len(places))
        for child_frame, _, stamp_at, names_end, *_ in places:
            at_ns, numbers = transforms[child_frame]
            _pad(data, 4)
            data += _STAMP[order].pack(*divmod(at_ns, NS_PER_S))
            # A stamp begins at a multiple of 4, so what is between the two names is as it was.
            data += payload[stamp_at + STAMP_BYTES : names_end]
            _pad(data, 8)
            data += _TRANSFORM[order].pack(*numbers)
        return bytes(data)


class _Place(NamedTuple):
    """The name of a stream; of a marker also its action, of a transform its frame and three offsets.

    They are those of its stamp, of what follows the frames' names, and of its numbers.
    """

    stream: str
    frame: str = ""
    stamp_at: int = 0
    names_end: int = 0
    numbers_at: int = 0
    action: int = 0


class _Streams(NamedTuple):
    """The streams of a message, and the bytes that decide them: ``constant``, as ``layout`` unpacks them."""

    names: tuple[str, ...]
    layout: struct.Struct
    constant: tuple[bytes, ...]
    places: tuple[_Place, ...] = ()
    deletion: int = 0


class PoseReader:
    """The pose in a PoseStamped, PoseWithCovarianceStamped or Odometry, one message after the other.

    ``frame_count`` is how many names of frames stand before it, the header's included; ``has_twist`` whether
    a covariance and a twist follow. While the names stay the same, the pose is found at once.
    """

    __slots__ = ("_end", "_frame_count", "_frames", "_has_twist")

    def __init__(self, frame_count: int, *, has_twist: bool) -> None:
        self._frame_count = frame_count
        self._has_twist = has_twist
        self._frames = b""
        self._end = -1

    def read(self, payload: bytes) -> tuple[bytes, tuple[float, ...]] | None:
        """The frames as they are written, and position, orientation and twist: 7 or 13 numbers."""
        order = byte_order(payload)
        if order is None:
            return None
        with suppress(struct.error):
            if self._end < 0 or payload[STAMPED_BYTES : self._end] != self._frames:
                uint32, end = struct.Struct(f"{order}I"), STAMPED_BYTES
                for _ in range(self._frame_count):
                    end = text_end(payload, aligned(end, 4), uint32)
                self._end, self._frames = end, payload[STAMPED_BYTES:end]
            numbers = (_POSE_AND_TWIST if self._has_twist else _TRANSFORM)[order]
            return self._frames, numbers.unpack_from(payload, aligned(self._end, 8))
        return None

    def moved(
        self, payload: bytes, at_ns: int, numbers: Sequence[float], variances: Sequence[float]
    ) -> bytes | None:
        """``payload``, which has a covariance, at another time and pose.

        The ``variances`` of x, y, z and of the rotations about them, in m² and rad², come on top of its own.
        """
        order = byte_order(payload)
        if order is None or self.read(payload) is None or not _can_be_stamp(at_ns):
            return None
        data, pose_at = bytearray(payload), aligned(self._end, 8)
        _STAMP[order].pack_into(data, HEADER_BYTES, *divmod(at_ns, NS_PER_S))
        _TRANSFORM[order].pack_into(data, pose_at, *numbers)
        covariance = list(_COVARIANCE[order].unpack_from(data, pose_at + _POSE_BYTES))
        for place, variance in enumerate(variances):
            covariance[7 * place] += variance
        _COVARIANCE[order].pack_into(data, pose_at + _POSE_BYTES, *covariance)
        return bytes(data)


class JointReader:
    """The joints in a JointState: names, positions and velocities, as long as each is."""

    __slots__ = ("_end", "_names", "_raw")

    def __init__(self) -> None:
        self._raw = b""
        self._end = -1
        self._names: tuple[str, ...] = ()

    def read(self, payload: bytes) -> tuple[tuple[str, ...], tuple[float, ...], tuple[float, ...]] | None:
        """``None`` where ``payload`` cannot be one."""
        order = byte_order(payload)
        if order is None:
            return None
        with suppress(struct.error):
            uint32 = struct.Struct(f"{order}I")
            if self._end < 0 or payload[STAMPED_BYTES : self._end] != self._raw:
                self._read_names(payload, uint32)
            positions, end = _doubles(payload, self._end, uint32, order)
            velocities, _ = _doubles(payload, end, uint32, order)
            return self._names, positions, velocities
        return None

    def moved(self, payload: bytes, at_ns: int, positions: Mapping[str, float]) -> bytes | None:
        """The joints of ``payload`` that ``positions`` has, at another time and there."""
        order, found = byte_order(payload), self.read(payload)
        if order is None or found is None or not _can_be_stamp(at_ns):
            return None
        names, uint32 = found[0], struct.Struct(f"{order}I")
        with suppress(struct.error):
            _, end = _doubles(payload, self._end, uint32, order)
            velocities, end = _doubles(payload, end, uint32, order)
            efforts, _ = _doubles(payload, end, uint32, order)
            kept = [place for place, name in enumerate(names) if name in positions]
            data = bytearray(payload[: text_end(payload, STAMPED_BYTES, uint32)])
            _STAMP[order].pack_into(data, HEADER_BYTES, *divmod(at_ns, NS_PER_S))
            _put_count(data, len(kept), uint32)
            for place in kept:
                name = names[place].encode("utf-8", "surrogateescape") + b"\0"
                _put_count(data, len(name), uint32)
                data += name
            for values in ([positions.get(name, 0.0) for name in names], velocities, efforts):
                numbers = [values[place] for place in kept] if len(values) == len(names) else []
                _put_count(data, len(numbers), uint32)
                if numbers:
                    _pad(data, 8)
                data += struct.pack(f"{order}{len(numbers)}d", *numbers)
            return bytes(data)
        return None

    def _read_names(self, payload: bytes, uint32: struct.Struct) -> None:
        self._end = -1
        at = aligned(text_end(payload, STAMPED_BYTES, uint32), 4)
        (count,) = uint32.unpack_from(payload, at)
        end, names = at + uint32.size, []
        for _ in range(min(count, MAX_ITEMS)):
            start = aligned(end, 4)
            end = text_end(payload, start, uint32)
            names.append(text_at(payload, start + uint32.size, end))
        self._end, self._raw, self._names = end, payload[STAMPED_BYTES:end], tuple(names)


def _doubles(payload: bytes, end: int, uint32: struct.Struct, order: str) -> tuple[tuple[float, ...], int]:
    """A sequence of float64 after ``end``, and where it ends."""
    at = aligned(end, 4)
    (count,) = uint32.unpack_from(payload, at)
    start = aligned(at + uint32.size, 8) if count else at + uint32.size
    return struct.unpack_from(f"{order}{min(count, MAX_ITEMS)}d", payload, start), start + 8 * count


def _put_count(data: bytearray, count: int, uint32: struct.Struct) -> None:
    _pad(data, 4)
    data += uint32.pack(count)


def _pad(data: bytearray, size: int) -> None:
    """Have what follows begin at a multiple of ``size``."""
    data += bytes(aligned(len(data), size) - len(data))


def _can_be_stamp(at_ns: int) -> bool:
    return -_SECONDS <= at_ns // NS_PER_S < _SECONDS


def _header_stamp(payload: Payload) -> tuple[int, int] | None:
    order = byte_order(payload)
    if order is None or len(payload) < STAMPED_BYTES:
        return None
    sec, nanosec = struct.unpack_from(f"{order}iI", payload, HEADER_BYTES)
    return (sec, nanosec) if nanosec < NS_PER_S else None


def _transforms(walk: CdrWalk) -> Iterator[_Place]:
    """By child frame."""
    for _ in walk.items():
        stamp_at = walk.skip(STAMP_BYTES, 4)
        frame, child_frame = walk.text(), walk.text()
        names_end = walk.at
        yield _Place(child_frame, frame, stamp_at, names_end, walk.skip(_POSE_BYTES, 8))


def _statuses(walk: CdrWalk) -> Iterator[_Place]:
    """By name."""
    walk.header()
    for _ in walk.items():
        walk.skip(_LEVEL_BYTES, 1)
        yield _Place(walk.text())
        walk.skip_texts(2)
        walk.skip_texts(2 * len(walk.items()))


def _joints(walk: CdrWalk) -> Iterator[_Place]:
    """By the set of names: some of a robot's joints are another stream than its others."""
    walk.header()
    names = {walk.text() for _ in walk.items()}
    for _ in range(3):
        walk.array(8, 8)
    if names:
        yield _Place("\0".join(sorted(names)))


def _markers(walk: CdrWalk, *, has_files: bool, is_array: bool) -> Iterator[_Place]:
    """By ns and id; of thousands of markers the first decide, as what deletes all stands first."""
    try:
        for _ in range(walk.count()) if is_array else range(1):
            yield _marker(walk, has_files=has_files)
    except TooLongError:
        return
    if len(walk.payload) - walk.at >= _MOST_PADDING:
        raise struct.error("these are markers of another version of ROS")


def _marker(walk: CdrWalk, *, has_files: bool) -> _Place:
    """From Humble on, markers have textures and files of meshes."""
    walk.header()
    stream = f"{walk.text()}/{walk.number()}"
    walk.skip(4, 4)  # type
    place = _Place(stream, action=walk.number())
    walk.skip(_POSE_BYTES + 3 * 8, 8)
    walk.skip(4 * 4 + STAMP_BYTES, 4)  # color and lifetime
    walk.skip(1, 1)
    walk.array(3 * 8, 8)
    walk.array(4 * 4, 4)
    if has_files:
        walk.skip_texts()
        walk.header()
        walk.skip_texts()
        walk.array(1, 1)
        walk.array(2 * 4, 4)
    walk.skip_texts(2)
    if has_files:
        walk.skip_texts()
        walk.array(1, 1)
    walk.skip(1, 1)
    return place


_TRANSFORMS = "tf2_msgs/msg/TFMessage"
_Read = Callable[[CdrWalk], Iterator[_Place]]

STREAM_TYPES: Mapping[str, Sequence[_Read]] = MappingProxyType(
    {
        _TRANSFORMS: (_transforms,),
        "diagnostic_msgs/msg/DiagnosticArray": (_statuses,),
        "sensor_msgs/msg/JointState": (_joints,),
        **{
            f"visualization_msgs/msg/{name}": (
                partial(_markers, has_files=True, is_array=is_array),
                partial(_markers, has_files=False, is_array=is_array),
            )
            for name, is_array in (("Marker", False), ("MarkerArray", True))
        },
    }
)
"""Types whose messages say which streams of their topic they belong to, each with the ways to read one."""

_NO_STREAMS = _Streams((), struct.Struct(""), ())


def _read_streams(payload: Payload, ways: Sequence[_Read]) -> _Streams:
    order = byte_order(payload)
    if order is None:
        return _NO_STREAMS
    for read in ways:
        with suppress(struct.error):
            walk = CdrWalk(payload, order)
            places = tuple(read(walk))
            layout = walk.layout()
            names = dict.fromkeys(_short(place.stream) for place in places)
            actions = {place.action for place in places}
            deletion = next((action for action in (DELETE_ALL, DELETE) if action in actions), 0)
            return _Streams(tuple(names), layout, layout.unpack(payload), places, deletion)
    return _NO_STREAMS


def _short(name: str) -> str:
    """A name that is as unique, but does not fill the memory where thousands are kept."""
    if len(name) <= _MOST_LETTERS:
        return name
    return hashlib.sha256(name.encode("utf-8", "surrogateescape")).hexdigest()
