# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The order in which the bytes of a recording travel: a picture of all of it at once, then ever finer.

Each range travels as a head, which says where its bytes belong, and those bytes.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from itertools import accumulate
from typing import NamedTuple

from smarttestudo.domain.errors import LinkError
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.link.protocol.wire import Reader, varint

LARGE_MESSAGE_BYTES = 16_000
"""Topics whose messages are larger on average (images, clouds) come after all others."""
_FINEST_LEVEL = 20


class ByteRange(NamedTuple):
    """Bytes of the file with that number."""

    file: int
    offset: int
    size_bytes: int


class MessageRange(NamedTuple):
    """Where the record of a message stands."""

    file: int
    offset: int
    size_bytes: int
    topic: str
    stamp_ns: int


class Level(NamedTuple):
    """The first ``end`` bytes of an order hold a grid of ``rate_hz`` of all topics with small messages."""

    end: int
    rate_hz: float


class TransferOrder:
    """All bytes of some files, in the order in which they travel.

    First ``head``, which makes the files readable; then of each topic the first message of every second, of
    every half second and so on, topics of small messages before those of large ones within a level, and
    those of ``LARGE_MESSAGE_BYTES`` after all others; last ``tail``. The same ranges give the same order.
    """

    def __init__(
        self, head: Sequence[ByteRange], messages: Sequence[MessageRange], tail: Sequence[ByteRange] = ()
    ) -> None:
        ranked = sorted(_ranked(messages))
        self._ranges = [
            *head,
            *(
                ByteRange(message_range.file, message_range.offset, message_range.size_bytes)
                for _, message_range in ranked
            ),
            *tail,
        ]
        self._ends = list(accumulate(len(_head(range_)) + range_.size_bytes for range_ in self._ranges))
        self.size_bytes = self._ends[-1] if self._ends else 0
        """With the heads of ranges."""
        self.files_bytes = sum(range_.size_bytes for range_ in self._ranges)
        self.levels = tuple(self._levels([rank for rank, _ in ranked], len(head)))

    def stretches(self, offset: int, size_bytes: int) -> Iterator[bytes | ByteRange]:
        """Bytes from ``offset`` of the order on: heads of ranges, and where the bytes between are."""
        number = bisect_right(self._ends, offset)
        while size_bytes > 0 and number < len(self._ranges):
            range_ = self._ranges[number]
            head = _head(range_)
            skipped = offset - (self._ends[number] - len(head) - range_.size_bytes)
            if rest := head[skipped : skipped + size_bytes]:
                yield rest
            skipped_body = max(skipped - len(head), 0)
            size = min(size_bytes - len(rest), range_.size_bytes - skipped_body)
            if size > 0:
                yield ByteRange(range_.file, range_.offset + skipped_body, size)
            offset, size_bytes, number = self._ends[number], size_bytes - len(rest) - size, number + 1

    def _levels(self, ranks: Sequence[_Rank], heads: int) -> Iterator[Level]:
        """Where the levels of the small topics end that have any message."""
        for place, rank in enumerate(ranks):
            if rank.is_large:
                break
            is_last = place + 1 == len(ranks) or ranks[place + 1].is_large
            if is_last or ranks[place + 1].level != rank.level:
                yield Level(self._ends[heads + place], math.inf if is_last else float(2**rank.level))


class _Rank(NamedTuple):
    is_large: bool
    level: int
    mean_bytes: float
    topic: str


def _ranked(messages: Sequence[MessageRange]) -> Iterator[tuple[_Rank, MessageRange]]:
    topics: Mapping[str, list[MessageRange]] = defaultdict(list)
    for one in messages:
        topics[one.topic].append(one)
    for topic, ranges in topics.items():
        mean_bytes = sum(range_.size_bytes for range_ in ranges) / len(ranges)
        ranges.sort(key=lambda one: (one.stamp_ns, one.file, one.offset))
        for level, one in zip(_levels_of(ranges), ranges, strict=True):
            yield _Rank(mean_bytes > LARGE_MESSAGE_BYTES, level, mean_bytes, topic), one


def _levels_of(ranges: Sequence[MessageRange]) -> Iterator[int]:
    """The coarsest grid of which each is a message; those of one stamp belong together."""
    last_bins = [-1] * (_FINEST_LEVEL + 1)
    stamp_ns, level = None, 0
    for range_ in ranges:
        if range_.stamp_ns != stamp_ns:
            stamp_ns = range_.stamp_ns
            bins = [(stamp_ns << number) // NS_PER_S for number in range(_FINEST_LEVEL + 1)]
            fresh = (number for number in range(_FINEST_LEVEL) if bins[number] != last_bins[number])
            level = next(fresh, _FINEST_LEVEL)
            last_bins[level:] = bins[level:]
        yield level


MOST_HEAD_BYTES = 30


def _head(range_: ByteRange) -> bytes:
    return b"".join(map(varint, range_))


def read_head(data: bytes) -> tuple[ByteRange, int] | None:
    """The range that a head at the beginning of ``data`` tells of, and the size of that head.

    ``None`` where the head is not whole yet. Raises ``LinkError`` where it is none.
    """
    reader = Reader(data)
    try:
        range_ = ByteRange(reader.varint(), reader.varint(), reader.varint())
    except LinkError:
        if len(data) < MOST_HEAD_BYTES:
            return None
        raise
    return range_, len(data) - len(reader.rest())
