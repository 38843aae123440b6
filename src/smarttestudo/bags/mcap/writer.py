# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Writes an MCAP file of which nothing is lost when the process is killed."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from smarttestudo.bags.mcap.record_bytes import (
    CHUNK_START,
    MESSAGE_HEADER,
    MESSAGE_START,
    ChunkPlace,
    Op,
    StoredChannel,
    channel_record,
    checksum_of,
    chunk_index,
    chunk_start,
    file_end,
    file_start,
    message_index,
    record,
    schema_record,
    statistics,
)
from smarttestudo.files.removal import remove

CHUNK_BYTES = 1 << 20


@dataclass(frozen=True, slots=True, kw_only=True)
class FileContent:
    """Content of a file: stamps in ns, messages and bytes of payload by topic.

    ``channels`` are in the order of the file, ``of_types`` are the messages by topic and type, as a topic may
    have had several types. ``final_ns`` is the stamp of the message that was written last, not the greatest
    one where the clock was set back.
    """

    channels: Sequence[StoredChannel]
    messages: Mapping[str, int]
    of_types: Mapping[tuple[str, str], int]
    size_bytes: Mapping[str, int]
    first_ns: int
    last_ns: int
    final_ns: int

    @property
    def message_count(self) -> int:
        """All messages."""
        return sum(self.messages.values())


@dataclass(slots=True, kw_only=True)
class McapState:
    """Content so far of a file that is being written.

    Schemas have numbers by type, channels by what they are; messages and bytes are counted by channel.
    ``chunks`` are closed, ``chunk`` is not; ``size_bytes`` is that of the file, ``final_ns`` the stamp of its
    last message.
    """

    size_bytes: int = 0
    final_ns: int = 0
    schemas: dict[str, int] = field(default_factory=dict)
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
        filled = [chunk for chunk in self.chunks if chunk.span_ns]
        messages, size_bytes = Counter[str](), Counter[str]()
        of_types = Counter[tuple[str, str]]()
        for channel, number in self.channels.items():
            messages[channel.topic] += self.messages[number]
            of_types[channel.topic, channel.type_name] += self.messages[number]
            size_bytes[channel.topic] += self.payload_bytes[number]
        return FileContent(
            channels=tuple(self.channels),
            messages=messages,
            of_types=of_types,
            size_bytes=size_bytes,
            first_ns=min((chunk.first_ns for chunk in filled), default=0),
            last_ns=max((chunk.last_ns for chunk in filled), default=0),
            final_ns=self.final_ns,
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
        """Append one message."""
        state = self._state
        chunk = state.chunk or self._open_chunk()
        number = state.channels.get(channel) or self._add(channel)
        within = state.size_bytes - chunk.start - CHUNK_START.size
        size = MESSAGE_HEADER.size + len(payload)
        self._append(MESSAGE_START.pack(Op.MESSAGE, size, number, 0, stamp_ns, stamp_ns), payload)
        state.note(chunk, number, stamp_ns, within, len(payload))
        if state.size_bytes - chunk.start > CHUNK_BYTES:
            self._close_chunk(chunk)

    def close(self) -> FileContent:
        """Write what readers look for at the end."""
        state = self._state
        if state.chunk is not None:
            self._close_chunk(state.chunk)
        self._append(record(Op.DATA_END, bytes(4)))
        first_of_types = {channel.type_name: channel for channel in reversed(state.channels)}
        counts = {number: state.messages[number] for number in state.channels.values()}
        groups = [
            (Op.SCHEMA, b"".join(self._schema(first_of_types[name]) for name in state.schemas)),
            (Op.CHANNEL, b"".join(map(self._channel, state.channels))),
            (Op.CHUNK_INDEX, b"".join(map(chunk_index, state.chunks))),
            (Op.STATISTICS, statistics(counts, schemas=len(state.schemas), chunks=state.chunks)),
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
        if channel.type_name not in state.schemas:
            state.schemas[channel.type_name] = len(state.schemas) + 1
            self._append(self._schema(channel))
        state.channels[channel] = number
        self._append(self._channel(channel))
        return number

    def _schema(self, channel: StoredChannel) -> bytes:
        return schema_record(self._state.schemas[channel.type_name], channel)

    def _channel(self, channel: StoredChannel) -> bytes:
        state = self._state
        return channel_record(state.channels[channel], state.schemas[channel.type_name], channel)

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
