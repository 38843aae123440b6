# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The messages of a whole .mcap file without their payloads (https://mcap.dev/spec)."""

from __future__ import annotations

import heapq
import io
from collections.abc import Iterator
from operator import itemgetter
from pathlib import Path
from typing import BinaryIO

from mcap.reader import make_reader
from mcap.records import ChunkIndex

from smarttestudo.bags.mcap.record_bytes import CHUNK_HEADER, FRAME, MESSAGE_HEADER, Op, record_places
from smarttestudo.bags.mcap.records import BROKEN, chunk_content
from smarttestudo.bags.stored_file import ChannelsByNumber, Outline, OutlineError

_MESSAGE_BYTES = FRAME.size + MESSAGE_HEADER.size
"""How long a message without a payload is."""
_INDEX_ENTRY_BYTES = 16
_SMALL_RECORD_BYTES = 4096
"""Records up to this size, in the mean of a chunk, are read faster than they are hopped over."""

_Place = tuple[int, int, Outline | None]
"""Stamp in ns, start of the chunk, message; before the first of a chunk, none."""


def mcap_outlines(path: Path, channels: ChannelsByNumber, head_bytes: int) -> Iterator[Outline]:
    """The outlines of the messages of ``channels`` in the chunks of the file at ``path``, in time order.

    Raises ``OutlineError`` where the records of a chunk make no sense.
    """
    try:
        with path.open("rb") as file:
            summary = make_reader(file).get_summary()
            if summary is None:
                raise OutlineError("no summary")
            chunks = (_in_chunk(file, chunk, channels, head_bytes) for chunk in summary.chunk_indexes)
            for _, _, outline in heapq.merge(*chunks, key=itemgetter(0, 1)):
                if outline is not None:
                    yield outline
    except BROKEN as error:
        raise OutlineError(str(error)) from error


def _in_chunk(
    file: BinaryIO, chunk: ChunkIndex, channels: ChannelsByNumber, head_bytes: int
) -> Iterator[_Place]:
    # The merge takes the first item of all chunks at once; this one keeps a chunk unread until it is due.
    yield chunk.message_start_time, 0, None
    content = chunk.chunk_start_offset + FRAME.size
    first = content + CHUNK_HEADER.size
    messages = chunk.message_index_length // _INDEX_ENTRY_BYTES
    if chunk.compression:
        file.seek(content)
        unpacked = chunk_content(file.read(chunk.chunk_length - FRAME.size), is_whole=True)
        outlines = _outlines(io.BytesIO(unpacked), 0, len(unpacked), channels, head_bytes)
    elif chunk.uncompressed_size <= messages * _SMALL_RECORD_BYTES:
        file.seek(first)
        records = file.read(chunk.uncompressed_size)
        if len(records) < chunk.uncompressed_size:
            raise OutlineError("a chunk is cut off")
        outlines = _outlines(io.BytesIO(records), 0, len(records), channels, head_bytes)
    else:
        outlines = _outlines(file, first, first + chunk.uncompressed_size, channels, head_bytes)
    for outline in sorted(outlines, key=itemgetter(1)):
        yield outline[1], chunk.chunk_start_offset, outline


def _outlines(
    records: BinaryIO, start: int, end: int, channels: ChannelsByNumber, head_bytes: int
) -> Iterator[Outline]:
    header_bytes, next_start = MESSAGE_HEADER.size, start
    for op, at, next_start, data in record_places(records, start, end, header_bytes + head_bytes):
        if next_start > end:
            raise OutlineError("a record is longer than its chunk")
        if op != Op.MESSAGE:
            continue
        number, _, stamp_ns, _ = MESSAGE_HEADER.unpack_from(data)
        if number in channels:
            yield channels[number], stamp_ns, next_start - at - _MESSAGE_BYTES, data[header_bytes:]
    if next_start < end:
        raise OutlineError("a record is cut off")
