# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""An .mcap file with a whole index (https://mcap.dev/spec)."""

from __future__ import annotations

import struct
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from itertools import chain, pairwise
from operator import attrgetter, itemgetter
from pathlib import Path
from typing import BinaryIO

from smarttestudo.bags import magic
from smarttestudo.bags.channel_reader import ChannelReader
from smarttestudo.bags.mcap.record_bytes import (
    CHUNK_START,
    FRAME,
    HOLD_MESSAGES,
    IN_CHUNKS,
    MESSAGE_HEADER,
    Op,
    is_altered,
    record_places,
)
from smarttestudo.bags.mcap.recovered import FoundMessage, in_time_order
from smarttestudo.bags.mcap.summary import ChunkEntry, McapSummary, StatisticsEntry, read_summary
from smarttestudo.bags.stored_file import ChannelsByNumber, ContinuedFile, Outline, OutlineError, StoredFile
from smarttestudo.bags.stray_stamps import LEAST_BACK_NS
from smarttestudo.domain.recording import RecordedMessage, RecordedSize
from smarttestudo.domain.units import LAST_STAMP_NS

_INDEX_START = struct.Struct("<HI")
"""The channel, and the bytes of the entries."""
_INDEX_ENTRY = struct.Struct("<QQ")
"""The stamp of a message, and its place in the chunk."""


def overlap(chunks: Iterable[ChunkEntry]) -> bool:
    """Whether one of ``chunks``, in the order of writing, begins before an earlier one ended."""
    latest_ns = 0
    for chunk in chunks:
        if latest_ns - chunk.message_start_time > LEAST_BACK_NS:
            return True
        latest_ns = max(latest_ns, chunk.message_end_time)
    return False


def furthest_back_in(file: BinaryIO, chunks: Iterable[ChunkEntry]) -> int:
    """How far stamps of a channel go back in ``chunks``, in the order of writing, by the indexes behind them.

    Raises ``struct.error`` where these make no sense, and ``OSError``.
    """
    latest: dict[int, list[int]] = {}
    back_ns = 0
    for chunk in chunks:
        file.seek(chunk.chunk_start_offset + chunk.chunk_length)
        for number, stamps_ns in _indexes(file.read(chunk.message_index_length)):
            back_ns = max(back_ns, _furthest_back_ns([*latest.get(number, ()), *stamps_ns]))
            latest[number] = stamps_ns[-1:]
    return back_ns


def _furthest_back_ns(stamps_ns: Iterable[int]) -> int:
    """How far a stamp is before the one that was written before it; 0 where none is."""
    return max(chain((0,), (before - after for before, after in pairwise(stamps_ns))))


def _indexes(data: bytes) -> Iterator[tuple[int, list[int]]]:
    """Channels with the stamps of their messages, as they were written."""
    at = 0
    while at < len(data):
        op, size_bytes = FRAME.unpack_from(data, at)
        start, at = at + FRAME.size, at + FRAME.size + size_bytes
        if op == Op.MESSAGE_INDEX:
            number, _ = _INDEX_START.unpack_from(data, start)
            entries = _INDEX_ENTRY.iter_unpack(data[start + _INDEX_START.size : at])
            yield number, [stamp_ns for stamp_ns, _ in sorted(entries, key=itemgetter(1))]


_SMALL_RECORD_BYTES = 4096
"""Records up to this size, in the mean of a chunk, are read faster than they are hopped over."""

_BROKEN = (struct.error, ValueError, MemoryError)
"""What damaged bytes raise, but for those of compressed chunks."""


def full_index(path: Path) -> McapSummary | None:
    """The summary of a file if it lists every channel, and every chunk where it is, with its messages.

    Else nobody knows what is in it without reading all of it. Nor do times count that no clock of ROS has.
    """
    try:
        with path.open("rb") as file:
            summary = read_summary(file)
            if summary is None or summary.statistics is None:
                return None
            is_full = _is_full(summary, summary.statistics) and _has_all_messages(summary, file)
    except _BROKEN:
        return None
    return summary if is_full else None


def _has_all_messages(summary: McapSummary, file: BinaryIO) -> bool:
    """Whether there are messages nowhere but in the chunks that ``summary`` names, one behind the other."""
    gap_start = len(magic.MCAP)
    for chunk in sorted(summary.chunks, key=attrgetter("chunk_start_offset")):
        if not _is_without_messages(file, gap_start, chunk.chunk_start_offset):
            return False
        gap_start = chunk.chunk_start_offset + chunk.chunk_length + chunk.message_index_length
    return _is_without_messages(file, gap_start, summary.start)


def _is_without_messages(file: BinaryIO, start: int, end: int) -> bool:
    """Whether the records between two bytes, which they fill, hold no messages."""
    at = start
    for op, _, after, _ in record_places(file, start, end, 0):
        if op in HOLD_MESSAGES:
            return False
        at = after
    return at == end


def _is_full(summary: McapSummary, statistics: StatisticsEntry) -> bool:
    indexed: Counter[int] = Counter()
    for chunk in summary.chunks:
        indexed.update(chunk.indexed)
    if indexed != Counter(statistics.channels) or statistics.message_count != indexed.total():
        return False
    if statistics.message_end_time > LAST_STAMP_NS:
        return False
    described = all(
        number in summary.channels and summary.channels[number].schema_id in summary.schemas
        for number in statistics.channels
    )
    return described and all(chunk.indexed for chunk in summary.chunks)


class McapFile(ContinuedFile):
    """Reads chunk by chunk as the index says; where that fails, as a damaged file from there on.

    It is open from the first chunk that is read to the last: a recording may have thousands of files.
    """

    def __init__(self, path: Path, index: McapSummary) -> None:
        assert index.statistics is not None
        self._path = path
        self._reader = ChannelReader()
        self._counted = index.statistics.channels
        self.channels: ChannelsByNumber = {
            number: self._reader.of_mcap(channel, index.schemas[channel.schema_id])
            for number, channel in index.channels.items()
            if channel.schema_id in index.schemas
        }
        chunks = sorted(index.chunks, key=attrgetter("message_start_time", "chunk_start_offset"))
        self._places = [(chunk.message_start_time, chunk) for chunk in chunks]
        self._opened: BinaryIO | None = None
        super().__init__(
            message_count=index.statistics.message_count,
            # The statistics of some writers leave out messages of stamp 0.
            start_ns=min(
                (index.statistics.message_start_time, *(chunk.message_start_time for chunk in chunks))
            ),
            end_ns=max((index.statistics.message_end_time, *(chunk.message_end_time for chunk in chunks))),
        )

    def outlines(self, channels: ChannelsByNumber, head_bytes: int) -> Iterator[Outline]:
        """The outlines of ``messages``; of chunks that are not compressed, large payloads are not read."""
        read = partial(self._heads_in, channels=channels, head_bytes=head_bytes)
        try:
            for stamp_ns, number, size_bytes, head in self._in_time_order(read):
                yield channels[number], stamp_ns, size_bytes, head
        except _BROKEN as error:
            raise OutlineError(str(error)) from error

    def sizes(self, channels: ChannelsByNumber) -> Iterator[RecordedSize]:
        """The sizes of ``messages``, read as ``outlines`` are."""
        read = partial(self._heads_in, channels=channels, head_bytes=0)
        try:
            for stamp_ns, number, size_bytes, _ in self._in_time_order(read):
                yield channels[number], stamp_ns, size_bytes
        except _BROKEN as error:
            raise OutlineError(str(error)) from error

    def notices(self) -> Sequence[str]:
        """Losses, one line each, once all messages were read."""
        return [*dict.fromkeys((*self._reader.notices, *super().notices()))]

    def close(self) -> None:
        if self._opened is not None:
            self._opened.close()
            self._opened = None

    @property
    def _file(self) -> BinaryIO:
        if self._opened is None:
            self._opened = self._path.open("rb")
        return self._opened

    def _in_time_order(self, read: Callable[[ChunkEntry], list[FoundMessage]]) -> Iterator[FoundMessage]:
        yield from in_time_order(self._places, read)
        self.close()

    def _as_stored(self, channels: ChannelsByNumber) -> Iterator[RecordedMessage]:
        read = partial(self._messages_in, channels=channels)
        for stamp_ns, number, _, payload in self._in_time_order(read):
            yield channels[number], stamp_ns, payload

    def _counts_of_whole(self) -> Mapping[int, int]:
        return self._counted

    def _back_of_whole_ns(self) -> int:
        chunks = sorted((chunk for _, chunk in self._places), key=attrgetter("chunk_start_offset"))
        # Of several chunks, those of a clock that was set overlap; within one, only its indexes tell.
        if len(chunks) > 1 and not overlap(chunks):
            return 0
        try:
            with self._path.open("rb") as file:
                return furthest_back_in(file, chunks)
        except (OSError, *_BROKEN):
            return 0

    def _recovered(self) -> StoredFile:
        from smarttestudo.bags.mcap.recovered import RecoveredMcapFile  # noqa: PLC0415  most are whole

        return RecoveredMcapFile(self._path)

    def _messages_in(
        self, chunk: ChunkEntry, channels: ChannelsByNumber, head_bytes: int | None = None
    ) -> list[FoundMessage]:
        """The messages of ``channels`` in a chunk, with the first ``head_bytes`` or all of each payload."""
        self._file.seek(chunk.chunk_start_offset)
        data = self._file.read(chunk.chunk_length)
        if FRAME.unpack_from(data) != (Op.CHUNK, chunk.chunk_length - FRAME.size):
            raise OutlineError("a chunk is not where its index says")
        if chunk.compression:
            from smarttestudo.bags.mcap.records import whole_chunk_content  # noqa: PLC0415  slow to import

            data = whole_chunk_content(memoryview(data)[FRAME.size :])
            return _wanted(_messages_of(data, 0, channels, head_bytes), chunk, channels)
        if len(data) != CHUNK_START.size + chunk.uncompressed_size:
            raise OutlineError("a chunk is of another size than its index says")
        if is_altered(data):
            raise OutlineError("a chunk is not that of its checksum")
        return _wanted(_messages_of(data, CHUNK_START.size, channels, head_bytes), chunk, channels)

    def _heads_in(self, chunk: ChunkEntry, channels: ChannelsByNumber, head_bytes: int) -> list[FoundMessage]:
        """The same, with the first bytes of each at least."""
        if chunk.compression or chunk.uncompressed_size <= sum(chunk.indexed.values()) * _SMALL_RECORD_BYTES:
            return self._messages_in(chunk, channels, head_bytes)
        first = chunk.chunk_start_offset + CHUNK_START.size
        return _wanted(self._hopped(first, first + chunk.uncompressed_size, head_bytes), chunk, channels)

    def _hopped(self, start: int, end: int, head_bytes: int) -> list[FoundMessage]:
        found: list[FoundMessage] = []
        header_bytes, next_start = MESSAGE_HEADER.size, start
        for op, at, next_start, data in record_places(self._file, start, end, header_bytes + head_bytes):
            if next_start > end:
                raise OutlineError("a record is longer than its chunk")
            if op != Op.MESSAGE:
                _require_in_chunk(op)
                continue
            number, _, stamp_ns, _ = MESSAGE_HEADER.unpack_from(data)
            payload_bytes = next_start - at - FRAME.size - header_bytes
            found.append((stamp_ns, number, payload_bytes, data[header_bytes:]))
        if next_start < end:
            raise OutlineError("a record is cut off")
        return found


def _wanted(found: list[FoundMessage], chunk: ChunkEntry, channels: ChannelsByNumber) -> list[FoundMessage]:
    """The messages of ``channels`` among those ``found`` in a chunk, which are to be those of its indexes."""
    if Counter(map(itemgetter(1), found)) != Counter(chunk.indexed):
        raise OutlineError("a chunk holds other messages than its indexes name")
    return (
        found
        if chunk.indexed.keys() <= channels.keys()
        else [entry for entry in found if entry[1] in channels]
    )


def _require_in_chunk(op: int) -> None:
    if op not in IN_CHUNKS:
        raise OutlineError("a chunk holds what is no record")


def _messages_of(
    records: bytes, at: int, channels: ChannelsByNumber, head_bytes: int | None
) -> list[FoundMessage]:
    """The messages among the records of a chunk, of which the first begins at byte ``at``.

    Messages of ``channels`` have their payloads, or the first ``head_bytes`` of them.
    """
    found: list[FoundMessage] = []
    end = len(records)
    # Attributes of classes and enumerations would take half of the time.
    frame_at, frame_bytes, message = FRAME.unpack_from, FRAME.size, int(Op.MESSAGE)
    header_at, header_bytes = MESSAGE_HEADER.unpack_from, MESSAGE_HEADER.size
    while at + frame_bytes <= end:
        op, size_bytes = frame_at(records, at)
        content = at + frame_bytes
        at = content + size_bytes
        if at > end:
            raise OutlineError("a record is longer than its chunk")
        if op == message:
            if size_bytes < header_bytes:
                raise OutlineError("a message is shorter than its header")
            number, _, stamp_ns, _ = header_at(records, content)
            start = content + header_bytes
            read_to = at if head_bytes is None else min(at, start + head_bytes)
            payload = records[start:read_to] if number in channels else b""
            found.append((stamp_ns, number, at - start, payload))
        else:
            _require_in_chunk(op)
    if at < end:
        raise OutlineError("a record is cut off")
    return found
