# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Where everything stands in an MCAP file that ``McapWriter`` wrote."""

from __future__ import annotations

import struct
from dataclasses import dataclass, field
from pathlib import Path
from typing import BinaryIO

from smarttestudo.bags import magic
from smarttestudo.bags.mcap.record_bytes import (
    CHUNK_HEADER,
    CHUNK_START,
    FRAME,
    MESSAGE_HEADER,
    Op,
    RecordPlace,
    read_channel,
    record_places,
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
        if self._at(0, len(magic.MCAP)) != magic.MCAP:
            raise ValueError("not an mcap file")
        self._add(self._ranges.head, 0, len(magic.MCAP))
        at, end = len(magic.MCAP), self._size_bytes - len(magic.MCAP)
        chunk_end = at
        for place in record_places(self._opened, at, end, CHUNK_HEADER.size, enters_chunks=True):
            op, start, at, head = place
            if at > (chunk_end if start < chunk_end else end):
                raise ValueError("a record reaches beyond its chunk or the file")
            if start < chunk_end:
                self._note_message(place)
            elif op == Op.CHUNK:
                chunk_end, at = at, start + CHUNK_START.size
                *_, records_bytes, _, compression_bytes, stored_bytes = CHUNK_HEADER.unpack(head)
                if compression_bytes or not records_bytes == stored_bytes == chunk_end - at:
                    raise ValueError("a compressed chunk")
                self._add(self._ranges.head, start, CHUNK_START.size)
            else:
                self._add(self._ranges.head if op == Op.HEADER else self._ranges.tail, start, at - start)
        if at != end or self._at(end, len(magic.MCAP)) != magic.MCAP:
            raise ValueError("without an end")
        self._add(self._ranges.tail, end, len(magic.MCAP))
        return self._ranges

    def _note_message(self, place: RecordPlace) -> None:
        """Note a message, or what else is in a chunk."""
        op, start, end, head = place
        if op == Op.MESSAGE:
            number, _, stamp_ns, _ = MESSAGE_HEADER.unpack_from(head)
            topic = self._topics.get(number, "")
            self._ranges.messages.append(MessageRange(self._file, start, end - start, topic, stamp_ns))
            return
        if op == Op.CHUNK:
            raise ValueError("a chunk in a chunk")
        if op == Op.CHANNEL and end - start <= _MAX_CHANNEL_BYTES:
            content = start + FRAME.size
            number, channel = read_channel(self._at(content, end - content), {})
            self._topics[number] = channel.topic
        self._add(self._ranges.head, start, end - start)

    def _add(self, ranges: list[ByteRange], place: int, size_bytes: int) -> None:
        """Add a range; one that follows on the last joins it, unless it may be the same as elsewhere."""
        last = ranges[-1] if ranges else None
        if last is not None and last.offset + last.size_bytes == place and ranges is self._ranges.tail:
            ranges[-1] = ByteRange(self._file, last.offset, last.size_bytes + size_bytes)
        else:
            ranges.append(ByteRange(self._file, place, size_bytes))

    def _at(self, place: int, size_bytes: int) -> bytes:
        self._opened.seek(place)
        return self._opened.read(size_bytes)
