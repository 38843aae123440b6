# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The summary at the end of an MCAP file: what is in it, and where (https://mcap.dev/spec)."""

from __future__ import annotations

import os
import struct
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import partial
from typing import BinaryIO

from smarttestudo.bags import magic
from smarttestudo.bags.mcap.record_bytes import (
    FOOTER_BYTES,
    FRAME,
    HOLD_MESSAGES,
    INDEX_ENTRY_BYTES,
    INDEX_START_BYTES,
    Op,
    checksum_of,
    read_bytes,
    read_notes,
    read_text,
    record_places,
)

_FOOTER = struct.Struct("<BQQQI8s")
_SUMMED_FOOTER_BYTES = FRAME.size + 16
"""What the checksum of a summary covers of the footer behind it."""
_CHANNEL_START = struct.Struct("<HH")
_CHUNK_START = struct.Struct("<QQQQI")
_CHUNK_END = struct.Struct("<QQ")
_STATISTICS = struct.Struct("<QHIIIIQQI")
_PLACE = struct.Struct("<HQ")
_METADATA_PLACE = struct.Struct("<QQ")
_DESCRIBED = frozenset({Op.SCHEMA, Op.CHANNEL, Op.CHUNK_INDEX, Op.STATISTICS, Op.METADATA_INDEX})
MAX_METADATA_BYTES = 50_000_000


@dataclass(frozen=True, slots=True, kw_only=True)
class SchemaEntry:
    """A type: its name, and its definition in the language ``encoding``."""

    number: int
    name: str
    encoding: str
    data: bytes


@dataclass(frozen=True, slots=True, kw_only=True)
class ChannelEntry:
    """A topic whose type is the schema with the number ``schema_id``; 0 is none."""

    number: int
    schema_id: int
    topic: str
    message_encoding: str
    metadata: dict[str, str]


@dataclass(frozen=True, slots=True, kw_only=True)
class ChunkEntry:
    """Where a chunk is; ``indexed`` are the messages of each channel that has an index of them behind it."""

    message_start_time: int
    message_end_time: int
    chunk_start_offset: int
    chunk_length: int
    indexed: dict[int, int]
    message_index_length: int
    compression: str
    uncompressed_size: int


@dataclass(frozen=True, slots=True, kw_only=True)
class StatisticsEntry:
    """How many messages there are, of each of the ``channels`` by number, too, and their stamps in ns."""

    message_count: int
    message_start_time: int
    message_end_time: int
    channels: dict[int, int]


@dataclass(slots=True, kw_only=True)
class McapSummary:
    """Content of a summary, which begins at byte ``start``.

    Schemas and channels are by their numbers, the bytes at which metadata begin by their names.
    """

    start: int
    statistics: StatisticsEntry | None = None
    schemas: dict[int, SchemaEntry] = field(default_factory=dict)
    channels: dict[int, ChannelEntry] = field(default_factory=dict)
    chunks: list[ChunkEntry] = field(default_factory=list)
    metadata_places: dict[str, int] = field(default_factory=dict)

    def add(self, kind: int, content: bytes) -> None:
        """Take a record in."""
        match kind:
            case Op.SCHEMA:
                schema = read_schema(content)
                self.schemas[schema.number] = schema
            case Op.CHANNEL:
                channel = read_channel(content)
                self.channels[channel.number] = channel
            case Op.CHUNK_INDEX:
                self.chunks.append(_chunk(content))
            case Op.STATISTICS:
                self.statistics = read_statistics(content)
            case Op.METADATA_INDEX:
                name, _ = read_text(content, _METADATA_PLACE.size)
                self.metadata_places.setdefault(name, _METADATA_PLACE.unpack_from(content)[0])


def read_summary(file: BinaryIO) -> McapSummary | None:
    """The summary of a file, ``None`` where it has none.

    Raises ``struct.error`` or ``ValueError`` where it makes no sense or was altered, and ``OSError``.
    """
    start, end, checksum = _read_footer(file)
    if not start:
        return None
    if start > end:
        raise ValueError("the summary begins behind its end")
    if checksum and checksum != checksum_of(partial(_read_at, file), start, end + _SUMMED_FOOTER_BYTES):
        raise ValueError("the summary is not that of its checksum")
    summary = McapSummary(start=start)
    for kind, content in _records(file, start, end):
        summary.add(kind, content)
    return summary


def _read_footer(file: BinaryIO) -> tuple[int, int, int]:
    """Where the summary begins and ends, and its checksum."""
    end = file.seek(0, os.SEEK_END) - FOOTER_BYTES
    if end < 0:
        raise ValueError("no footer")
    op, size_bytes, start, _, checksum, last = _FOOTER.unpack(_read_at(file, end, FOOTER_BYTES))
    if (op, size_bytes, last) != (Op.FOOTER, FOOTER_BYTES - FRAME.size - len(magic.MCAP), magic.MCAP):
        raise ValueError("no footer")
    return start, end, checksum


def read_metadata(file: BinaryIO, name: str) -> dict[str, str]:
    """The texts of the first metadata of a name, none where there are none; errors as ``read_summary``.

    A file without a summary is walked through.
    """
    try:
        summary = read_summary(file)
    except (struct.error, ValueError):
        summary = None
    start = len(magic.MCAP) if summary is None else summary.metadata_places.get(name)
    if start is None:
        return {}
    for op, at, end, _ in record_places(file, start, file.seek(0, os.SEEK_END), 0):
        if op == Op.METADATA and end - at <= MAX_METADATA_BYTES:
            content = _read_at(file, at + FRAME.size, end - at - FRAME.size)
            found, place = read_text(content, 0)
            if found == name:
                return read_notes(content, place)[0]
        if summary is not None:
            break
    return {}


def _read_at(file: BinaryIO, at: int, size_bytes: int) -> bytes:
    file.seek(at)
    return file.read(size_bytes)


def _records(file: BinaryIO, at: int, end: int) -> Iterator[tuple[int, bytes]]:
    """The records between two bytes that describe something."""
    file.seek(at)
    while at < end:
        op, size_bytes = FRAME.unpack(file.read(FRAME.size))
        at += FRAME.size + size_bytes
        if at > end:
            raise ValueError("a record is longer than the summary")
        if op in HOLD_MESSAGES:
            raise ValueError("a summary holds messages")
        if op in _DESCRIBED:
            yield op, file.read(size_bytes)
        else:
            file.seek(at)


def read_schema(content: bytes) -> SchemaEntry:
    """The entry in a record of a schema; ``struct.error`` and ``ValueError`` for what is none."""
    name, place = read_text(content, 2)
    encoding, place = read_text(content, place)
    data, place = read_bytes(content, place)
    _require_within(content, place)
    number = int.from_bytes(content[:2], "little")
    return SchemaEntry(number=number, name=name, encoding=encoding, data=data)


def read_channel(content: bytes) -> ChannelEntry:
    """The entry in a record of a channel; errors as ``read_schema``."""
    number, schema = _CHANNEL_START.unpack_from(content)
    topic, place = read_text(content, _CHANNEL_START.size)
    encoding, place = read_text(content, place)
    metadata, place = read_notes(content, place)
    _require_within(content, place)
    return ChannelEntry(
        number=number, schema_id=schema, topic=topic, message_encoding=encoding, metadata=metadata
    )


def _chunk(content: bytes) -> ChunkEntry:
    first_ns, last_ns, start, length, places_bytes = _CHUNK_START.unpack_from(content)
    place = _CHUNK_START.size + places_bytes
    places = content[_CHUNK_START.size : place]
    (index_length,) = struct.unpack_from("<Q", content, place)
    compression, place = read_text(content, place + 8)
    _, uncompressed = _CHUNK_END.unpack_from(content, place)
    return ChunkEntry(
        message_start_time=first_ns,
        message_end_time=last_ns,
        chunk_start_offset=start,
        chunk_length=length,
        indexed=_indexed(places, start + length + index_length),
        message_index_length=index_length,
        compression=compression,
        uncompressed_size=uncompressed,
    )


def _indexed(places: bytes, end: int) -> dict[int, int]:
    """Messages by channel, of which the indexes lie one behind the other up to byte ``end``."""
    starts = sorted((start, number) for number, start in _PLACE.iter_unpack(places))
    ends = [*(start for start, _ in starts[1:]), end]
    return {
        number: (after - start - INDEX_START_BYTES) // INDEX_ENTRY_BYTES
        for (start, number), after in zip(starts, ends, strict=False)
    }


def read_statistics(content: bytes) -> StatisticsEntry:
    """The entry in a record of statistics; ``struct.error`` and ``ValueError`` for what is none."""
    count, _, _, _, _, _, first_ns, last_ns, counts_bytes = _STATISTICS.unpack_from(content)
    end = _STATISTICS.size + counts_bytes
    _require_within(content, end)
    return StatisticsEntry(
        message_count=count,
        message_start_time=first_ns,
        message_end_time=last_ns,
        channels=dict(_PLACE.iter_unpack(content[_STATISTICS.size : end])),
    )


def _require_within(content: bytes, place: int) -> None:
    if place > len(content):
        raise ValueError("a record is shorter than what it holds")
