# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A way through a serialized message, field by field, without decoding it.

Plain CDR as ROS 2 writes it: a 4-byte encapsulation header, then the fields, each aligned to its size
counted from the end of that header (OMG DDS-XTYPES 1.3, 7.4.1 and 7.6.2).
"""

from __future__ import annotations

import struct

HEADER_BYTES = 4
STAMP_BYTES = 8
MAX_ITEMS = 10_000
"""Elements of a sequence that is gone through."""
MAX_STEPS = 100_000
"""Texts and sequences that are looked for in one message."""

_ALIGNMENT = 4
_BIG_ENDIAN = b"\x00\x00"
_LITTLE_ENDIAN = b"\x00\x01"

Payload = bytes | bytearray | memoryview


class TooLongError(struct.error):
    """A message has more in it than is looked at."""


class CdrWalk:
    """A way through a message from field to field, which raises ``struct.error`` where it cannot go on.

    All lengths on it are kept, and those texts and numbers of which the caller wants to know.
    """

    __slots__ = ("_int32", "_kept", "_steps", "_uint32", "at", "payload")

    def __init__(self, payload: Payload, order: str) -> None:
        self.payload = payload
        self.at = HEADER_BYTES
        self._uint32, self._int32 = struct.Struct(f"{order}I"), struct.Struct(f"{order}i")
        self._kept = [(0, HEADER_BYTES)]
        self._steps = 0

    def skip(self, size_bytes: int, alignment: int) -> int:
        """Pass over what has that size and alignment; where it begins."""
        start = aligned(self.at, alignment)
        self.at = start + size_bytes
        return start

    def items(self) -> range:
        """The numbers of the elements of a sequence that begins here."""
        count = self.count()
        if count > MAX_ITEMS:
            raise struct.error
        return range(count)

    def count(self) -> int:
        """How many elements a sequence has that begins here, or bytes a text."""
        self._steps += 1
        start = self.skip(self._uint32.size, 4)
        (length,) = self._uint32.unpack_from(self.payload, start)
        if length > len(self.payload):
            raise struct.error
        if self._steps > MAX_STEPS:
            raise TooLongError
        self._keep(start)
        return int(length)

    def array(self, size_bytes: int, alignment: int) -> None:
        """Pass over a sequence of elements of that size and alignment."""
        if count := self.count():
            self.skip(count * size_bytes, alignment)

    def number(self) -> int:
        """An int32, which is kept."""
        start = self.skip(self._int32.size, 4)
        self._keep(start)
        (number,) = self._int32.unpack_from(self.payload, start)
        return int(number)

    def text(self) -> str:
        """A text, which is kept."""
        start = self.skip(self.count(), 1)
        self._keep(start)
        return text_at(self.payload, start, self.at)

    def skip_texts(self, count: int = 1) -> None:
        for _ in range(count):
            self.skip(self.count(), 1)

    def header(self) -> None:
        self.skip(STAMP_BYTES, 4)
        self.skip_texts()

    def layout(self) -> struct.Struct:
        """The bytes that were kept on the way, as fields of the whole message."""
        if self.at > len(self.payload):
            raise struct.error
        fields, end = [], 0
        for start, kept_end in self._kept:
            fields.append(f"{start - end}x{kept_end - start}s")
            end = kept_end
        return struct.Struct("".join((*fields, f"{len(self.payload) - end}x")))

    def _keep(self, start: int) -> None:
        """Keep what begins at ``start`` and ends here, together with what was kept just before it."""
        last_start, last_end = self._kept[-1]
        if start - last_end < _ALIGNMENT:
            self._kept[-1] = (last_start, self.at)
        else:
            self._kept.append((start, self.at))


def byte_order(payload: Payload) -> str | None:
    """The byte order as ``struct`` writes it; ``None`` where this is no plain CDR."""
    encapsulation = bytes(payload[:2])
    if encapsulation == _LITTLE_ENDIAN:
        return "<"
    return ">" if encapsulation == _BIG_ENDIAN else None


def aligned(offset: int, size: int) -> int:
    """The first multiple of ``size`` from ``offset`` on."""
    return HEADER_BYTES + -(-(offset - HEADER_BYTES) // size) * size


def text_at(payload: Payload, start: int, end: int) -> str:
    """A text without its final zero; bytes that are none stay apart."""
    return bytes(payload[start:end]).rstrip(b"\x00").decode("utf-8", "surrogateescape")


def text_end(payload: Payload, length_at: int, uint32: struct.Struct) -> int:
    """Where a text ends whose length stands at ``length_at``."""
    (length,) = uint32.unpack_from(payload, length_at)
    return length_at + uint32.size + int(length)
