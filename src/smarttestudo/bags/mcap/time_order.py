# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Messages of an MCAP file in the order of time, of which chunks may overlap."""

from __future__ import annotations

import heapq
import marshal
import math
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack
from itertools import chain, islice
from operator import itemgetter
from tempfile import TemporaryFile
from typing import BinaryIO, TypeVar

_Place = TypeVar("_Place")
FoundMessage = tuple[int, int, int, bytes]
"""Stamp in ns and channel of a message, how long its payload is, and as much of that as was asked for."""

HELD_BYTES = 1 << 28
"""What overlaps is in memory up to here; beyond, it is in a temporary file."""
_BESIDE_PAYLOAD_BYTES = 250
_MESSAGES_A_BLOCK = 1000
_BLOCK_BYTES = 1 << 18
_stamp_of = itemgetter(0)


def in_time_order(
    places: Iterable[tuple[int, _Place]],
    read: Callable[[_Place], Iterable[FoundMessage]],
    *,
    held_bytes: int = HELD_BYTES,
) -> Iterator[FoundMessage]:
    """Messages that ``read`` gives at each place, by stamp.

    Places come by the stamp of their first message, which each begins with; messages of one stamp come as
    they are read. Those of one place are in memory at once, and ``held_bytes`` of what overlaps.
    """
    with _Pending(held_bytes) as pending:
        for place, next_ns in _with_next(places):
            messages = sorted(read(place), key=_stamp_of)
            due = [message for message in messages if message[0] < next_ns]
            if pending.is_due(next_ns):
                yield from heapq.merge(pending.taken(next_ns), due, key=_stamp_of)
            else:
                yield from due
            pending.add(messages[len(due) :])


def _with_next(places: Iterable[tuple[int, _Place]]) -> Iterator[tuple[_Place, float]]:
    """Places, each with the stamp from which on the messages of the next one come."""
    remaining = iter(places)
    for _, place in islice(remaining, 1):
        here = place
        for first_ns, following in remaining:
            yield here, first_ns
            here = following
        yield here, math.inf


class _Pending:
    """Messages that come behind those of later places.

    It is a heap of them: of all those in memory, and of the first one of each sorted run in the file.
    """

    def __init__(self, held_bytes: int) -> None:
        self._held_bytes = held_bytes
        self._heap: list[tuple[int, int, FoundMessage, _Run | None]] = []
        self._held = self._count = 0
        self._opened = ExitStack()
        self._file: BinaryIO | None = None

    def __enter__(self) -> _Pending:
        return self

    def __exit__(self, *_: object) -> None:
        self._opened.close()

    def add(self, messages: Iterable[FoundMessage]) -> None:
        """Add those of a place behind all that were added."""
        for message in messages:
            self._count += 1
            self._held += len(message[3]) + _BESIDE_PAYLOAD_BYTES
            heapq.heappush(self._heap, (message[0], self._count, message, None))
        if self._held > self._held_bytes:
            self._set_aside()

    def is_due(self, before_ns: float) -> bool:
        """Whether one is before a stamp."""
        return bool(self._heap) and self._heap[0][0] < before_ns

    def taken(self, before_ns: float) -> Iterator[FoundMessage]:
        """Messages before a stamp, in their order; they are no longer pending."""
        heap = self._heap
        while heap and heap[0][0] < before_ns:
            _, _, message, run = heap[0]
            following = None if run is None else next(run, None)
            if following is not None:
                number, one = following
                heapq.heapreplace(heap, (one[0], number, one, run))
            else:
                heapq.heappop(heap)
            if run is None:
                self._held -= len(message[3]) + _BESIDE_PAYLOAD_BYTES
            yield message

    def _set_aside(self) -> None:
        """Write all that are in memory into the file as one run."""
        if self._file is None:
            self._file = self._opened.enter_context(TemporaryFile())  # noqa: SIM115  it is closed there
        held = sorted(entry for entry in self._heap if entry[3] is None)
        run = _written(self._file, ((number, message) for _, number, message, _ in held))
        number, first = next(run)
        self._heap = [entry for entry in self._heap if entry[3] is not None]
        self._heap.append((first[0], number, first, run))
        heapq.heapify(self._heap)
        self._held = 0


_Run = Iterator[tuple[int, FoundMessage]]


def _written(file: BinaryIO, entries: _Run) -> _Run:
    """Results of ``entries``, read again from the end of ``file``, where they are written now."""
    at = file.seek(0, 2)
    sizes: list[int] = []
    block: list[tuple[int, FoundMessage]] = []
    block_bytes = 0
    for entry in chain(entries, (None,)):
        if block and (entry is None or len(block) == _MESSAGES_A_BLOCK or block_bytes > _BLOCK_BYTES):
            sizes.append(file.write(marshal.dumps(block)))
            block, block_bytes = [], 0
        if entry is not None:
            block.append(entry)
            block_bytes += len(entry[1][3])
    return _read_again(file, at, sizes)


def _read_again(file: BinaryIO, at: int, sizes: Iterable[int]) -> _Run:
    for size_bytes in sizes:
        file.seek(at)
        yield from marshal.loads(file.read(size_bytes))  # noqa: S302  it was written here
        at += size_bytes
