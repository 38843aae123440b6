# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The records of an MCAP file, one after the other, as far as they go (https://mcap.dev/spec)."""

from __future__ import annotations

import io
import struct
from collections import Counter
from collections.abc import Generator, Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import BinaryIO

import lz4.frame  # type: ignore[import-untyped]
import zstandard

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
from smarttestudo.bags.mcap.summary import ChannelEntry, SchemaEntry, read_channel, read_schema
from smarttestudo.bags.stored_file import OutlineError
from smarttestudo.bags.unpacking import (
    MAX_UNPACKED_BYTES,
    Buffer,
    TooLargeError,
    begin_frame,
    unpacked_content,
)
from smarttestudo.domain.units import grouped

_CONTENT = frozenset({Op.SCHEMA, Op.CHANNEL, Op.MESSAGE, Op.CHUNK})
_KNOWN = frozenset(Op)
BROKEN = (
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
"""What reading damaged bytes, and the decompressors, raise."""
_LONGEST_NAME_BYTES = 64
_DAMAGED_CHUNKS, _DAMAGED_RECORDS = "damaged chunks", "damaged records"
_TOO_LARGE_CHUNKS = (
    f"chunks longer than declared or than {grouped(MAX_UNPACKED_BYTES)} bytes, which are not decompressed"
)


@dataclass(frozen=True, slots=True, kw_only=True)
class MessageEntry:
    """A message; ``head`` are all bytes of its payload, or the first ones."""

    channel_id: int
    log_time: int
    payload_bytes: int
    head: bytes


Record = SchemaEntry | ChannelEntry | MessageEntry


class CompressionError(ValueError):
    """A chunk is compressed in another way than any that is read, which its text says."""


class RecordReader:
    """Walks over the records of a file and reads those that hold messages or describe them.

    ``cut_off_at`` is the byte at which the file stops making sense, ``None`` while it does.
    ``statistics`` is the content of the last record of these, ``indexed_messages`` how many the indexes
    behind each chunk name, by the byte that it begins at. ``unknown_records`` are of no kind that MCAP has.
    """

    def __init__(self, file: BinaryIO) -> None:
        self._file = file
        self.file_bytes = file.seek(0, 2)
        self.cut_off_at: int | None = None
        self.statistics = b""
        self.indexed_messages: Counter[int] = Counter()
        self.unknown_records = 0
        self._lost_at: dict[int, tuple[str, int]] = {}

    @property
    def losses(self) -> Counter[str]:
        """Records and chunks of which some or all could not be read, so far, by what they are."""
        return Counter(what for what, _ in self._lost_at.values())

    @property
    def lost_bytes(self) -> int:
        """The bytes of all these that could not be read."""
        return sum(lost_bytes for _, lost_bytes in self._lost_at.values())

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

    def read(self, place: RecordPlace) -> Iterator[Record]:
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
                self._lost_at[start] = _DAMAGED_RECORDS, len(content)
            return
        try:
            records = chunk_content(content, is_whole=is_whole)
        except TooLargeError:
            self._lost_at[start] = _TOO_LARGE_CHUNKS, len(content)
            return
        except CompressionError as error:
            self._lost_at[start] = f"chunks {error}", len(content)
            return
        except BROKEN:
            self._lost_at[start] = _DAMAGED_CHUNKS, len(content)
            return
        lost_bytes = yield from _records_in(records)
        if is_whole:
            promised_bytes = _unpacked_bytes(content)
            lost_bytes = max(lost_bytes, abs(promised_bytes - len(records)))
            if lost_bytes:
                of_bytes = max(promised_bytes, len(records))
                self._lost_at[start] = _DAMAGED_CHUNKS, len(content) * lost_bytes // of_bytes

    def at(self, start: int) -> Iterator[Record]:
        """Records that ``read`` gave for the one that begins at byte ``start``."""
        return self.read(self._place_at(start))

    def heads(self, place: RecordPlace, head_bytes: int = 0) -> Iterator[Record]:
        """Records that ``read`` gives, without the payloads of messages; damage in them is not seen then."""
        op, *_ = place
        if op == Op.MESSAGE:
            yield from self._message_header(place)
            return
        plain = self._plain_records(place) if op == Op.CHUNK else None
        hopped = None if plain is None else self._hopped(plain, place, head_bytes)
        for record in self.read(place) if hopped is None else hopped:
            yield _with_head(record, head_bytes) if isinstance(record, MessageEntry) else record

    def heads_at(self, start: int, head_bytes: int) -> Iterator[Record]:
        """Records that ``heads`` gives for the one that begins at byte ``start``."""
        return self.heads(self._place_at(start, head_bytes), head_bytes)

    def _message_header(self, place: RecordPlace) -> Iterator[MessageEntry]:
        """The message at ``place`` without its payload; nothing if it is not whole."""
        _, start, end, data = place
        payload_bytes = end - start - FRAME.size - MESSAGE_HEADER.size
        if end > self.file_bytes:
            return
        if payload_bytes < 0:
            self._lost_at[start] = _DAMAGED_RECORDS, end - start
            return
        channel_id, _, log_time, _ = MESSAGE_HEADER.unpack_from(data)
        head = data[MESSAGE_HEADER.size :]
        yield MessageEntry(channel_id=channel_id, log_time=log_time, payload_bytes=payload_bytes, head=head)

    def _plain_records(self, chunk: RecordPlace) -> int | None:
        """Where the records of a chunk begin that is not compressed, else ``None``."""
        _, start, *_ = chunk
        header = self._read_at(start + FRAME.size, CHUNK_HEADER.size)
        is_plain = len(header) == CHUNK_HEADER.size and not int.from_bytes(header[28:32], "little")
        return start + CHUNK_START.size if is_plain else None

    def _hopped(self, start: int, chunk: RecordPlace, head_bytes: int) -> list[Record] | None:
        """The heads of the records from ``start`` to the end of ``chunk``; ``None`` if they do not fit it."""
        heads: list[Record] = []
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


def _with_head(message: MessageEntry, head_bytes: int) -> MessageEntry:
    return replace(message, head=message.head[:head_bytes])


def chunk_content(chunk: Buffer, *, is_whole: bool) -> bytes:
    """The records in ``chunk``, decompressed as far as it goes."""
    chunk = memoryview(chunk)
    name_bytes = int.from_bytes(chunk[28:32], "little")
    if len(chunk) < CHUNK_HEADER.size + name_bytes:
        if is_whole:
            raise ValueError("a chunk is shorter than its header")
        return b""
    if name_bytes > _LONGEST_NAME_BYTES:
        raise ValueError("a chunk names no compression")
    compression = str(chunk[32 : 32 + name_bytes], "utf-8", "backslashreplace")
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
    raise CompressionError(f"compressed with {compression!r}, which is not read")


def _records_in(content: bytes) -> Generator[Record, None, int]:
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


def _parse(op: int, content: bytes) -> Record | None:
    """The record, ``None`` if it is of another kind or makes no sense."""
    with suppress(struct.error, ValueError):
        if op == Op.MESSAGE:
            number, _, stamp_ns, _ = MESSAGE_HEADER.unpack_from(content)
            payload = content[MESSAGE_HEADER.size :]
            return MessageEntry(
                channel_id=number, log_time=stamp_ns, payload_bytes=len(payload), head=payload
            )
        if op == Op.SCHEMA:
            return read_schema(content)
        if op == Op.CHANNEL:
            return read_channel(content)
    return None
