# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Coded video: which messages begin a group, and which are differences to the one before.

They are read from the first bytes of a message. Nothing here raises on any bytes, and what a message costs
does not depend on its size.
"""

from __future__ import annotations

import re
import struct
from collections.abc import Callable, Iterator, Mapping
from enum import Enum
from functools import lru_cache
from types import MappingProxyType
from typing import NamedTuple

from smarttestudo.domain.names import short_type_name
from smarttestudo.domain.robot import Payload
from smarttestudo.pacing.cdr_walk import HEADER_BYTES, aligned, byte_order

READ_BYTES = 16_384
"""So much of a bitstream is read: parameters and notes stand before the first slice, and are short."""
_MOST_UNITS = 64
_MOST_NAME_BYTES = 256


class VideoFrame(Enum):
    """Place of a message of coded video, for a decoder."""

    KEY = "key"
    """It can be decoded without others."""
    DIFFERENCE = "difference"
    """It can be decoded after all others back to a key frame."""
    PARAMETERS = "parameters"
    """What a decoder must know before the key frame that follows, alone."""
    UNKNOWN = "unknown"
    """Its coder is not known, or its bytes are none of that coder."""


_FIELDS: Mapping[str, str] = MappingProxyType(
    {
        "foxglove_msgs/CompressedVideo": "tsdc",
        "sensor_msgs/CompressedImage": "tscd",
        "ffmpeg_image_transport_msgs/FFMPEGPacket": "tsiicqkbd",
        "theora_image_transport/Packet": "tsd",
    }
)
"""The fields of each type: a stamp, strings, c the name of a coder, integers, k flags of which the lowest
says that it is a key frame, and d, the bitstream."""
_CODERS: Mapping[str, str] = MappingProxyType({"theora_image_transport/Packet": "theora"})
_IMAGES = "sensor_msgs/CompressedImage"
IMAGE_TYPES = frozenset({"sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage"})
"""The types whose messages are one image each, as far as they are no coded video."""
_IMAGE_BEGINNINGS = (b"\xff\xd8\xff", b"\x89PNG", b"RIFF", b"II*\0", b"MM\0*")
"""Of JPEG, PNG, WebP and TIFF, whatever the format says."""


def is_coded_video(type_name: str) -> bool:
    """Whether all messages of a type are coded video; those of CompressedImage may be."""
    short = short_type_name(type_name)
    return short in _FIELDS and short != _IMAGES


def may_be_coded_video(type_name: str, topic: str) -> bool:
    """The same, where of a CompressedImage the last name of its topic names a coder, as transports do."""
    last_name = topic.rpartition("/")[2]
    return is_coded_video(type_name) or (
        short_type_name(type_name) == _IMAGES and _coder(last_name) is not None
    )


class VideoReader:
    """Reads the frames of a topic's messages."""

    __slots__ = ("_coder", "_fields", "_may_be_image")

    def __init__(self, type_name: str) -> None:
        short = short_type_name(type_name)
        self._fields = _FIELDS[short]
        self._coder = _CODERS.get(short, "")
        self._may_be_image = short == _IMAGES

    @staticmethod
    def of(type_name: str) -> VideoReader | None:
        """The reader for a type whose messages may be coded video."""
        return VideoReader(type_name) if short_type_name(type_name) in _FIELDS else None

    def frame(self, payload: Payload) -> VideoFrame | None:
        """The frame in ``payload``; ``None`` for an image that stands by itself."""
        try:
            found = _bitstream(payload, self._fields)
        except struct.error:
            return None if self._may_be_image else VideoFrame.UNKNOWN
        read = _coder(self._coder or found.coder)
        if self._may_be_image and (read is None or found.beginning.startswith(_IMAGE_BEGINNINGS)):
            return None
        if found.is_key:
            return VideoFrame.KEY
        frame = VideoFrame.UNKNOWN if read is None else read(found.beginning, found.size_bytes)
        # Who says of a packet whether it is a key frame knows it of all.
        return VideoFrame.DIFFERENCE if frame is VideoFrame.UNKNOWN and "k" in self._fields else frame


class _Bitstream(NamedTuple):
    """The beginning of a bitstream of so many bytes, and what its message says of it."""

    coder: str
    is_key: bool
    beginning: bytes
    size_bytes: int


_SIZES = MappingProxyType({"t": (4, 8), "i": (4, 4), "q": (8, 8), "b": (1, 1)})
"""Alignment and size of what is skipped."""


def _bitstream(payload: Payload, fields: str) -> _Bitstream:
    """Raises ``struct.error`` where ``payload`` is no CDR, or ends before its fields do."""
    order = byte_order(payload[:2])
    if order is None:
        raise struct.error
    at, coder, is_key, beginning, size_bytes = HEADER_BYTES, "", False, b"", 0
    for field in fields:
        if field in _SIZES:
            alignment, size = _SIZES[field]
            at = aligned(at, alignment) + size
        elif field == "k":
            (flags,) = struct.unpack("B", payload[at : at + 1])
            is_key = bool(flags & 1)
            at += 1
        else:
            at = aligned(at, 4)
            (size,) = struct.unpack(f"{order}I", payload[at : at + 4])
            at += 4
            if field == "d":
                beginning, size_bytes = payload[at : at + min(size, READ_BYTES)], size
            elif field == "c":
                coder = payload[at : at + min(size, _MOST_NAME_BYTES)].decode("ascii", "replace")
            at += size
    if at > len(payload):
        raise struct.error
    return _Bitstream(coder, is_key, beginning, size_bytes)


_ReadFrame = Callable[[bytes, int], VideoFrame]


@lru_cache(maxsize=64)
def _coder(name: str) -> _ReadFrame | None:
    """How to read what a coder of this name made; ``None`` for one that is not known, or codes images."""
    lower = name.lower().replace(".", "")
    return next((read for pattern, read in _READERS.items() if re.search(pattern, lower)), None)


def _h264(data: bytes, size_bytes: int) -> VideoFrame:
    """NAL units of ITU-T H.264, 7.4.1: 1 to 5 are slices, 7 and 8 parameters."""
    has_parameters = False
    for at in _nal_units(data, size_bytes):
        kind = data[at] & 0x1F
        has_parameters |= kind in (7, 8, 15)
        if kind == 5:
            return VideoFrame.KEY
        if 1 <= kind <= 4:
            # Behind parameters a decoder may begin with an estimate that refers to none before.
            begins = has_parameters and _is_intra(data[at + 1 : at + 9])
            return VideoFrame.KEY if begins else VideoFrame.DIFFERENCE
    return _without_slice(data, has_parameters=has_parameters)


def _h265(data: bytes, size_bytes: int) -> VideoFrame:
    """NAL units of ITU-T H.265, 7.4.2.2: below 32 slices, of which 16 to 23 are random access points."""
    has_parameters = False
    for at in _nal_units(data, size_bytes):
        kind = data[at] >> 1 & 0x3F
        has_parameters |= 32 <= kind <= 34
        if kind < 32:
            return VideoFrame.KEY if 16 <= kind <= 23 else VideoFrame.DIFFERENCE
    return _without_slice(data, has_parameters=has_parameters)


def _without_slice(data: bytes, *, has_parameters: bool) -> VideoFrame:
    return VideoFrame.PARAMETERS if has_parameters else VideoFrame.UNKNOWN if data else VideoFrame.DIFFERENCE


def _nal_units(data: bytes, size_bytes: int) -> Iterator[int]:
    """Where the first units begin: after start codes, or each after its length in four bytes."""
    has_lengths = not data.startswith(b"\0\0") or not data.lstrip(b"\0").startswith(b"\1")
    if data.startswith(b"\0\0\1"):
        has_lengths = 4 + int.from_bytes(data[:4], "big") == size_bytes
    at = 0
    for _ in range(_MOST_UNITS):
        if has_lengths:
            length = int.from_bytes(data[at : at + 4], "big")
            start, at = at + 4, at + 4 + length
        else:
            length = data.find(b"\0\0\1", at) + 1
            start = at = length + 2
        if length == 0 or start >= len(data):
            return
        yield start


def _is_intra(slice_header: bytes) -> bool:
    """Whether ``slice_type``, after ``first_mb_in_slice``, is that of an I slice."""
    bits = "".join(f"{byte:08b}" for byte in slice_header)
    numbers = []
    for _ in range(2):
        zeros = len(bits) - len(bits.lstrip("0"))
        numbers.append(int(bits[zeros : 2 * zeros + 1] or "0", 2) - 1)
        bits = bits[2 * zeros + 1 :]
    return numbers[1] % 5 == 2


def _av1(data: bytes, _: int) -> VideoFrame:
    """Open bitstream units of AV1, 5.3: 1 is a sequence header, 3 and 6 begin with a frame header."""
    at, has_parameters = 0, False
    for _unit in range(_MOST_UNITS):
        header = data[at : at + 1]
        if not header or header[0] & 0x80:
            break
        kind, has_size = header[0] >> 3 & 0xF, header[0] & 2
        at += 2 if header[0] & 4 else 1
        size, shift = len(data) - at, 0
        if has_size:
            size = 0
            while at < len(data) and shift < 56:
                size |= (data[at] & 0x7F) << shift
                shift, at = shift + 7, at + 1
                if not data[at - 1] & 0x80:
                    break
        if kind == 1:
            has_parameters = True
        elif kind in (3, 6) and at < len(data):
            # show_existing_frame, and two bits of frame_type, of which 0 is a key frame
            return VideoFrame.DIFFERENCE if data[at] & 0xE0 else VideoFrame.KEY
        at += size
    return _without_slice(data, has_parameters=has_parameters)


def _vp9(data: bytes, _: int) -> VideoFrame:
    """The first byte of the uncompressed header of VP9, 6.2: marker, profile, show_existing_frame, type."""
    if not data or data[0] >> 6 != 2:
        return VideoFrame.UNKNOWN if data else VideoFrame.DIFFERENCE
    # Profile 3 has a reserved bit behind it.
    show_and_type = data[0] >> (1 if data[0] & 0x30 == 0x30 else 2) & 3
    return VideoFrame.DIFFERENCE if show_and_type else VideoFrame.KEY


def _vp8(data: bytes, _: int) -> VideoFrame:
    """The lowest bit of the frame tag (RFC 6386, 9.1)."""
    return VideoFrame.KEY if data and not data[0] & 1 else VideoFrame.DIFFERENCE


def _theora(data: bytes, _: int) -> VideoFrame:
    """The first two bits of a packet of Theora, 7.1: of headers, and of differences."""
    if data and data[0] & 0x80:
        return VideoFrame.PARAMETERS
    return VideoFrame.KEY if data and not data[0] & 0x40 else VideoFrame.DIFFERENCE


def _other(_: bytes, __: int) -> VideoFrame:
    return VideoFrame.UNKNOWN


_READERS: Mapping[str, _ReadFrame] = MappingProxyType(
    {
        r"(h|(?<!\d)x)264(?!\d)|(?<![0-9a-z])avc(?![a-z])": _h264,
        r"(h|(?<!\d)x)265(?!\d)|hevc|(?<![0-9a-z])(hev1|hvc1)": _h265,
        r"(?<![0-9a-z])(lib)?(svt)?av0?1": _av1,
        r"(?<![0-9a-z])vp0?9": _vp9,
        r"(?<![0-9a-z])vp0?8": _vp8,
        r"theora": _theora,
        r"(?<![0-9a-z])mpeg[24]": _other,
    }
)
"""By patterns of the names of coders, encoders and formats, without dots, that sizes of images do not fit."""


class VideoGroup:
    """Whether the next frame of a stream can be decoded by who has the frames that were not left out.

    Unless it ``is_known``, no key frame arrived yet, and none is worth less than another. While it
    ``awaits_key``, there were parameters last, and what else stands before a key frame.
    """

    __slots__ = ("_was_broken", "awaits_key", "is_broken", "is_known")

    def __init__(self) -> None:
        self.is_known = False
        self.is_broken = False
        self.awaits_key = False
        self._was_broken = False

    def take(self, frame: VideoFrame | None) -> bool:
        """Have ``frame``, or an image by itself, as the next one; whether a group begins with it."""
        awaited_key = self.awaits_key
        begins = begins_group(frame) and not awaited_key
        self.awaits_key = frame is VideoFrame.PARAMETERS or (awaited_key and frame is VideoFrame.UNKNOWN)
        if begins:
            self._was_broken, self.is_known, self.is_broken = self.is_broken, True, False
        elif awaited_key and frame is VideoFrame.DIFFERENCE:
            # Some coders repeat their parameters where no group begins.
            self.is_broken |= self._was_broken
        return begins


def begins_group(frame: VideoFrame | None) -> bool:
    """Whether a group begins with ``frame``, or with the parameters before it."""
    return frame is None or frame is VideoFrame.KEY or frame is VideoFrame.PARAMETERS
