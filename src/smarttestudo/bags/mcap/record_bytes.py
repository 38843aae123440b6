# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The records of an MCAP file as bytes (https://mcap.dev/spec)."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from enum import IntEnum
from typing import BinaryIO

from smarttestudo.bags import magic

FRAME = struct.Struct("<BQ")
MESSAGE_HEADER = struct.Struct("<HIQQ")
MESSAGE_START = struct.Struct("<BQHIQQ")
_READ_BYTES = 1 << 20
CHUNK_HEADER = struct.Struct("<QQQIIQ")
"""What an uncompressed chunk has before its records: stamps, their bytes, checksum, 0, their bytes again."""
CHUNK_START = struct.Struct("<BQQQQIIQ")
"""The frame of an uncompressed chunk and its header."""
FOOTER_BYTES = FRAME.size + 20 + len(magic.MCAP)
RecordPlace = tuple[int, int, int, bytes]
"""Kind of a record, the byte its frame begins at, the byte after it, and the first ones of its content."""
_LIBRARY = "smarttestudo"
Schema = tuple[str, str, str]
"""Name of a type, and language and text of its definition; bytes that are no UTF-8 are surrogates."""


class Op(IntEnum):
    """Kinds of records; 0 is none."""

    HEADER = 0x01
    FOOTER = 0x02
    SCHEMA = 0x03
    CHANNEL = 0x04
    MESSAGE = 0x05
    CHUNK = 0x06
    MESSAGE_INDEX = 0x07
    CHUNK_INDEX = 0x08
    ATTACHMENT = 0x09
    ATTACHMENT_INDEX = 0x0A
    STATISTICS = 0x0B
    METADATA = 0x0C
    METADATA_INDEX = 0x0D
    SUMMARY_OFFSET = 0x0E
    DATA_END = 0x0F


IN_CHUNKS = frozenset(map(int, (Op.SCHEMA, Op.CHANNEL, Op.MESSAGE)))
"""What a chunk may hold; anything else in it is damage."""
HOLD_MESSAGES = frozenset({0, int(Op.MESSAGE), int(Op.CHUNK)})
"""What may be found neither in a summary nor beside the chunks that it names."""
FIRST_PRIVATE_OP = 0x80
"""From here on, kinds are of applications."""
INDEX_START_BYTES = FRAME.size + 6
"""What the index of a channel's messages in a chunk has before its entries."""
INDEX_ENTRY_BYTES = 16


@dataclass(frozen=True, slots=True, kw_only=True)
class StoredChannel:
    """A topic as a bag stores it.

    ``definition`` is that of its type with those of its parts, ``digest`` its ``RIHS01_…`` hash or empty,
    ``qos_text`` the offered profiles in YAML, as version 8 of the metadata has them. ``encoding`` is the
    language of the definition where that is not one of ROS 2's.
    """

    topic: str
    type_name: str
    definition: str = ""
    digest: str = ""
    qos_text: str = ""
    serialization_format: str = "cdr"
    encoding: str | None = None

    @property
    def schema(self) -> Schema:
        """The type; channels of one share it."""
        encoding = _own_encoding(self.definition) if self.encoding is None else self.encoding
        return self.type_name, encoding, self.definition


@dataclass(slots=True, kw_only=True)
class ChunkPlace:
    """A chunk in its file: stamps in ns, offsets and sizes in bytes.

    ``stamps`` has, for each channel by number, stamp and offset within the chunk of each of its messages,
    until their indexes are written. ``indexes`` are the offsets of these in the file, ``index_bytes`` is what
    all of them take. ``span_ns`` is from the least to the greatest stamp, once there is a message.
    ``checksum`` is the CRC-32 of its records once it is closed, 0 before.
    """

    start: int
    record_bytes: int = 0
    checksum: int = 0
    stamps: dict[int, list[tuple[int, int]]] = field(default_factory=dict)
    indexes: dict[int, int] = field(default_factory=dict)
    index_bytes: int = 0
    span_ns: tuple[int, int] | None = None

    def note(self, channel: int, stamp_ns: int, within: int) -> None:
        """A message of the channel stands at byte ``within``."""
        self.stamps.setdefault(channel, []).append((stamp_ns, within))
        first_ns, last_ns = self.span_ns or (stamp_ns, stamp_ns)
        self.span_ns = min(first_ns, stamp_ns), max(last_ns, stamp_ns)

    @property
    def first_ns(self) -> int:
        return 0 if self.span_ns is None else self.span_ns[0]

    @property
    def last_ns(self) -> int:
        return 0 if self.span_ns is None else self.span_ns[1]


def record_places(
    file: BinaryIO, start: int, end: int, head_bytes: int, *, enters_chunks: bool = False
) -> Iterator[RecordPlace]:
    """The records between two bytes of a file, one after the other, as far as their frames are there.

    The last may end after ``end``. With ``enters_chunks`` those in a chunk, which is not compressed, follow
    on it.
    """
    frame_bytes = FRAME.size
    while start + frame_bytes <= end:
        file.seek(start)
        data = file.read(frame_bytes + head_bytes)
        if len(data) < frame_bytes:
            return
        op, size_bytes = FRAME.unpack_from(data)
        record_bytes = frame_bytes + size_bytes
        yield op, start, start + record_bytes, data[frame_bytes:record_bytes]
        start += CHUNK_START.size if enters_chunks and op == Op.CHUNK else record_bytes


def record(op: Op, content: bytes) -> bytes:
    """A record with its frame."""
    return FRAME.pack(op, len(content)) + content


def file_start() -> bytes:
    """Bytes at the beginning of a file."""
    return magic.MCAP + record(Op.HEADER, _text("ros2") + _text(_LIBRARY))


def schema_record(number: int, schema: Schema) -> bytes:
    return record(Op.SCHEMA, struct.pack("<H", number) + b"".join(map(_text, schema)))


def channel_record(number: int, schema: int, channel: StoredChannel) -> bytes:
    """A channel whose type is that of the schema with the number ``schema``."""
    notes = _text("offered_qos_profiles") + _text(channel.qos_text)
    if channel.digest:
        notes += _text("topic_type_hash") + _text(channel.digest)
    content = struct.pack("<HH", number, schema) + _text(channel.topic) + _text(channel.serialization_format)
    return record(Op.CHANNEL, content + struct.pack("<I", len(notes)) + notes)


def metadata_record(name: str, key: str, text: str) -> bytes:
    """A text of the metadata that have this name."""
    entry = _text(key) + _text(text)
    return record(Op.METADATA, _text(name) + struct.pack("<I", len(entry)) + entry)


def metadata_index(name: str, at: int, size_bytes: int) -> bytes:
    """Where a record of metadata is, with its frame."""
    return record(Op.METADATA_INDEX, struct.pack("<QQ", at, size_bytes) + _text(name))


def chunk_start(chunk: ChunkPlace) -> bytes:
    """Bytes before the records of a chunk."""
    size = chunk.record_bytes
    content_bytes = CHUNK_START.size - FRAME.size + size
    return CHUNK_START.pack(
        Op.CHUNK, content_bytes, chunk.first_ns, chunk.last_ns, size, chunk.checksum, 0, size
    )


def is_altered(chunk: bytes) -> bool:
    """Whether the records of an uncompressed chunk, with its frame, are not those of its checksum."""
    *_, checksum, _, _ = CHUNK_START.unpack_from(chunk)
    return not has_checksum(memoryview(chunk)[CHUNK_START.size :], checksum)


def has_checksum(content: bytes | memoryview, checksum: int) -> bool:
    """Whether that is the CRC-32 of ``content``; 0 stands for none."""
    return not checksum or zlib.crc32(content) == checksum


def checksum_of(read_at: Callable[[int, int], bytes], at: int, end: int) -> int:
    """The CRC-32 of what a file holds between two bytes; ``read_at`` reads from one so many."""
    checksum = 0
    while at < end and (data := read_at(at, min(end - at, _READ_BYTES))):
        checksum = zlib.crc32(data, checksum)
        at += len(data)
    return checksum


def message_index(channel: int, stamps: Sequence[tuple[int, int]]) -> bytes:
    """Where the messages of a channel are in the chunk before it."""
    entries = b"".join(struct.pack("<QQ", *entry) for entry in stamps)
    return record(Op.MESSAGE_INDEX, struct.pack("<HI", channel, len(entries)) + entries)


def chunk_index(chunk: ChunkPlace) -> bytes:
    """Where a chunk and its indexes are."""
    size = chunk.record_bytes
    head = struct.pack("<QQQQ", chunk.first_ns, chunk.last_ns, chunk.start, CHUNK_START.size + size)
    places = b"".join(struct.pack("<HQ", *entry) for entry in chunk.indexes.items())
    tail = struct.pack("<QIQQ", chunk.index_bytes, 0, size, size)
    return record(Op.CHUNK_INDEX, head + struct.pack("<I", len(places)) + places + tail)


def statistics(
    counts: Mapping[int, int], *, schemas: int, chunks: Sequence[ChunkPlace], metadata: int = 0
) -> bytes:
    """How much there is of everything; ``counts`` are messages by channel."""
    filled = [chunk for chunk in chunks if chunk.span_ns]
    first_ns = min((chunk.first_ns for chunk in filled), default=0)
    last_ns = max((chunk.last_ns for chunk in filled), default=0)
    content = struct.pack(
        "<QHIIIIQQ", sum(counts.values()), schemas, len(counts), 0, metadata, len(chunks), first_ns, last_ns
    )
    entries = b"".join(struct.pack("<HQ", *entry) for entry in sorted(counts.items()))
    return record(Op.STATISTICS, content + struct.pack("<I", len(entries)) + entries)


def file_end(summary_start: int, groups: Sequence[tuple[Op, bytes]]) -> bytes:
    """The summary of ``groups`` of records, each by its kind, from ``summary_start`` on, and the end."""
    summary, offsets, place = b"", b"", summary_start
    for op, group in groups:
        if group:
            offsets += record(Op.SUMMARY_OFFSET, struct.pack("<BQQ", op, place, len(group)))
            summary += group
            place += len(group)
    summed = summary + offsets + FRAME.pack(Op.FOOTER, 20) + struct.pack("<QQ", summary_start, place)
    return summed + struct.pack("<I", zlib.crc32(summed)) + magic.MCAP


def read_schema(content: bytes) -> tuple[int, Schema]:
    """A schema and its number; ``struct.error`` and ``ValueError`` for what is none."""
    (number,) = struct.unpack_from("<H", content)
    name, place = read_text(content, 2)
    encoding, place = read_text(content, place)
    definition, _ = read_text(content, place)
    return number, (name, encoding, definition)


def read_channel(content: bytes, schemas: Mapping[int, Schema]) -> tuple[int, StoredChannel]:
    """Number and channel, whose type is in ``schemas``; errors as in ``read_schema``."""
    number, schema = struct.unpack_from("<HH", content)
    topic, place = read_text(content, 4)
    serialization_format, place = read_text(content, place)
    notes, _ = read_notes(content, place)
    type_name, encoding, definition = schemas.get(schema, ("", "", ""))
    channel = StoredChannel(
        topic=topic,
        type_name=type_name,
        definition=definition,
        digest=notes.get("topic_type_hash", ""),
        qos_text=notes.get("offered_qos_profiles", ""),
        serialization_format=serialization_format,
        encoding=None if encoding == _own_encoding(definition) else encoding,
    )
    return number, channel


def read_notes(content: bytes, place: int) -> tuple[dict[str, str], int]:
    """Texts by their names from byte ``place`` on, and where they end."""
    notes: dict[str, str] = {}
    (size_bytes,) = struct.unpack_from("<I", content, place)
    place += 4
    end = place + size_bytes
    while place < end:
        key, place = read_text(content, place)
        notes[key], place = read_text(content, place)
    return notes, place


def read_text(content: bytes, place: int) -> tuple[str, int]:
    """The text at byte ``place``, and where it ends; of one that is cut off, what is there.

    Bytes that are no UTF-8 become surrogates.
    """
    data, end = read_bytes(content, place)
    return data.decode("utf-8", "surrogateescape"), end


def read_bytes(content: bytes, place: int) -> tuple[bytes, int]:
    """The bytes that are counted at byte ``place``, as ``read_text``."""
    (size_bytes,) = struct.unpack_from("<I", content, place)
    end = place + 4 + size_bytes
    return content[place + 4 : end], end


def _text(text: str) -> bytes:
    data = text.encode("utf-8", "surrogateescape")
    return struct.pack("<I", len(data)) + data


def _own_encoding(definition: str) -> str:
    """How rosbag2 calls the language of a definition of ROS 2's."""
    if not definition:
        return ""
    return "ros2idl" if definition.startswith("=" * 80 + "\nIDL: ") else "ros2msg"
