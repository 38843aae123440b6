# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""MCAP files as bags have them: written whole, and read back or continued after the writer was stopped."""

from __future__ import annotations

import os
import struct
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import BinaryIO

from smarttestudo.bags import magic
from smarttestudo.bags.mcap.record_bytes import (
    CHUNK_START,
    FOOTER_BYTES,
    FRAME,
    MESSAGE_HEADER,
    MESSAGE_START,
    ChunkPlace,
    Op,
    RecordPlace,
    Schema,
    StoredChannel,
    channel_record,
    checksum_of,
    chunk_index,
    chunk_start,
    file_end,
    file_start,
    message_index,
    metadata_index,
    metadata_record,
    read_channel,
    read_schema,
    record,
    record_places,
    schema_record,
    statistics,
)
from smarttestudo.domain.errors import RecordingError
from smarttestudo.files.removal import remove

CHUNK_BYTES = 1 << 20
_BAG = "rosbag2"
"""Name of the metadata that a bag has."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FileContent:
    """Content of a file: stamps in ns, messages and bytes of payload by topic.

    ``channels`` are in the order of the file, ``of_types`` are the messages by topic and type, as a topic may
    have had several types, and several definitions of one. ``final_ns`` is the stamp of the message that was
    written last, not the greatest one where the clock was set back.
    """

    channels: Sequence[StoredChannel]
    messages: Mapping[str, int]
    of_types: Mapping[tuple[str, Schema], int]
    size_bytes: Mapping[str, int]
    first_ns: int
    last_ns: int
    final_ns: int

    @property
    def message_count(self) -> int:
        return sum(self.messages.values())


@dataclass(slots=True, kw_only=True)
class McapState:
    """Content so far of a file that is being written.

    Schemas and channels have numbers by what they are; messages and bytes are counted by channel.
    ``chunks`` are closed, ``chunk`` is not; ``size_bytes`` is that of the file, ``final_ns`` the stamp of its
    last message.
    """

    size_bytes: int = 0
    final_ns: int = 0
    schemas: dict[Schema, int] = field(default_factory=dict)
    channels: dict[StoredChannel, int] = field(default_factory=dict)
    messages: Counter[int] = field(default_factory=Counter)
    payload_bytes: Counter[int] = field(default_factory=Counter)
    chunks: list[ChunkPlace] = field(default_factory=list)
    chunk: ChunkPlace | None = None

    def note(self, chunk: ChunkPlace, number: int, stamp_ns: int, within: int, payload_bytes: int) -> None:
        """A message of the channel ``number`` stands at byte ``within`` of the chunk."""
        chunk.note(number, stamp_ns, within)
        self.messages[number] += 1
        self.payload_bytes[number] += payload_bytes
        self.final_ns = stamp_ns

    def close_chunk(self) -> None:
        """Keep of the open chunk, all of which is in the file, what a summary needs."""
        if self.chunk is not None:
            # A recording of hours has millions of messages.
            self.chunk.stamps = {}
            self.chunks.append(self.chunk)
            self.chunk = None

    def content(self) -> FileContent:
        """Content that readers find in it."""
        filled = [chunk for chunk in (*self.chunks, self.chunk) if chunk is not None and chunk.span_ns]
        return file_content(
            self.channels,
            self.messages,
            self.payload_bytes,
            first_ns=min((chunk.first_ns for chunk in filled), default=0),
            last_ns=max((chunk.last_ns for chunk in filled), default=0),
            final_ns=self.final_ns,
        )


def file_content(
    channels: Mapping[StoredChannel, int],
    messages: Mapping[int, int],
    payload_bytes: Mapping[int, int],
    *,
    first_ns: int,
    last_ns: int,
    final_ns: int,
) -> FileContent:
    """Content of a file in which channels have these numbers, by which messages and bytes are counted."""
    of_topics, size_bytes = Counter[str](), Counter[str]()
    of_types = Counter[tuple[str, Schema]]()
    for channel, number in channels.items():
        of_topics[channel.topic] += messages[number]
        of_types[channel.topic, channel.schema] += messages[number]
        size_bytes[channel.topic] += payload_bytes[number]
    return FileContent(
        channels=tuple(channels),
        messages=of_topics,
        of_types=of_types,
        size_bytes=size_bytes,
        first_ns=first_ns,
        last_ns=last_ns,
        final_ns=final_ns,
    )


class McapWriter:
    """A new MCAP file at ``path``, without compression; with a ``state``, the rest of one that has no end.

    Each message goes to the operating system at once. A chunk that is not full yet stands in the file as an
    empty one with its records after it, which is as valid; so what a killed process leaves can be read up to
    the last message. The bytes depend on the messages only. Calls raise ``OSError``.
    """

    def __init__(self, path: Path, state: McapState | None = None) -> None:
        flags = os.O_CREAT | os.O_EXCL if state is None else 0
        self._file = os.open(path, os.O_RDWR | os.O_CLOEXEC | flags, 0o644)
        self._state = state or McapState()
        if state is None:
            try:
                self._append(file_start())
            except OSError:
                self.abandon()
                # What has not even a beginning is no file of a bag.
                remove(path.parent, [path.name])
                raise
            return
        os.ftruncate(self._file, state.size_bytes)
        os.lseek(self._file, 0, os.SEEK_END)

    def add(self, channel: StoredChannel) -> int:
        """Have the channel listed though no message of it follows; its number."""
        if self._state.chunk is None:
            self._open_chunk()
        return self._state.channels.get(channel) or self._add(channel)

    def write(self, channel: StoredChannel, stamp_ns: int, payload: bytes) -> None:
        state = self._state
        chunk = state.chunk or self._open_chunk()
        number = state.channels.get(channel) or self._add(channel)
        within = state.size_bytes - chunk.start - CHUNK_START.size
        size = MESSAGE_HEADER.size + len(payload)
        self._append(MESSAGE_START.pack(Op.MESSAGE, size, number, 0, stamp_ns, stamp_ns), payload)
        state.note(chunk, number, stamp_ns, within, len(payload))
        if state.size_bytes - chunk.start > CHUNK_BYTES:
            self._close_chunk(chunk)

    def content(self) -> FileContent:
        """Content so far."""
        return self._state.content()

    def close(self, metadata: str = "") -> FileContent:
        """Write what readers look for at the end, with ``metadata`` of the bag, if any."""
        state = self._state
        if state.chunk is not None:
            self._close_chunk(state.chunk)
        noted = metadata_record(_BAG, "serialized_metadata", metadata) if metadata else b""
        metadata_at = state.size_bytes
        self._append(noted, record(Op.DATA_END, bytes(4)))
        counts = {number: state.messages[number] for number in state.channels.values()}
        groups = [
            (Op.SCHEMA, b"".join(schema_record(number, schema) for schema, number in state.schemas.items())),
            (Op.CHANNEL, b"".join(map(self._channel, state.channels))),
            (Op.CHUNK_INDEX, b"".join(map(chunk_index, state.chunks))),
            (Op.METADATA_INDEX, metadata_index(_BAG, metadata_at, len(noted)) if noted else b""),
            (
                Op.STATISTICS,
                statistics(counts, schemas=len(state.schemas), chunks=state.chunks, metadata=bool(noted)),
            ),
        ]
        self._append(file_end(state.size_bytes, groups))
        self.abandon()
        return state.content()

    def abandon(self) -> None:
        """Leave the file as it is."""
        if self._file >= 0:
            os.close(self._file)
            self._file = -1

    def _open_chunk(self) -> ChunkPlace:
        chunk = ChunkPlace(start=self._state.size_bytes)
        self._state.chunk = chunk
        self._append(chunk_start(chunk))
        return chunk

    def _close_chunk(self, chunk: ChunkPlace) -> None:
        state = self._state
        chunk.record_bytes = state.size_bytes - chunk.start - CHUNK_START.size
        # Another process may have begun the chunk: it is read, not summed up as it comes.
        chunk.checksum = checksum_of(self._read_at, chunk.start + CHUNK_START.size, state.size_bytes)
        os.pwrite(self._file, chunk_start(chunk), chunk.start)
        indexes_start = state.size_bytes
        for number, stamps in chunk.stamps.items():
            chunk.indexes[number] = state.size_bytes
            self._append(message_index(number, stamps))
        chunk.index_bytes = state.size_bytes - indexes_start
        state.close_chunk()

    def _read_at(self, at: int, size_bytes: int) -> bytes:
        return os.pread(self._file, size_bytes, at)

    def _add(self, channel: StoredChannel) -> int:
        state = self._state
        number = len(state.channels) + 1
        schema = channel.schema
        if schema not in state.schemas:
            state.schemas[schema] = len(state.schemas) + 1
            self._append(schema_record(state.schemas[schema], schema))
        state.channels[channel] = number
        self._append(self._channel(channel))
        return number

    def _channel(self, channel: StoredChannel) -> bytes:
        state = self._state
        return channel_record(state.channels[channel], state.schemas[channel.schema], channel)

    def _append(self, *parts: bytes) -> None:
        written = os.writev(self._file, parts)
        self._state.size_bytes += written
        if written == sum(map(len, parts)):
            return
        rest = b"".join(parts)[written:]
        while rest:
            # The disk is full, which this says, or was for a moment.
            written = os.write(self._file, rest)
            self._state.size_bytes += written
            rest = rest[written:]


_MAX_DESCRIPTION_BYTES = 10_000_000
_SECTOR_BYTES = 512
"""What reaches a disk does so in multiples of this."""
_READ_BYTES = 1 << 16
_CHANNEL_START = struct.Struct("<HH")
"""Its number, and that of its schema."""
_INDEXED = struct.Struct("<H")
"""The channel whose messages an index has."""


def complete_file(path: Path) -> FileContent:
    """Complete a file: return its content.

    A file without an end gets one; half a message is cut off, and so is one of which a part never reached the
    disk as the power went, if anything follows on it. Raises ``RecordingError`` for a file of another origin,
    ``OSError`` where it cannot be written.
    """
    try:
        with path.open("rb") as file:
            walk = _walked(file)
        return walk.state.content() if walk.is_whole else McapWriter(path, walk.state).close()
    except (struct.error, ValueError, KeyError) as error:
        raise RecordingError("is damaged", place=str(path)) from error


def complete_files(folder: Path) -> dict[str, FileContent]:
    """Complete the files of an incident: return their content by name, in the order of time.

    A file with less than a beginning is removed: the process was killed,
    or the power went. Raises as ``complete_file``.
    """
    files: dict[str, FileContent] = {}
    # The file of latched messages was written after those that begin when it does.
    for file in sorted(folder.glob("*.mcap"), key=lambda path: (len(path.name), path.name), reverse=True):
        if file.is_symlink():
            continue
        if _has_no_beginning(file):
            remove(folder, [file.name])
            continue
        files[file.name] = complete_file(file)
    return dict(sorted(files.items(), key=lambda entry: (entry[1].first_ns, entry[1].last_ns)))


def _has_no_beginning(path: Path) -> bool:
    with path.open("rb") as file:
        beginning, size_bytes = file.read(len(file_start())), file.seek(0, 2)
        return (size_bytes < len(file_start()) and file_start().startswith(beginning)) or not _end_of_content(
            file, size_bytes
        )


def _walked(file: BinaryIO) -> _Walk:
    """A walk over all of a file, or over what reached the disk of it."""
    size_bytes = file.seek(0, 2)
    reached_bytes = -(-_end_of_content(file, size_bytes) // _SECTOR_BYTES) * _SECTOR_BYTES
    if reached_bytes >= size_bytes:
        return _Walk(file, size_bytes)
    try:
        walk = _Walk(file, size_bytes)
    except (struct.error, ValueError):
        return _Walk(file, reached_bytes)
    # A message with which the file ends may well end with zeros of its own.
    return walk if walk.ends_with_message else _Walk(file, reached_bytes)


def _end_of_content(file: BinaryIO, size_bytes: int) -> int:
    """The byte after the last one that is not zero."""
    end = size_bytes
    while end:
        start = max(0, end - _READ_BYTES)
        file.seek(start)
        if content := file.read(end - start).rstrip(b"\0"):
            return start + len(content)
        end = start
    return 0


class _Walk:
    """The records of ``file`` before the byte ``end``, in their order, as far as they make sense.

    ``is_whole`` says whether the file has an end; if not, its last chunk is left open. ``ends_with_message``
    says whether a message does at ``end``.
    """

    def __init__(self, file: BinaryIO, end: int) -> None:
        self._file = file
        self._end = end
        self._schemas: dict[int, Schema] = {}
        self._numbers: set[int] = set()
        self.state = state = McapState()
        if self._at(0, len(magic.MCAP)) != magic.MCAP:
            raise ValueError("not an mcap file")
        self.is_whole = self._has_end()
        self.ends_with_message = False
        records_end = self._read_records()
        of_channels = {channel.schema for channel in state.channels}
        state.schemas = {one: number for number, one in self._schemas.items() if one in of_channels}
        if self.is_whole:
            state.close_chunk()
        elif state.chunk is not None:
            state.size_bytes = state.chunk.start + CHUNK_START.size + state.chunk.record_bytes
        else:
            state.size_bytes = records_end

    def _read_records(self) -> int:
        """Note all records; where the last whole one ends."""
        end = len(magic.MCAP)
        for place in record_places(self._file, end, self._end, MESSAGE_HEADER.size, enters_chunks=True):
            op, start, next_start, _ = place
            if op == Op.CHUNK:
                # Of one that is closed, all that is there counts.
                next_start = start + CHUNK_START.size
            if op in (0, Op.DATA_END, Op.FOOTER) or next_start > self._end:
                break
            if op == Op.CHUNK:
                self.state.close_chunk()
                self.state.chunk = ChunkPlace(start=start)
                end = next_start
                continue
            if not self._note(place):
                if self.is_whole:
                    raise ValueError("a record makes no sense")
                break
            self.ends_with_message = op == Op.MESSAGE and next_start == self._end
            if op == Op.SCHEMA:
                # Without the channel that it was written for it is cut off.
                continue
            end = next_start
            chunk = self.state.chunk
            if chunk is not None and op in (Op.CHANNEL, Op.MESSAGE):
                chunk.record_bytes = end - chunk.start - CHUNK_START.size
        return end

    def _note(self, place: RecordPlace) -> bool:
        """Take a record in; whether it makes sense."""
        chunk = self.state.chunk
        op, start, end, head = place
        content = start + FRAME.size
        size = end - content
        if op in (Op.SCHEMA, Op.CHANNEL) and size > _MAX_DESCRIPTION_BYTES:
            raise ValueError("too large a description")
        if op == Op.SCHEMA:
            number, schema = read_schema(self._at(content, size))
            self._schemas[number] = schema
        elif op == Op.CHANNEL:
            data = self._at(content, size)
            _, schema_number = _CHANNEL_START.unpack_from(data)
            number, channel = read_channel(data, self._schemas)
            if schema_number not in self._schemas:
                return False
            self.state.channels[channel] = number
            self._numbers.add(number)
        elif op == Op.MESSAGE:
            if chunk is None or size < MESSAGE_HEADER.size:
                return False
            number, _, stamp_ns, published_ns = MESSAGE_HEADER.unpack(head)
            if number not in self._numbers or stamp_ns != published_ns:
                return False
            within = start - chunk.start - CHUNK_START.size
            self.state.note(chunk, number, stamp_ns, within, size - MESSAGE_HEADER.size)
        elif op == Op.MESSAGE_INDEX and chunk is not None and size >= _INDEXED.size:
            (number,) = _INDEXED.unpack_from(head)
            chunk.indexes[number] = start
            chunk.index_bytes += end - start
        return True

    def _has_end(self) -> bool:
        end = self._at(max(self._end - FOOTER_BYTES, 0), FOOTER_BYTES)
        return end[:1] == bytes([Op.FOOTER]) and end.endswith(magic.MCAP)

    def _at(self, offset: int, size: int) -> bytes:
        self._file.seek(offset)
        return self._file.read(size)
