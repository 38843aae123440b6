# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A file that ``McapWriter`` began: read as far as it goes, and completed."""

from __future__ import annotations

import struct
from pathlib import Path
from typing import BinaryIO

from smarttestudo.bags.mcap.record_bytes import (
    CHUNK_START,
    FOOTER_BYTES,
    FRAME,
    MAGIC,
    MESSAGE_HEADER,
    ChunkPlace,
    Op,
    RecordPlace,
    StoredChannel,
    file_start,
    read_channel,
    read_schema,
    record_places,
)
from smarttestudo.bags.mcap.writer import FileContent, McapState, McapWriter
from smarttestudo.domain.errors import RecordingError
from smarttestudo.files.removal import remove

_MAX_DESCRIPTION_BYTES = 10_000_000
_INDEXED = struct.Struct("<H")
"""The channel whose messages an index has."""


def complete_file(path: Path) -> tuple[FileContent, dict[str, StoredChannel]]:
    """Complete a file: return its content and its channels by topic.

    A file without an end gets one; half a message is cut off. Raises ``RecordingError`` for a file of
    another origin, ``OSError`` where it cannot be written.
    """
    try:
        with path.open("rb") as file:
            walk = _Walk(file)
            is_whole = walk.read()
    except (struct.error, ValueError) as error:
        raise RecordingError("is damaged", place=str(path)) from error
    state = walk.state
    channels = {channel.topic: channel for channel in state.channels}
    return state.content() if is_whole else McapWriter(path, state).close(), channels


def complete_files(folder: Path) -> tuple[dict[str, FileContent], dict[str, StoredChannel]]:
    """Complete the files of an incident: return their content by name, and their channels by topic.

    The names are in the order of time. A file with less than a beginning, as the process was killed, is
    removed. Raises as ``complete_file``.
    """
    files: dict[str, FileContent] = {}
    channels: dict[str, StoredChannel] = {}
    beginning = file_start()
    # The file of latched messages was written after those that begin when it does.
    for file in sorted(folder.glob("*.mcap"), key=lambda one: (len(one.name), one.name), reverse=True):
        if file.is_symlink():
            continue
        if file.stat().st_size < len(beginning) and beginning.startswith(file.read_bytes()):
            remove(folder, [file.name])
            continue
        files[file.name], found = complete_file(file)
        channels.update(found)
    return dict(sorted(files.items(), key=lambda entry: (entry[1].first_ns, entry[1].last_ns))), channels


class _Walk:
    """Over the records of ``file``, in their order."""

    def __init__(self, file: BinaryIO) -> None:
        self._file = file
        self._file_bytes = file.seek(0, 2)
        self._schemas: dict[int, tuple[str, str]] = {}
        self.state = McapState()

    def read(self) -> bool:
        """Take in all records; whether the file has an end. If not, its last chunk is left open."""
        if self._at(0, len(MAGIC)) != MAGIC:
            raise ValueError("not an mcap file")
        is_whole = self._has_end()
        end = self._read_records()
        state = self.state
        of_channels = {channel.type_name for channel in state.channels}
        state.schemas = {name: number for number, (name, _) in self._schemas.items() if name in of_channels}
        if is_whole:
            state.close_chunk()
        elif state.chunk is not None:
            state.size_bytes = state.chunk.start + CHUNK_START.size + state.chunk.record_bytes
        else:
            state.size_bytes = end
        return is_whole

    def _read_records(self) -> int:
        """Note all records; where the last whole one ends."""
        end, file_bytes = len(MAGIC), self._file_bytes
        for place in record_places(self._file, end, file_bytes, MESSAGE_HEADER.size, enters_chunks=True):
            op, start, next_start, _ = place
            if op in (0, Op.DATA_END, Op.FOOTER) or next_start > file_bytes:
                break
            if op == Op.CHUNK:
                self.state.close_chunk()
                self.state.chunk = ChunkPlace(start=start)
                end = start + CHUNK_START.size
                continue
            self._note(place)
            if op == Op.SCHEMA:
                # Without the channel that it was written for it is cut off.
                continue
            end = next_start
            chunk = self.state.chunk
            if chunk is not None and op in (Op.CHANNEL, Op.MESSAGE):
                chunk.record_bytes = end - chunk.start - CHUNK_START.size
        return end

    def _note(self, place: RecordPlace) -> None:
        state, chunk = self.state, self.state.chunk
        op, start, end, head = place
        content = start + FRAME.size
        size = end - content
        if op in (Op.SCHEMA, Op.CHANNEL) and size > _MAX_DESCRIPTION_BYTES:
            raise ValueError("too large a description")
        if op == Op.SCHEMA:
            number, name, definition = read_schema(self._at(content, size))
            self._schemas[number] = name, definition
        elif op == Op.CHANNEL:
            number, channel = read_channel(self._at(content, size), self._schemas)
            state.channels[channel] = number
        elif op == Op.MESSAGE and chunk is not None and size >= MESSAGE_HEADER.size:
            number, _, stamp_ns, _ = MESSAGE_HEADER.unpack(head)
            within = start - chunk.start - CHUNK_START.size
            state.note(chunk, number, stamp_ns, within, size - MESSAGE_HEADER.size)
        elif op == Op.MESSAGE_INDEX and chunk is not None and size >= _INDEXED.size:
            (number,) = _INDEXED.unpack_from(head)
            chunk.indexes[number] = start
            chunk.index_bytes += end - start

    def _has_end(self) -> bool:
        end = self._at(max(self._file_bytes - FOOTER_BYTES, 0), FOOTER_BYTES)
        return end[:1] == bytes([Op.FOOTER]) and end.endswith(MAGIC)

    def _at(self, offset: int, size: int) -> bytes:
        self._file.seek(offset)
        return self._file.read(size)
