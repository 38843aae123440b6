# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The stamps of an MCAP file in the order in which its messages were written."""

from __future__ import annotations

import struct
from collections.abc import Iterable, Iterator
from itertools import chain, pairwise
from operator import itemgetter
from typing import BinaryIO

from smarttestudo.bags.mcap.record_bytes import FRAME, Op
from smarttestudo.bags.mcap.summary import ChunkEntry
from smarttestudo.bags.stray_stamps import LEAST_BACK_NS

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
