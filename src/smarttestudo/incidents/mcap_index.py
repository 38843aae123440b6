# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Where everything stands in an MCAP file that ``McapWriter`` wrote."""

from __future__ import annotations

import struct
from dataclasses import dataclass, field
from pathlib import Path
from typing import BinaryIO

from smarttestudo.bags.mcap.record_bytes import (
    CHUNK_START,
    FRAME,
    MAGIC,
    MESSAGE_HEADER,
    Op,
    read_channel,
)
from smarttestudo.incidents.transfer_order import ByteRange, MessageRange

_MAX_CHANNEL_BYTES = 1_000_000


@dataclass(slots=True, kw_only=True)
class FileRanges:
    """All bytes of one file: the ``head`` makes it readable, the ``tail`` only faster to read."""

    head: list[ByteRange] = field(default_factory=list)
    messages: list[MessageRange] = field(default_factory=list)
    tail: list[ByteRange] = field(default_factory=list)


def file_ranges(path: Path, file: int) -> FileRanges:
    """The ranges of the file with that number; one of another origin is one range. Raises ``OSError``."""
    size_bytes = path.stat().st_size
    whole = FileRanges(head=[ByteRange(file, 0, size_bytes)])
    if path.suffix != ".mcap":
        return whole
    with path.open("rb") as opened:
        try:
            return _Index(opened, file, size_bytes).read()
        except (struct.error, ValueError):
            return FileRanges(tail=whole.head)


class _Index:
    """Walks over the records of one file; ``ValueError`` and ``struct.error`` where they do not fit."""

    def __init__(self, opened: BinaryIO, file: int, size_bytes: int) -> None:
        self._opened = opened
        self._file = file
        self._size_bytes = size_bytes
        self._topics: dict[int, str] = {}
        self._ranges = FileRanges()

    def read(self) -> FileRanges:
        if self._at(0, len(MAGIC)) != MAGIC:
            raise ValueError("not an mcap file")
        self._add(self._ranges.head, 0, len(MAGIC))
        place, end = len(MAGIC), self._size_bytes - len(MAGIC)
        while place < end:
            place = self._record(place, end)
        if place != end or self._at(end, len(MAGIC)) != MAGIC:
            raise ValueError("without an end")
        self._add(self._ranges.tail, end, len(MAGIC))
        return self._ranges

    def _record(self, place: int, end: int) -> int:
        op, next_place = self._frame(place)
        if next_place > end:
            raise ValueError("a record reaches beyond the file")
        if op == Op.CHUNK:
            *_, records_bytes, _, compression_bytes, stored_bytes = CHUNK_START.unpack(
                self._at(place, CHUNK_START.size)
            )
            inside = place + CHUNK_START.size
            if compression_bytes or records_bytes != stored_bytes or inside + stored_bytes != next_place:
                raise ValueError("a compressed chunk")
            self._add(self._ranges.head, place, CHUNK_START.size)
            while inside < next_place:
                inside = self._inner_record(inside, next_place)
        else:
            ranges = self._ranges.head if op == Op.HEADER else self._ranges.tail
            self._add(ranges, place, next_place - place)
        return next_place

    def _inner_record(self, place: int, end: int) -> int:
        op, next_place = self._frame(place)
        content, size = place + FRAME.size, next_place - place - FRAME.size
        if next_place > end:
            raise ValueError("a record reaches beyond its chunk")
        if op == Op.MESSAGE:
            number, _, stamp_ns, _ = MESSAGE_HEADER.unpack(self._at(content, MESSAGE_HEADER.size))
            topic = self._topics.get(number, "")
            self._ranges.messages.append(MessageRange(self._file, place, next_place - place, topic, stamp_ns))
            return next_place
        if op == Op.CHANNEL and size <= _MAX_CHANNEL_BYTES:
            number, channel = read_channel(self._at(content, size), {})
            self._topics[number] = channel.topic
        self._add(self._ranges.head, place, next_place - place)
        return next_place

    def _add(self, ranges: list[ByteRange], place: int, size_bytes: int) -> None:
        """Add a range; one that follows on the last joins it, unless it may be the same as elsewhere."""
        last = ranges[-1] if ranges else None
        if last is not None and last.offset + last.size_bytes == place and ranges is self._ranges.tail:
            ranges[-1] = ByteRange(self._file, last.offset, last.size_bytes + size_bytes)
        else:
            ranges.append(ByteRange(self._file, place, size_bytes))

    def _frame(self, place: int) -> tuple[int, int]:
        """The kind of the record at ``place``, and where the next one is."""
        op, size = FRAME.unpack(self._at(place, FRAME.size))
        return int(op), place + FRAME.size + int(size)

    def _at(self, place: int, size_bytes: int) -> bytes:
        self._opened.seek(place)
        return self._opened.read(size_bytes)
