# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Reads the few fields that pacing needs from serialized messages (CDR, little and big endian).

Plain CDR as ROS 2 writes it: a 4-byte encapsulation header, then the fields, each aligned to its size
counted from the end of that header (OMG DDS-XTYPES 1.3, 7.4.1 and 7.6.2). Nothing here raises on any bytes.
"""

from __future__ import annotations

import struct

HEADER_BYTES = 4
STAMP_BYTES = 8
MAX_TRANSFORMS = 10_000

_BIG_ENDIAN = b"\x00\x00"
_LITTLE_ENDIAN = b"\x00\x01"
_TRANSFORM_BYTES = 7 * 8
_NS_PER_S = 1_000_000_000

Payload = bytes | bytearray | memoryview


def header_stamp(payload: Payload) -> bytes | None:
    """``header.stamp`` of a message that begins with a std_msgs/Header; ``None`` if it cannot be one.

    The 8 bytes of sec (int32) and nanosec (uint32), always in little endian: equal stamps are equal bytes.
    """
    order = _byte_order(payload)
    if order is None or len(payload) < HEADER_BYTES + STAMP_BYTES:
        return None
    sec, nanosec = struct.unpack_from(f"{order}iI", payload, HEADER_BYTES)
    return struct.pack("<iI", sec, nanosec) if nanosec < _NS_PER_S else None


def child_frames(payload: Payload) -> tuple[str, ...]:
    """The child frames of a tf2_msgs/msg/TFMessage, each once, in their order; none if it cannot be one."""
    order = _byte_order(payload)
    if order is None:
        return ()
    try:
        return _child_frames(payload, struct.Struct(f"{order}I"))
    except struct.error:
        return ()


def _byte_order(payload: Payload) -> str | None:
    encapsulation = bytes(payload[:2])
    if encapsulation == _LITTLE_ENDIAN:
        return "<"
    return ">" if encapsulation == _BIG_ENDIAN else None


def _child_frames(payload: Payload, uint32: struct.Struct) -> tuple[str, ...]:
    (count,) = uint32.unpack_from(payload, HEADER_BYTES)
    if count > MAX_TRANSFORMS:
        return ()
    frames: dict[str, None] = {}
    end = HEADER_BYTES + uint32.size
    for _ in range(count):
        frame_id_at = _aligned(end, 4) + STAMP_BYTES
        child_at = _aligned(_string_end(payload, frame_id_at, uint32), 4)
        child_end = _string_end(payload, child_at, uint32)
        frames[_text(payload, child_at + uint32.size, child_end)] = None
        end = _aligned(child_end, 8) + _TRANSFORM_BYTES
    return tuple(frames) if end <= len(payload) else ()


def _aligned(offset: int, size: int) -> int:
    return HEADER_BYTES + -(-(offset - HEADER_BYTES) // size) * size


def _string_end(payload: Payload, length_at: int, uint32: struct.Struct) -> int:
    (length,) = uint32.unpack_from(payload, length_at)
    return length_at + uint32.size + int(length)


def _text(payload: Payload, start: int, end: int) -> str:
    return bytes(payload[start:end]).rstrip(b"\x00").decode("utf-8", "surrogateescape")
