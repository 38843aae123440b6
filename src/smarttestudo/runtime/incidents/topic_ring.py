# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The last messages of one topic."""

from __future__ import annotations

from array import array
from bisect import bisect_left
from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from itertools import islice
from typing import NamedTuple, overload

from smarttestudo.domain.incident import Missing

MESSAGE_OVERHEAD_BYTES = 400
"""About what a message takes beside its payload."""
_GIVEN_UP_BYTES = 24
_MAX_LOSSES = 1000


class SourceMessage(NamedTuple):
    """A message as it came: its place among all messages, its topic, its stamp on the clock."""

    number: int
    topic: str
    stamp_ns: int
    payload: bytes

    @property
    def held_bytes(self) -> int:
        """What it takes in memory."""
        return len(self.payload) + MESSAGE_OVERHEAD_BYTES


class GivenUp(NamedTuple):
    """What is kept of a message that was given up: when it came, by steady time and by the clock."""

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


class _GivenUpMessages:
    """The messages that a ring gave up, in their order; each takes 24 bytes."""

    def __init__(self) -> None:
        self._columns = (array("q"), array("q"), array("q"))
        self._start = 0

    @property
    def held_bytes(self) -> int:
        return len(self) * _GIVEN_UP_BYTES

    def __len__(self) -> int:
        return len(self._columns[0]) - self._start

    def add(self, at_ns: int, message: SourceMessage) -> None:
        for column, value in zip(self._columns, (at_ns, message.stamp_ns, message.number), strict=True):
            column.append(value)

    def forget_before(self, from_ns: int) -> None:
        self._start = self._index(from_ns)
        if self._start > len(self._columns[0]) // 2:
            for column in self._columns:
                del column[: self._start]
            self._start = 0

    def since(self, from_ns: int) -> GivenUpSpan:
        first = self._index(from_ns)
        return GivenUpSpan(column[first:] for column in self._columns)

    def _index(self, from_ns: int) -> int:
        return bisect_left(self._columns[0], from_ns, self._start)


class TopicRing:
    """Messages of the last ``horizon_ns``, by steady time, except for those that were given up.

    ``since`` is when the topic began to be heard: the steady time, and the clock's.
    """

    def __init__(self, horizon_ns: int) -> None:
        self.horizon_ns = horizon_ns
        self.since: tuple[int, int] | None = None
        self._message_bytes = 0
        self._messages: deque[tuple[int, SourceMessage]] = deque()
        self._given_up = _GivenUpMessages()
        self._lost: deque[tuple[int, Missing]] = deque(maxlen=_MAX_LOSSES)

    @property
    def held_bytes(self) -> int:
        """What its messages take in memory, with what is kept of those that were given up."""
        return self._message_bytes + self._given_up.held_bytes

    def __len__(self) -> int:
        return len(self._messages)

    def add(self, message: SourceMessage, now_ns: int) -> None:
        """Keep a message that came at the steady time ``now_ns``."""
        self._messages.append((now_ns, message))
        self._message_bytes += message.held_bytes

    def lose(self, lost: Missing, now_ns: int) -> None:
        """Messages were lost before they came, as was seen at the steady time ``now_ns``."""
        self._lost.append((now_ns, lost))

    def lost_since(self, from_ns: int) -> list[Missing]:
        """What was seen to be lost then."""
        return [lost for at_ns, lost in self._lost if at_ns >= from_ns]

    def forget_before(self, from_ns: int) -> None:
        """Drop what came before ``from_ns``; nobody asks for it any more."""
        while self._messages and self._messages[0][0] < from_ns:
            self._message_bytes -= self._messages.popleft()[1].held_bytes
        if self._given_up:
            self._given_up.forget_before(from_ns)

    def give_up_oldest(self) -> tuple[int, SourceMessage]:
        """Drop the oldest message, though somebody may ask for it; the steady time when it came, and it."""
        at_ns, message = self._messages.popleft()
        self._message_bytes -= message.held_bytes
        self._given_up.add(at_ns, message)
        return at_ns, message

    def since_ns(self, from_ns: int) -> Iterator[SourceMessage]:
        """The messages that came at ``from_ns`` or later."""
        return (message for at_ns, message in self._messages if at_ns >= from_ns)

    def first_number_since(self, from_ns: int) -> int | None:
        """The number of the first message that came then, whether it was given up or not."""
        numbers = [one.number for one in self.given_up_since(from_ns)[:1]]
        numbers += [message.number for message in islice(self.since_ns(from_ns), 1)]
        return min(numbers, default=None)

    def given_up_since(self, from_ns: int) -> GivenUpSpan:
        """The messages that came then and were given up."""
        return self._given_up.since(from_ns)
