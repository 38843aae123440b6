# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The records of an MCAP file, one after the other, as far as they go (https://mcap.dev/spec)."""

from __future__ import annotations

import io
import struct
import zlib
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from typing import BinaryIO

import lz4.frame  # type: ignore[import-untyped]
import zstandard
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Channel, Chunk, McapRecord, Message, Schema

MAGIC = b"\x89MCAP0\r\n"
_FRAME = struct.Struct("<BQ")
_MESSAGE_HEADER = struct.Struct("<HIQQ")
_CHUNK_FIXED_BYTES = 40
_CONTENT = frozenset({Opcode.SCHEMA, Opcode.CHANNEL, Opcode.MESSAGE, Opcode.CHUNK})
BROKEN = (
    McapError,
    struct.error,
    ValueError,
    LookupError,
    EOFError,
    MemoryError,
    RuntimeError,
    StopIteration,
    zstandard.ZstdError,
)
"""What mcap and the decompressors raise on damaged bytes."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordPlace:
    """A record of the file's data section: its opcode, where its content starts, and how long it is."""

    opcode: int
    offset: int
    size_bytes: int


@dataclass(frozen=True, slots=True, kw_only=True)
class MessageHeader:
    """A message without its payload, of which ``head`` are the first bytes."""

    channel_id: int
    log_time: int
    payload_bytes: int
    head: bytes


class RecordReader:
    """Walks over the records of a file and reads those that hold messages or describe them.

    ``cut_off_at`` is the byte at which the file stops making sense, ``None`` while it does.
    """

    def __init__(self, file: BinaryIO) -> None:
        self._file = file
        self.file_bytes = file.seek(0, 2)
        self.cut_off_at: int | None = None
        self._damaged_bytes_at: dict[int, int] = {}

    @property
    def damaged_chunks(self) -> int:
        """Chunks that no message could be taken from, so far."""
        return len(self._damaged_bytes_at)

    @property
    def damaged_bytes(self) -> int:
        """The bytes of these chunks."""
        return sum(self._damaged_bytes_at.values())

    def places(self) -> Iterator[RecordPlace]:
        """Every schema, channel, message and chunk up to the footer; the last may be cut off."""
        start = len(MAGIC)
        while True:
            frame = self._read_at(start, _FRAME.size)
            if len(frame) < _FRAME.size:
                self.cut_off_at = start
                return
            opcode, size_bytes = _FRAME.unpack(frame)
            if opcode == Opcode.FOOTER:
                return
            content = start + _FRAME.size
            if opcode == 0 or content + size_bytes > self.file_bytes:
                self.cut_off_at = start
            if opcode in _CONTENT:
                yield RecordPlace(opcode=opcode, offset=content, size_bytes=size_bytes)
            if self.cut_off_at is not None:
                return
            start = content + size_bytes

    def read(self, place: RecordPlace) -> Iterator[McapRecord]:
        """The record at ``place``, or those in it if it is a chunk; of a cut-off one, what is whole."""
        content = self._read_at(place.offset, min(place.size_bytes, self.file_bytes - place.offset))
        if place.opcode != Opcode.CHUNK:
            record = _parse(place.opcode, content) if len(content) == place.size_bytes else None
            if record is not None:
                yield record
            return
        try:
            records = chunk_content(content, is_whole=len(content) == place.size_bytes)
        except BROKEN:
            self._damaged_bytes_at[place.offset] = len(content)
            return
        yield from _records_in(records)

    def at(self, offset: int) -> Iterator[McapRecord]:
        """Records that ``read`` gave for the one whose content starts at ``offset``."""
        return self.read(self._place_at(offset))

    def heads(self, place: RecordPlace, head_bytes: int = 0) -> Iterator[McapRecord | MessageHeader]:
        """Records that ``read`` gives, without the payloads of messages; damage in them is not seen then."""
        if place.opcode == Opcode.MESSAGE:
            yield from self._message_header(place, head_bytes)
            return
        plain = self._plain_records(place) if place.opcode == Opcode.CHUNK else None
        hopped = None if plain is None else self._hopped(plain, place, head_bytes)
        for record in self.read(place) if hopped is None else hopped:
            yield _header_of(record, head_bytes) if isinstance(record, Message) else record

    def heads_at(self, offset: int, head_bytes: int) -> Iterator[McapRecord | MessageHeader]:
        """Records that ``heads`` gives for the one whose content starts at ``offset``."""
        return self.heads(self._place_at(offset), head_bytes)

    def _message_header(self, place: RecordPlace, head_bytes: int) -> Iterator[MessageHeader]:
        """The message at ``place`` without its payload; nothing if it is not whole."""
        payload_bytes = place.size_bytes - _MESSAGE_HEADER.size
        if payload_bytes < 0 or place.offset + place.size_bytes > self.file_bytes:
            return
        content = self._read_at(place.offset, _MESSAGE_HEADER.size + min(head_bytes, payload_bytes))
        channel_id, _, log_time, _ = _MESSAGE_HEADER.unpack_from(content)
        head = content[_MESSAGE_HEADER.size :]
        yield MessageHeader(channel_id=channel_id, log_time=log_time, payload_bytes=payload_bytes, head=head)

    def _plain_records(self, chunk: RecordPlace) -> int | None:
        """Where the records of a chunk begin that is not compressed, else ``None``."""
        fixed = self._read_at(chunk.offset, _CHUNK_FIXED_BYTES)
        is_plain = len(fixed) == _CHUNK_FIXED_BYTES and not int.from_bytes(fixed[28:32], "little")
        return chunk.offset + _CHUNK_FIXED_BYTES if is_plain else None

    def _hopped(
        self, start: int, chunk: RecordPlace, head_bytes: int
    ) -> list[McapRecord | MessageHeader] | None:
        """The heads of the records from ``start`` to the end of ``chunk``; ``None`` if they do not fit it."""
        end = chunk.offset + chunk.size_bytes
        heads: list[McapRecord | MessageHeader] = []
        while start + _FRAME.size <= min(end, self.file_bytes):
            opcode, size_bytes = _FRAME.unpack(self._read_at(start, _FRAME.size))
            start += _FRAME.size
            if opcode in _CONTENT and opcode != Opcode.CHUNK:
                place = RecordPlace(opcode=opcode, offset=start, size_bytes=size_bytes)
                heads += self.heads(place, head_bytes)
            start += size_bytes
        return heads if start == end or end > self.file_bytes else None

    def _place_at(self, offset: int) -> RecordPlace:
        opcode, size_bytes = _FRAME.unpack(self._read_at(offset - _FRAME.size, _FRAME.size))
        return RecordPlace(opcode=opcode, offset=offset, size_bytes=size_bytes)

    def _read_at(self, offset: int, size: int) -> bytes:
        self._file.seek(offset)
        return self._file.read(size)


def _header_of(message: Message, head_bytes: int) -> MessageHeader:
    return MessageHeader(
        channel_id=message.channel_id,
        log_time=message.log_time,
        payload_bytes=len(message.data),
        head=message.data[:head_bytes],
    )


def chunk_content(chunk: bytes, *, is_whole: bool) -> bytes:
    """The records in ``chunk``, decompressed as far as it goes."""
    name_bytes = int.from_bytes(chunk[28:32], "little")
    if len(chunk) < _CHUNK_FIXED_BYTES + name_bytes:
        return b""
    compression = chunk[32 : 32 + name_bytes].decode()
    content = _decompress(compression, chunk[_CHUNK_FIXED_BYTES + name_bytes :])
    if is_whole:
        header = Chunk.read(ReadDataStream(io.BytesIO(chunk)))
        if header.uncompressed_crc and zlib.crc32(content) != header.uncompressed_crc:
            raise ValueError("checksum mismatch")
    return content


def _decompress(compression: str, data: bytes) -> bytes:
    if compression == "":
        return data
    if compression == "zstd":
        return zstandard.ZstdDecompressor().decompressobj().decompress(data)
    if compression == "lz4":
        content: bytes = lz4.frame.LZ4FrameDecompressor().decompress(data)
        return content
    raise ValueError(f"unknown compression {compression!r}")


def _records_in(content: bytes) -> Iterator[McapRecord]:
    start = 0
    while start + _FRAME.size <= len(content):
        opcode, size_bytes = _FRAME.unpack_from(content, start)
        start += _FRAME.size
        if start + size_bytes > len(content):
            return
        record = _parse(opcode, content[start : start + size_bytes])
        if record is not None:
            yield record
        start += size_bytes


def _parse(opcode: int, content: bytes) -> McapRecord | None:
    """The record, ``None`` if it is of another kind or makes no sense."""
    stream = ReadDataStream(io.BytesIO(content))
    record: McapRecord | None = None
    with suppress(*BROKEN):
        if opcode == Opcode.MESSAGE:
            record = Message.read(stream, len(content))
        elif opcode == Opcode.SCHEMA:
            record = Schema.read(stream)
        elif opcode == Opcode.CHANNEL:
            record = Channel.read(stream)
    return record
