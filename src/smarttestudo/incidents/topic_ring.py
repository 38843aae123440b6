# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The last messages of one topic."""

from __future__ import annotations

import heapq
import mmap
from array import array
from bisect import bisect_left
from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import chain, islice
from operator import attrgetter
from typing import NamedTuple, Protocol, overload

from smarttestudo.domain.incident import Missing
from smarttestudo.domain.units import NS_PER_S

MESSAGE_OVERHEAD_BYTES = 400
"""About what a message takes beside its payload while it is an object of its own."""
_NUMBER_BYTES = 8
_BLOCK_OVERHEAD_BYTES = 200
_MAX_LOSSES = 1000
_LOSSES_AS_ONE_NS = NS_PER_S // 10


class IncidentMessage(Protocol):
    """A message of an incident, whose payload may be read when it is asked for."""

    @property
    def number(self) -> int:
        """Place among all messages."""

    @property
    def topic(self) -> str:
        """Topic of the message."""

    @property
    def stamp_ns(self) -> int:
        """When it arrived, on the clock."""

    @property
    def payload(self) -> bytes:
        """Bytes of the message. Raises ``OSError`` where they are on a disk that fails."""


class SourceMessage(NamedTuple):
    """An ``IncidentMessage`` as it arrived."""

    number: int
    topic: str
    stamp_ns: int
    payload: bytes

    @property
    def held_bytes(self) -> int:
        """Bytes in memory for it."""
        return len(self.payload) + MESSAGE_OVERHEAD_BYTES


class GivenUp(NamedTuple):
    """Record of a message that was given up: when it arrived, by steady time and by the clock."""

    at_ns: int
    stamp_ns: int
    number: int


class GivenUpSpan(Sequence[GivenUp]):
    """Some of the messages that a ring gave up, in their order; copying them out takes no time for each."""

    def __init__(self, columns: Iterable[array[int]]) -> None:
        self._columns = tuple(columns)

    def __len__(self) -> int:
        return len(self._columns[0])

    @overload
    def __getitem__(self, index: int) -> GivenUp: ...

    @overload
    def __getitem__(self, index: slice) -> GivenUpSpan: ...

    def __getitem__(self, index: int | slice) -> GivenUp | GivenUpSpan:
        if isinstance(index, slice):
            return GivenUpSpan(column[index] for column in self._columns)
        return GivenUp._make(column[index] for column in self._columns)

    def __iter__(self) -> Iterator[GivenUp]:
        return map(GivenUp._make, zip(*self._columns, strict=True))


class _Rows:
    """Rows of ``width`` numbers, the first of which is a steady time; added at the end, removed in front.

    Rows that were removed take memory until they are an eighth of all.
    """

    def __init__(self, width: int) -> None:
        self._columns = tuple(array("q") for _ in range(width))
        self._start = 0

    @property
    def held_bytes(self) -> int:
        return len(self._columns[0]) * len(self._columns) * _NUMBER_BYTES

    def __len__(self) -> int:
        return len(self._columns[0]) - self._start

    def add(self, row: Iterable[int]) -> None:
        for column, value in zip(self._columns, row, strict=True):
            column.append(value)

    def row(self, index: int) -> tuple[int, ...]:
        return tuple([column[self._start + index] for column in self._columns])

    def remove(self, rows: int) -> None:
        self._start += rows
        if self._start > len(self._columns[0]) // 8:
            for column in self._columns:
                del column[: self._start]
            self._start = 0

    def before(self, from_ns: int) -> int:
        """How many are from before ``from_ns``."""
        times_ns = self._columns[0]
        if self._start == len(times_ns) or times_ns[self._start] >= from_ns:
            return 0
        return bisect_left(times_ns, from_ns, self._start) - self._start

    def since(self, from_ns: int) -> tuple[array[int], ...]:
        first = self._start + self.before(from_ns)
        return tuple(column[first:] for column in self._columns)


class _Block:
    """Memory of a ``BlockPool``, to which it goes back once nobody holds it, on whatever thread that is."""

    __slots__ = ("_free", "memory")

    def __init__(self, memory: mmap.mmap, free: deque[mmap.mmap]) -> None:
        self.memory = memory
        self._free = free

    def __del__(self) -> None:
        self._free.append(self.memory)


class BlockPool:
    """Memory for payloads by blocks of ``block_bytes``, taken from the system and given back to it.

    On the heap, small objects would settle between large payloads, and what payloads leave would stay taken.
    A few blocks that are free are kept for those who ask next: new memory costs more than writing to it.
    """

    def __init__(self, block_bytes: int, most_free: int) -> None:
        self.block_bytes = block_bytes
        self._free: deque[mmap.mmap] = deque(maxlen=most_free)

    def take(self) -> _Block:
        """A block, with whatever is in it."""
        try:
            memory = self._free.pop()
        except IndexError:
            memory = mmap.mmap(-1, self.block_bytes, access=mmap.ACCESS_COPY)
        return _Block(memory, self._free)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Blocks:
    """The bytes from the position ``start`` on, which stay as they are while somebody holds this."""

    start: int
    block_bytes: int
    blocks: Sequence[_Block]

    def read(self, start: int, end: int) -> bytes:
        parts = []
        while start < end:
            index, place = divmod(start - self.start, self.block_bytes)
            part = self.blocks[index].memory[place : place + end - start]
            parts.append(part)
            start += len(part)
        return parts[0] if len(parts) == 1 else b"".join(parts)


class _Payloads:
    """Bytes at positions that rise, in blocks of ``pool``."""

    def __init__(self, pool: BlockPool) -> None:
        self._pool = pool
        self._block_bytes = pool.block_bytes
        self._blocks: deque[_Block] = deque()
        self.start = self.end = 0

    @property
    def held_bytes(self) -> int:
        return self.end - self.start + len(self._blocks) * _BLOCK_OVERHEAD_BYTES

    def add(self, payload: bytes) -> None:
        """Append a payload."""
        rest = memoryview(payload)
        while rest:
            place = self.end % self._block_bytes
            if place == 0:
                self._blocks.append(self._pool.take())
            part = rest[: self._block_bytes - place]
            self._blocks[-1].memory[place : place + len(part)] = part
            self.end += len(part)
            rest = rest[len(part) :]

    def remove_before(self, position: int) -> None:
        """Forget what lies before ``position``."""
        for _ in range(position // self._block_bytes - self.start // self._block_bytes):
            self._blocks.popleft()
        self.start = position

    def between(self, start: int, end: int) -> _Blocks:
        """Blocks that lie between ``start`` and ``end``."""
        first, last = start // self._block_bytes, -(-end // self._block_bytes)
        known = self.start // self._block_bytes
        return _Blocks(
            start=first * self._block_bytes,
            block_bytes=self._block_bytes,
            blocks=tuple(islice(self._blocks, first - known, last - known)),
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class HeldMessage:
    """An ``IncidentMessage`` whose payload is copied when it is asked for."""

    number: int
    topic: str
    stamp_ns: int
    blocks: _Blocks
    start: int
    end: int

    @property
    def payload(self) -> bytes:
        """Bytes of the message."""
        return self.blocks.read(self.start, self.end)


class HeldMessages(Iterable[HeldMessage]):
    """Some of the messages of a topic in their order, as a ring had them when it was asked.

    Any thread may go through them, however long that takes; their memory is taken until then.
    """

    def __init__(self, topic: str, rows: Sequence[array[int]], end: int, blocks: _Blocks) -> None:
        self._topic = topic
        _, self._stamps, self._numbers, self._starts = rows
        self._end = end
        self._blocks = blocks

    def holds(self, number: int) -> bool:
        """Whether the message with that number is one of them; they are the last of the topic."""
        return bool(self._numbers) and self._numbers[0] <= number

    def __iter__(self) -> Iterator[HeldMessage]:
        ends = chain(islice(self._starts, 1, None), (self._end,))
        # There is one end more than messages where there are none.
        for stamp_ns, number, start, end in zip(self._stamps, self._numbers, self._starts, ends):  # noqa: B905
            yield HeldMessage(
                number=number, topic=self._topic, stamp_ns=stamp_ns, blocks=self._blocks, start=start, end=end
            )


def together(one: Missing, other: Missing) -> Missing:
    """Two losses of a topic, both counted, as one."""
    return replace(
        one,
        messages=(one.messages or 0) + (other.messages or 0),
        from_ns=min(one.from_ns, other.from_ns),
        to_ns=max(one.to_ns, other.to_ns),
    )


class TopicRing:
    """Messages of the last ``horizon_ns``, by steady time, except for those that were given up.

    ``since`` is when the topic was subscribed to: the steady time, and the clock's. ``held_bytes`` is what
    its messages take in memory, with what is kept of those that were given up. Payloads are in blocks of
    ``pool``; what lies in the first and the last block beside the messages is not counted.
    """

    def __init__(self, topic: str, horizon_ns: int, pool: BlockPool) -> None:
        self.horizon_ns = horizon_ns
        self.since: tuple[int, int] | None = None
        self.held_bytes = 0
        self._topic = topic
        # When each arrived, by steady time and by the clock, its number, where its payload starts.
        self._messages = _Rows(4)
        self._payloads = _Payloads(pool)
        self._given_up = _Rows(3)
        self._lost_since_ns = 0
        self._lost: deque[tuple[int, Missing]] = deque()

    def __len__(self) -> int:
        return len(self._messages)

    def add(self, message: SourceMessage, now_ns: int) -> None:
        """Keep a message that arrived at the steady time ``now_ns``."""
        self._messages.add((now_ns, message.stamp_ns, message.number, self._payloads.end))
        self._payloads.add(message.payload)
        self._count()

    def lose(self, lost: Missing, now_ns: int) -> None:
        """Note messages that were lost before they arrived, as was seen at the steady time ``now_ns``."""
        if self._lost and now_ns - self._lost_since_ns < _LOSSES_AS_ONE_NS:
            self._lost[-1] = now_ns, together(self._lost[-1][1], lost)
            return
        self._lost_since_ns = now_ns
        self._lost.append((now_ns, lost))
        while len(self._lost) > _MAX_LOSSES:
            _, oldest = self._lost.popleft()
            self._lost[0] = self._lost[0][0], together(oldest, self._lost[0][1])

    def lost_since(self, from_ns: int) -> list[Missing]:
        """Losses that were seen at ``from_ns`` or later."""
        return [lost for at_ns, lost in self._lost if at_ns >= from_ns]

    def forget_before(self, from_ns: int) -> None:
        """Drop what arrived before ``from_ns``; nobody asks for it any more."""
        messages, given_up = self._messages.before(from_ns), self._given_up.before(from_ns)
        if messages or given_up:
            self._remove(messages)
            self._given_up.remove(given_up)
            self._count()

    def give_up_oldest(self) -> tuple[int, SourceMessage]:
        """Drop the oldest message, though it may be asked for; its steady time of arrival, and itself."""
        at_ns, stamp_ns, number, start = self._messages.row(0)
        end = self._start_of(1)
        payload = self._payloads.between(start, end).read(start, end)
        self._remove(1)
        self._given_up.add((at_ns, stamp_ns, number))
        self._count()
        return at_ns, SourceMessage(number, self._topic, stamp_ns, payload)

    def held_since(self, from_ns: int) -> HeldMessages:
        """The messages that arrived at ``from_ns`` or later and are there."""
        rows, end = self._messages.since(from_ns), self._payloads.end
        starts = rows[-1]
        blocks = self._payloads.between(starts[0] if starts else end, end)
        return HeldMessages(self._topic, rows, end, blocks)

    def given_up_since(self, from_ns: int) -> GivenUpSpan:
        """The messages that arrived then and were given up."""
        return GivenUpSpan(self._given_up.since(from_ns))

    def _start_of(self, index: int) -> int:
        return self._messages.row(index)[-1] if index < len(self._messages) else self._payloads.end

    def _remove(self, messages: int) -> None:
        self._payloads.remove_before(self._start_of(messages))
        self._messages.remove(messages)

    def _count(self) -> None:
        """Once for each change: all rings are asked for it at each message while memory is short."""
        self.held_bytes = self._payloads.held_bytes + self._messages.held_bytes + self._given_up.held_bytes


@dataclass(frozen=True, slots=True)
class InOrder(Iterable[IncidentMessage]):
    """The messages of several topics in the order of their numbers."""

    topics: Sequence[Iterable[IncidentMessage]]

    def __iter__(self) -> Iterator[IncidentMessage]:
        return heapq.merge(*self.topics, key=attrgetter("number"))
