# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Counts of a topic's messages and bytes, second by second."""

from __future__ import annotations

from array import array
from bisect import bisect_left
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from operator import lt

from smarttestudo.domain.units import NS_PER_S


@dataclass(frozen=True, slots=True, kw_only=True)
class SecondBin:
    """The messages of one topic in one second of the epoch, from ``second`` s to just below the next."""

    second: int
    messages: int
    size_bytes: int


class TraceAccumulator:
    """Counts a topic's messages into epoch-aligned 1 s bins.

    Memory grows by 24 bytes for each second that has a message, however many messages it has. Stamps may
    come in any order; in time order a message costs constant time.
    """

    __slots__ = ("_bytes", "_current", "_first_ns", "_index", "_last_ns", "_messages", "_seconds")

    def __init__(self) -> None:
        self._seconds = array("q")
        self._messages = array("q")
        self._bytes = array("q")
        self._current: int | None = None
        self._index = 0
        self._first_ns = 0
        self._last_ns = 0

    def add(self, stamp_ns: int, size_bytes: int) -> None:
        """Count one message."""
        second = stamp_ns // NS_PER_S
        if second != self._current:
            if self._current is None:
                self._first_ns = self._last_ns = stamp_ns
            self._turn_to(second)
        self._messages[self._index] += 1
        self._bytes[self._index] += size_bytes
        if stamp_ns > self._last_ns:
            self._last_ns = stamp_ns
        elif stamp_ns < self._first_ns:
            self._first_ns = stamp_ns

    def add_all(self, stamps_ns: Sequence[int], sizes_bytes: Sequence[int]) -> None:
        """Count several messages; where they are in time order, second by second."""
        if any(map(lt, stamps_ns[1:], stamps_ns)):
            for stamp_ns, size_bytes in zip(stamps_ns, sizes_bytes, strict=True):
                self.add(stamp_ns, size_bytes)
            return
        start = 0
        while start < len(stamps_ns):
            end = bisect_left(stamps_ns, (stamps_ns[start] // NS_PER_S + 1) * NS_PER_S, start)
            self.add(stamps_ns[start], sum(sizes_bytes[start:end]))
            self._messages[self._index] += end - start - 1
            self._last_ns = max(self._last_ns, stamps_ns[end - 1])
            start = end

    @property
    def first_ns(self) -> int | None:
        """The earliest stamp, ``None`` before any message."""
        return None if self._current is None else self._first_ns

    @property
    def last_ns(self) -> int | None:
        """The latest stamp, ``None`` before any message."""
        return None if self._current is None else self._last_ns

    @property
    def span_ns(self) -> int:
        """From the earliest stamp to the latest."""
        return self._last_ns - self._first_ns

    @property
    def messages(self) -> int:
        """Messages counted so far."""
        return sum(self._messages)

    @property
    def size_bytes(self) -> int:
        """Their bytes."""
        return sum(self._bytes)

    def bins(self) -> Iterator[SecondBin]:
        """The seconds that have a message, rising."""
        for second, messages, size_bytes in zip(self._seconds, self._messages, self._bytes, strict=True):
            yield SecondBin(second=second, messages=messages, size_bytes=size_bytes)

    def _turn_to(self, second: int) -> None:
        """Make ``second`` the bin that messages are counted into."""
        seconds = self._seconds
        self._index = len(seconds) if not seconds or second > seconds[-1] else bisect_left(seconds, second)
        if self._index == len(seconds) or seconds[self._index] != second:
            seconds.insert(self._index, second)
            self._messages.insert(self._index, 0)
            self._bytes.insert(self._index, 0)
        self._current = second
