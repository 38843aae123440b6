# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Reads the few fields that pacing needs from serialized messages (CDR, either endian), and writes texts.

Plain CDR as ROS 2 writes it: a 4-byte encapsulation header, then the fields, each aligned to its size
counted from the end of that header (OMG DDS-XTYPES 1.3, 7.4.1 and 7.6.2). Nothing here raises on any bytes.
"""

from __future__ import annotations

import struct
from contextlib import suppress
from typing import NamedTuple

from smarttestudo.domain.units import NS_PER_S

HEADER_BYTES = 4
STAMP_BYTES = 8
STAMPED_BYTES = HEADER_BYTES + STAMP_BYTES
MAX_TRANSFORMS = 10_000
MAX_KNOWN_LAYOUTS = 64

_BIG_ENDIAN = b"\x00\x00"
_LITTLE_ENDIAN = b"\x00\x01"
_TRANSFORM_BYTES = 7 * 8

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


def child_frames(payload: Payload) -> tuple[str, ...]:
    """The child frames of a tf2_msgs/msg/TFMessage, each once, in their order; none if it cannot be one."""
    return _read_transforms(payload).frames


class FrameReader:
    """``child_frames`` for one message of a topic after the other, at once where the frames stay the same.

    The messages of a broadcaster differ in stamps and transforms only: what lies between those is compared
    with the last message of the same length in one go.
    """

    __slots__ = ("_known",)

    def __init__(self) -> None:
        self._known: dict[int, _Transforms] = {}

    def child_frames(self, payload: Payload) -> tuple[str, ...]:
        """What ``child_frames`` gives for ``payload``."""
        known = self._known.get(len(payload))
        if known is not None and known.layout.unpack(payload) == known.constant:
            return known.frames
        transforms = _read_transforms(payload)
        if transforms.frames:
            if len(self._known) >= MAX_KNOWN_LAYOUTS:
                self._known.clear()
            self._known[len(payload)] = transforms
        return transforms.frames


class _Transforms(NamedTuple):
    """The frames of a TFMessage, and the bytes that decide them: ``constant``, as ``layout`` unpacks them."""

    frames: tuple[str, ...]
    layout: struct.Struct
    constant: tuple[bytes, ...]


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
    for _ in range(count):
        frame_id_at = _aligned(end, 4) + STAMP_BYTES
        child_at = _aligned(_string_end(payload, frame_id_at, uint32), 4)
        child_end = _string_end(payload, child_at, uint32)
        frames[_text(payload, child_at + uint32.size, child_end)] = None
        fields.append(f"{frame_id_at - end}x{child_end - frame_id_at}s")
        end = _aligned(child_end, 8) + _TRANSFORM_BYTES
        fields.append(f"{end - child_end}x")
    if end > len(payload):
        return _NO_TRANSFORMS
    layout = struct.Struct("".join((*fields, f"{len(payload) - end}x")))
    return _Transforms(tuple(frames), layout, layout.unpack(payload))


def _aligned(offset: int, size: int) -> int:
    return HEADER_BYTES + -(-(offset - HEADER_BYTES) // size) * size


def _string_end(payload: Payload, length_at: int, uint32: struct.Struct) -> int:
    (length,) = uint32.unpack_from(payload, length_at)
    return length_at + uint32.size + int(length)


def _text(payload: Payload, start: int, end: int) -> str:
    return bytes(payload[start:end]).rstrip(b"\x00").decode("utf-8", "surrogateescape")
