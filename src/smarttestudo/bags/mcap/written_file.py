# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A file that ``McapWriter`` began: read as far as it goes, and completed."""

from __future__ import annotations

import struct
from pathlib import Path
from typing import BinaryIO

from smarttestudo.bags import magic
from smarttestudo.bags.mcap.record_bytes import (
    CHUNK_START,
    FOOTER_BYTES,
    FRAME,
    MESSAGE_HEADER,
    ChunkPlace,
    Op,
    RecordPlace,
    file_start,
    read_channel,
    read_schema,
    record_places,
)
from smarttestudo.bags.mcap.writer import FileContent, McapState, McapWriter
from smarttestudo.domain.errors import RecordingError
from smarttestudo.files.removal import remove

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
    for file in sorted(folder.glob("*.mcap"), key=lambda one: (len(one.name), one.name), reverse=True):
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
        self._schemas: dict[int, tuple[str, str]] = {}
        self._numbers: set[int] = set()
        self.state = state = McapState()
        if self._at(0, len(magic.MCAP)) != magic.MCAP:
            raise ValueError("not an mcap file")
        self.is_whole = self._has_end()
        self.ends_with_message = False
        records_end = self._read_records()
        of_channels = {channel.type_name for channel in state.channels}
        state.schemas = {name: number for number, (name, _) in self._schemas.items() if name in of_channels}
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
            number, name, definition = read_schema(self._at(content, size))
            self._schemas[number] = name, definition
        elif op == Op.CHANNEL:
            data = self._at(content, size)
            _, schema = _CHANNEL_START.unpack_from(data)
            number, channel = read_channel(data, self._schemas)
            if schema not in self._schemas:
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
