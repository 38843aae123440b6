# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The records of an MCAP file, one after the other, as far as they go (https://mcap.dev/spec)."""

from __future__ import annotations

import io
import struct
from collections import Counter
from collections.abc import Generator, Iterator
from contextlib import suppress
from dataclasses import dataclass
from typing import BinaryIO

import lz4.frame  # type: ignore[import-untyped]
import zstandard
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.records import Channel, McapRecord, Message, Schema

from smarttestudo.bags import magic
from smarttestudo.bags.mcap.record_bytes import (
    CHUNK_HEADER,
    CHUNK_START,
    FIRST_PRIVATE_OP,
    FRAME,
    IN_CHUNKS,
    INDEX_ENTRY_BYTES,
    INDEX_START_BYTES,
    MESSAGE_HEADER,
    Op,
    RecordPlace,
    has_checksum,
    record_places,
)
from smarttestudo.bags.stored_file import OutlineError
from smarttestudo.bags.unpacking import Buffer, TooLargeError, unpacked_content
from smarttestudo.bags.zstd_files import begin_frame

_CONTENT = frozenset({Op.SCHEMA, Op.CHANNEL, Op.MESSAGE, Op.CHUNK})
_KNOWN = frozenset(Op)
BROKEN = (
    McapError,
    struct.error,
    ValueError,
    LookupError,
    EOFError,
    MemoryError,
    OverflowError,
    RuntimeError,
    StopIteration,
    zstandard.ZstdError,
)
"""What mcap and the decompressors raise on damaged bytes."""


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
    ``too_large_chunks`` were not unpacked.
    ``statistics`` is the content of the last record of these, ``indexed_messages`` how many the indexes
    behind each chunk name, by the byte that it begins at. ``unknown_records`` are of no kind that MCAP has.
    """

    def __init__(self, file: BinaryIO) -> None:
        self._file = file
        self.file_bytes = file.seek(0, 2)
        self.cut_off_at: int | None = None
        self.too_large_chunks = 0
        self.statistics = b""
        self.indexed_messages: Counter[int] = Counter()
        self.unknown_records = 0
        self._damaged_bytes_at: dict[int, int] = {}

    @property
    def damaged_chunks(self) -> int:
        """Chunks of which some or all could not be read, so far."""
        return len(self._damaged_bytes_at)

    @property
    def damaged_bytes(self) -> int:
        """The bytes of these chunks that could not be read."""
        return sum(self._damaged_bytes_at.values())

    def places(self) -> Iterator[RecordPlace]:
        """Every schema, channel, message and chunk up to the footer; the last may be cut off."""
        chunk = end = len(magic.MCAP)
        for place in record_places(self._file, end, self.file_bytes, MESSAGE_HEADER.size):
            op, start, end, _ = place
            if op == 0 or end > self.file_bytes:
                self.cut_off_at = start
            elif op == Op.FOOTER:
                if self._read_at(end, len(magic.MCAP) + 1) != magic.MCAP:
                    self.cut_off_at = end
                return
            if op in _CONTENT:
                chunk = start
                yield place
            if self.cut_off_at is not None:
                return
            if op == Op.MESSAGE_INDEX:
                self.indexed_messages[chunk] += (end - start - INDEX_START_BYTES) // INDEX_ENTRY_BYTES
            elif op == Op.STATISTICS:
                self.statistics = self._read_at(start + FRAME.size, end - start - FRAME.size)
            elif op not in _KNOWN and op < FIRST_PRIVATE_OP:
                self.unknown_records += 1
        self.cut_off_at = end

    def read(self, place: RecordPlace) -> Iterator[McapRecord]:
        """The record at ``place``, or those in it if it is a chunk; of a cut-off one, what is whole."""
        op, start, end, _ = place
        is_whole = end <= self.file_bytes
        content_start = start + FRAME.size
        content = self._read_at(content_start, min(end, self.file_bytes) - content_start)
        if op != Op.CHUNK:
            record = _parse(op, content) if is_whole else None
            if record is not None:
                yield record
            elif is_whole:
                self._damaged_bytes_at[start] = len(content)
            return
        try:
            records = chunk_content(content, is_whole=is_whole)
        except BROKEN as error:
            if isinstance(error, TooLargeError):
                self.too_large_chunks += 1
            self._damaged_bytes_at[start] = len(content)
            return
        lost_bytes = yield from _records_in(records)
        if is_whole:
            promised_bytes = _unpacked_bytes(content)
            lost_bytes = max(lost_bytes, abs(promised_bytes - len(records)))
            if lost_bytes:
                of_bytes = max(promised_bytes, len(records))
                self._damaged_bytes_at[start] = len(content) * lost_bytes // of_bytes

    def at(self, start: int) -> Iterator[McapRecord]:
        """Records that ``read`` gave for the one that begins at byte ``start``."""
        return self.read(self._place_at(start))

    def heads(self, place: RecordPlace, head_bytes: int = 0) -> Iterator[McapRecord | MessageHeader]:
        """Records that ``read`` gives, without the payloads of messages; damage in them is not seen then."""
        op, *_ = place
        if op == Op.MESSAGE:
            yield from self._message_header(place)
            return
        plain = self._plain_records(place) if op == Op.CHUNK else None
        hopped = None if plain is None else self._hopped(plain, place, head_bytes)
        for record in self.read(place) if hopped is None else hopped:
            yield _header_of(record, head_bytes) if isinstance(record, Message) else record

    def heads_at(self, start: int, head_bytes: int) -> Iterator[McapRecord | MessageHeader]:
        """Records that ``heads`` gives for the one that begins at byte ``start``."""
        return self.heads(self._place_at(start, head_bytes), head_bytes)

    def _message_header(self, place: RecordPlace) -> Iterator[MessageHeader]:
        """The message at ``place`` without its payload; nothing if it is not whole."""
        _, start, end, data = place
        payload_bytes = end - start - FRAME.size - MESSAGE_HEADER.size
        if end > self.file_bytes:
            return
        if payload_bytes < 0:
            self._damaged_bytes_at[start] = end - start
            return
        channel_id, _, log_time, _ = MESSAGE_HEADER.unpack_from(data)
        head = data[MESSAGE_HEADER.size :]
        yield MessageHeader(channel_id=channel_id, log_time=log_time, payload_bytes=payload_bytes, head=head)

    def _plain_records(self, chunk: RecordPlace) -> int | None:
        """Where the records of a chunk begin that is not compressed, else ``None``."""
        _, start, *_ = chunk
        header = self._read_at(start + FRAME.size, CHUNK_HEADER.size)
        is_plain = len(header) == CHUNK_HEADER.size and not int.from_bytes(header[28:32], "little")
        return start + CHUNK_START.size if is_plain else None

    def _hopped(
        self, start: int, chunk: RecordPlace, head_bytes: int
    ) -> list[McapRecord | MessageHeader] | None:
        """The heads of the records from ``start`` to the end of ``chunk``; ``None`` if they do not fit it."""
        heads: list[McapRecord | MessageHeader] = []
        _, _, chunk_end, _ = chunk
        end = min(chunk_end, self.file_bytes)
        for place in record_places(self._file, start, end, MESSAGE_HEADER.size + head_bytes):
            op, at, start, _ = place
            if op not in IN_CHUNKS or (op == Op.MESSAGE and start - at < FRAME.size + MESSAGE_HEADER.size):
                return None
            heads += self.heads(place, head_bytes)
        return heads if start == chunk_end or chunk_end > self.file_bytes else None

    def _place_at(self, start: int, head_bytes: int = 0) -> RecordPlace:
        for place in record_places(self._file, start, self.file_bytes, MESSAGE_HEADER.size + head_bytes):
            return place
        raise EOFError("the file became shorter")

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


def chunk_content(chunk: Buffer, *, is_whole: bool) -> bytes:
    """The records in ``chunk``, decompressed as far as it goes."""
    chunk = memoryview(chunk)
    name_bytes = int.from_bytes(chunk[28:32], "little")
    if len(chunk) < CHUNK_HEADER.size + name_bytes:
        if is_whole:
            raise ValueError("a chunk is shorter than its header")
        return b""
    compression = str(chunk[32 : 32 + name_bytes], "utf-8")
    declared_bytes = int.from_bytes(chunk[16:24], "little")
    content = _decompress(compression, chunk[CHUNK_HEADER.size + name_bytes :], declared_bytes)
    checksum = int.from_bytes(chunk[24:28], "little")
    if is_whole and not has_checksum(content, checksum):
        raise ValueError("checksum mismatch")
    return content


def whole_chunk_content(chunk: Buffer) -> bytes:
    """The records in a chunk of a whole file. Raises ``OutlineError`` where they cannot be decompressed."""
    try:
        content = chunk_content(chunk, is_whole=True)
    except BROKEN as error:
        raise OutlineError(str(error)) from error
    if len(content) != _unpacked_bytes(chunk):
        raise OutlineError("a chunk is of another size than it says")
    return content


def _unpacked_bytes(chunk: bytes | memoryview) -> int:
    """How long the records of a chunk are, as it says."""
    return int.from_bytes(chunk[16:24], "little")


def _decompress(compression: str, data: Buffer, declared_bytes: int) -> bytes:
    if compression == "":
        return bytes(data)
    if compression == "zstd":
        return unpacked_content(data, begin_frame, declared_bytes)[0]
    if compression == "lz4":
        return unpacked_content(data, lz4.frame.LZ4FrameDecompressor, declared_bytes)[0]
    raise ValueError(f"unknown compression {compression!r}")


def _records_in(content: bytes) -> Generator[McapRecord, None, int]:
    """The records; gives how many bytes make no sense: of one, or all from the first on that does not fit."""
    known = lost_bytes = 0
    for op, start, end, _ in record_places(io.BytesIO(content), 0, len(content), 0):
        if end > len(content) or op not in IN_CHUNKS:
            break
        record = _parse(op, content[start + FRAME.size : end])
        if record is not None:
            yield record
        else:
            lost_bytes += end - start
        known = end
    return lost_bytes + len(content) - known


def _parse(op: int, content: bytes) -> McapRecord | None:
    """The record, ``None`` if it is of another kind or makes no sense."""
    stream = ReadDataStream(io.BytesIO(content))
    record: McapRecord | None = None
    with suppress(*BROKEN):
        if op == Op.MESSAGE:
            record = Message.read(stream, len(content))
        elif op == Op.SCHEMA:
            record = Schema.read(stream)
        elif op == Op.CHANNEL:
            record = Channel.read(stream)
    return record
