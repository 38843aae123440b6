# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Reads the few fields that are needed of serialized messages (CDR, either endian), and writes texts.

Plain CDR as ROS 2 writes it: a 4-byte encapsulation header, then the fields, each aligned to its size
counted from the end of that header (OMG DDS-XTYPES 1.3, 7.4.1 and 7.6.2). Nothing here raises on any bytes.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping, Sequence
from contextlib import suppress
from types import MappingProxyType
from typing import NamedTuple

from smarttestudo.domain.units import NS_PER_S

HEADER_BYTES = 4
STAMP_BYTES = 8
STAMPED_BYTES = HEADER_BYTES + STAMP_BYTES
MAX_TRANSFORMS = 10_000
MAX_KNOWN_LAYOUTS = 64

_LENGTH_END = HEADER_BYTES + 4
_BIG_ENDIAN = b"\x00\x00"
_LITTLE_ENDIAN = b"\x00\x01"
_TRANSFORM_BYTES = 7 * 8
_STAMP = MappingProxyType({order: struct.Struct(f"{order}iI") for order in "<>"})
_TRANSFORM = MappingProxyType({order: struct.Struct(f"{order}7d") for order in "<>"})
_POSE_BYTES = 7 * 8
_SECONDS = 2**31
"""What the seconds of a stamp, an int32, stay below."""
_COVARIANCE = MappingProxyType({order: struct.Struct(f"{order}36d") for order in "<>"})
_POSE_AND_TWIST = MappingProxyType({order: struct.Struct(f"{order}7d288x6d") for order in "<>"})

Payload = bytes | bytearray | memoryview


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
    """A serialized std_msgs/msg/String."""
    data = text.encode() + b"\0"
    return _LITTLE_ENDIAN + bytes(2) + struct.pack("<I", len(data)) + data


def string_text(payload: Payload) -> str | None:
    """The text of a serialized std_msgs/msg/String; ``None`` if it cannot be one."""
    order = _byte_order(payload)
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


def child_frames(payload: Payload) -> tuple[str, ...]:
    """The child frames of a tf2_msgs/msg/TFMessage, each once, in their order; none if it cannot be one."""
    return _read_transforms(payload).frames


class Transform(NamedTuple):
    """One transform of a TFMessage: ``numbers`` are its translation x y z and its rotation x y z w."""

    frame: str
    child_frame: str
    stamp_ns: int
    numbers: tuple[float, ...]


class FrameReader:
    """``child_frames`` for one message of a topic after the other, at once where the frames stay the same.

    The messages of a broadcaster differ in stamps and transforms only: what lies between those is compared
    with the last message of the same length in one go.
    """

    __slots__ = ("_known",)

    def __init__(self) -> None:
        self._known: dict[int, _Transforms] = {}

    def child_frames(self, payload: Payload) -> tuple[str, ...]:
        """Result of the function ``child_frames`` for ``payload``."""
        return self._read(payload).frames

    def transforms(self, payload: Payload) -> list[Transform]:
        """The transforms of ``payload``, in their order; none if it cannot be a TFMessage."""
        order = _byte_order(payload)
        if order is None:
            return []
        stamp, numbers = _STAMP[order], _TRANSFORM[order]
        transforms = []
        for frame, child_frame, stamp_at, _, numbers_at in self._read(payload).places:
            sec, nanosec = stamp.unpack_from(payload, stamp_at)
            at_ns = sec * NS_PER_S + nanosec
            transforms.append(Transform(frame, child_frame, at_ns, numbers.unpack_from(payload, numbers_at)))
        return transforms

    def moved(self, payload: bytes, transforms: Mapping[str, tuple[int, Sequence[float]]]) -> bytes | None:
        """The transforms of ``payload`` to these child frames, each with another time and other numbers."""
        order = _byte_order(payload)
        places = [place for place in self._read(payload).places if place[1] in transforms]
        if order is None or not all(_can_be_stamp(at_ns) for at_ns, _ in transforms.values()):
            return None
        data = bytearray(payload[:HEADER_BYTES]) + struct.pack(f"{order}I", len(places))
        for _, child_frame, stamp_at, names_end, _ in places:
            at_ns, numbers = transforms[child_frame]
            _pad(data, 4)
            data += _STAMP[order].pack(*divmod(at_ns, NS_PER_S))
            # A stamp begins at a multiple of 4, so what is between the two names is as it was.
            data += payload[stamp_at + STAMP_BYTES : names_end]
            _pad(data, 8)
            data += _TRANSFORM[order].pack(*numbers)
        return bytes(data)

    def _read(self, payload: Payload) -> _Transforms:
        known = self._known.get(len(payload))
        if known is not None and known.layout.unpack(payload) == known.constant:
            return known
        transforms = _read_transforms(payload)
        if transforms.frames:
            if len(self._known) >= MAX_KNOWN_LAYOUTS:
                self._known.clear()
            self._known[len(payload)] = transforms
        return transforms


class _Transforms(NamedTuple):
    """The frames of a TFMessage, and the bytes that decide them: ``constant``, as ``layout`` unpacks them.

    ``places`` are, by transform, its frames and the offsets of its stamp, of what follows the frames' names,
    and of its numbers.
    """

    frames: tuple[str, ...]
    layout: struct.Struct
    constant: tuple[bytes, ...]
    places: tuple[tuple[str, str, int, int, int], ...] = ()


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
        order = _byte_order(payload)
        if order is None:
            return None
        with suppress(struct.error):
            if self._end < 0 or payload[STAMPED_BYTES : self._end] != self._frames:
                uint32, end = struct.Struct(f"{order}I"), STAMPED_BYTES
                for _ in range(self._frame_count):
                    end = _string_end(payload, _aligned(end, 4), uint32)
                self._end, self._frames = end, payload[STAMPED_BYTES:end]
            numbers = (_POSE_AND_TWIST if self._has_twist else _TRANSFORM)[order]
            return self._frames, numbers.unpack_from(payload, _aligned(self._end, 8))
        return None

    def moved(
        self, payload: bytes, at_ns: int, numbers: Sequence[float], variances: Sequence[float]
    ) -> bytes | None:
        """``payload``, which has a covariance, at another time and pose.

        The ``variances`` of x, y, z and of the rotations about them, in m² and rad², come on top of its own.
        """
        order = _byte_order(payload)
        if order is None or self.read(payload) is None or not _can_be_stamp(at_ns):
            return None
        data, pose_at = bytearray(payload), _aligned(self._end, 8)
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
        order = _byte_order(payload)
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
        order, found = _byte_order(payload), self.read(payload)
        if order is None or found is None or not _can_be_stamp(at_ns):
            return None
        names, uint32 = found[0], struct.Struct(f"{order}I")
        with suppress(struct.error):
            _, end = _doubles(payload, self._end, uint32, order)
            velocities, end = _doubles(payload, end, uint32, order)
            efforts, _ = _doubles(payload, end, uint32, order)
            kept = [place for place, name in enumerate(names) if name in positions]
            data = bytearray(payload[: _string_end(payload, STAMPED_BYTES, uint32)])
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
        at = _aligned(_string_end(payload, STAMPED_BYTES, uint32), 4)
        (count,) = uint32.unpack_from(payload, at)
        end, names = at + uint32.size, []
        for _ in range(min(count, MAX_TRANSFORMS)):
            start = _aligned(end, 4)
            end = _string_end(payload, start, uint32)
            names.append(_text(payload, start + uint32.size, end))
        self._end, self._raw, self._names = end, payload[STAMPED_BYTES:end], tuple(names)


def _doubles(payload: bytes, end: int, uint32: struct.Struct, order: str) -> tuple[tuple[float, ...], int]:
    """A sequence of float64 after ``end``, and where it ends."""
    at = _aligned(end, 4)
    (count,) = uint32.unpack_from(payload, at)
    start = _aligned(at + uint32.size, 8) if count else at + uint32.size
    return struct.unpack_from(f"{order}{min(count, MAX_TRANSFORMS)}d", payload, start), start + 8 * count


def _put_count(data: bytearray, count: int, uint32: struct.Struct) -> None:
    _pad(data, 4)
    data += uint32.pack(count)


def _pad(data: bytearray, size: int) -> None:
    """Have what follows begin at a multiple of ``size``."""
    data += bytes(_aligned(len(data), size) - len(data))


def _can_be_stamp(at_ns: int) -> bool:
    return -_SECONDS <= at_ns // NS_PER_S < _SECONDS


def _header_stamp(payload: Payload) -> tuple[int, int] | None:
    order = _byte_order(payload)
    if order is None or len(payload) < STAMPED_BYTES:
        return None
    sec, nanosec = struct.unpack_from(f"{order}iI", payload, HEADER_BYTES)
    return (sec, nanosec) if nanosec < NS_PER_S else None


def _byte_order(payload: Payload) -> str | None:
    encapsulation = bytes(payload[:2])
    if encapsulation == _LITTLE_ENDIAN:
        return "<"
    return ">" if encapsulation == _BIG_ENDIAN else None


_NO_TRANSFORMS = _Transforms((), struct.Struct(""), ())


def _read_transforms(payload: Payload) -> _Transforms:
    order = _byte_order(payload)
    if order is not None:
        with suppress(struct.error):
            return _transforms(payload, struct.Struct(f"{order}I"))
    return _NO_TRANSFORMS


def _transforms(payload: Payload, uint32: struct.Struct) -> _Transforms:
    (count,) = uint32.unpack_from(payload, HEADER_BYTES)
    if count > MAX_TRANSFORMS:
        return _NO_TRANSFORMS
    frames: dict[str, None] = {}
    end = HEADER_BYTES + uint32.size
    fields = [f"{end}s"]
    places = []
    for _ in range(count):
        stamp_at = _aligned(end, 4)
        frame_id_at = stamp_at + STAMP_BYTES
        child_at = _aligned(_string_end(payload, frame_id_at, uint32), 4)
        child_end = _string_end(payload, child_at, uint32)
        frame = _text(payload, frame_id_at + uint32.size, _string_end(payload, frame_id_at, uint32))
        child_frame = _text(payload, child_at + uint32.size, child_end)
        frames[child_frame] = None
        places.append((frame, child_frame, stamp_at, child_end, _aligned(child_end, 8)))
        fields.append(f"{frame_id_at - end}x{child_end - frame_id_at}s")
        end = _aligned(child_end, 8) + _TRANSFORM_BYTES
        fields.append(f"{end - child_end}x")
    if end > len(payload):
        return _NO_TRANSFORMS
    layout = struct.Struct("".join((*fields, f"{len(payload) - end}x")))
    return _Transforms(tuple(frames), layout, layout.unpack(payload), tuple(places))


def _aligned(offset: int, size: int) -> int:
    return HEADER_BYTES + -(-(offset - HEADER_BYTES) // size) * size


def _string_end(payload: Payload, length_at: int, uint32: struct.Struct) -> int:
    (length,) = uint32.unpack_from(payload, length_at)
    return length_at + uint32.size + int(length)


def _text(payload: Payload, start: int, end: int) -> str:
    return bytes(payload[start:end]).rstrip(b"\x00").decode("utf-8", "surrogateescape")
