# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rates, gaps and latencies of one topic of a recording."""

from __future__ import annotations

import math
from array import array
from bisect import bisect_left
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from operator import lt
from typing import Annotated

from smarttestudo.domain.rate_meter import mean_hz
from smarttestudo.domain.record import JsonEntry, derived
from smarttestudo.domain.units import BITS_PER_BYTE, BYTES_PER_KB, NS_PER_S, grouped, utc_time


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
        return sum(self._messages)

    @property
    def size_bytes(self) -> int:
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


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordingSpan:
    """From the first to the last message of a recording, over all topics; both 0 where there is none."""

    start_ns: Annotated[int, JsonEntry(is_absent=True)]
    end_ns: Annotated[int, JsonEntry(is_absent=True)]
    is_empty: Annotated[bool, JsonEntry(is_absent=True)] = False

    @property
    @derived()
    def start(self) -> str | None:
        """Date and time of the first message."""
        return None if self.is_empty else utc_time(self.start_ns)

    @property
    @derived()
    def end(self) -> str | None:
        """Date and time of the last message."""
        return None if self.is_empty else utc_time(self.end_ns)

    @property
    @derived("start_ns")
    def known_start_ns(self) -> int | None:
        """Stamp of the first message, if there is one."""
        return None if self.is_empty else self.start_ns

    @property
    @derived("end_ns")
    def known_end_ns(self) -> int | None:
        """Stamp of the last message, if there is one."""
        return None if self.is_empty else self.end_ns

    @property
    @derived()
    def duration_s(self) -> float:
        """Seconds from the first message to the last."""
        return (self.end_ns - self.start_ns) / NS_PER_S

    def shares_time(self, other: RecordingSpan) -> bool:
        """Whether both lasted at one time; nothing arrived at any time, also at that of the other."""
        if self.is_empty or other.is_empty:
            return True
        return self.start_ns <= other.end_ns and other.start_ns <= self.end_ns

    def seconds_to(self, stamp_ns: int) -> float:
        """Seconds from the recording's start to ``stamp_ns``."""
        return (stamp_ns - self.start_ns) / NS_PER_S


@dataclass(frozen=True, slots=True, kw_only=True)
class TopicStatistics:
    """Statistics of a topic in a recording.

    ``start_s`` and ``end_s`` are the topic's first and last message, in seconds since the recording's start.
    ``mean_hz`` is (n − 1) / (last − first). ``binned_hz`` is the mean count of the epoch-aligned 1 s bins
    from first to last, edges included; 0 without a message. ``kb_per_s`` counts over the recording's whole
    duration. ``declared`` says that the bytes are sizes that the recording declares, not those it holds.
    A number that the messages do not determine is ``None``.
    """

    messages: int
    size_bytes: Annotated[int, JsonEntry(name="bytes")]
    start_s: float | None
    end_s: float | None
    mean_hz: float | None
    binned_hz: float
    kb_per_s: float | None
    declared: bool = False

    def over(self, duration_s: float) -> TopicStatistics:
        """The same with ``kb_per_s`` over ``duration_s`` in place of the recording's."""
        return replace(self, kb_per_s=_kb_per_s(self.size_bytes, duration_s))

    @property
    @derived()
    def kbit_per_s(self) -> float | None:
        """``kb_per_s`` in kilobits of 1000 bits."""
        return None if self.kb_per_s is None else self.kb_per_s * BITS_PER_BYTE


def topic_statistics(
    trace: TraceAccumulator, span: RecordingSpan, *, declared: bool = False
) -> TopicStatistics:
    """The numbers of ``trace``, one topic of the recording that lasted over ``span``."""
    messages, size_bytes = trace.messages, trace.size_bytes
    first_ns, last_ns = trace.first_ns, trace.last_ns
    return TopicStatistics(
        messages=messages,
        size_bytes=size_bytes,
        start_s=None if first_ns is None else span.seconds_to(first_ns),
        end_s=None if last_ns is None else span.seconds_to(last_ns),
        mean_hz=mean_hz(messages, trace.span_ns),
        binned_hz=_binned_hz(messages, first_ns, last_ns),
        kb_per_s=_kb_per_s(size_bytes, span.duration_s),
        declared=declared,
    )


def _kb_per_s(size_bytes: int, duration_s: float) -> float | None:
    return size_bytes / BYTES_PER_KB / duration_s if duration_s > 0 else None


def _binned_hz(messages: int, first_ns: int | None, last_ns: int | None) -> float:
    if first_ns is None or last_ns is None:
        return 0.0
    return messages / (last_ns // NS_PER_S - first_ns // NS_PER_S + 1)


_P95_PERCENT = 95


@dataclass(frozen=True, slots=True, kw_only=True)
class Latency:
    """Receive time minus ``header.stamp``: its mean, the least that 95 % do not exceed, and the largest.

    ``None`` where no message has a stamp that can be of the clock of its reception.
    """

    mean_s: Annotated[float | None, JsonEntry(name="latency_mean_s")] = None
    p95_s: Annotated[float | None, JsonEntry(name="latency_p95_s")] = None
    max_s: Annotated[float | None, JsonEntry(name="latency_max_s")] = None


LONGEST_LATENCY_S = 60
_LATENCIES_NS = range(-NS_PER_S // 10, LONGEST_LATENCY_S * NS_PER_S + 1)
"""Synchronized clocks differ by less than 0.1 s, and no message of a robot that works takes a minute."""


class LatencyAccumulator:
    """Takes a topic's latencies one by one; memory grows by 8 bytes for each.

    ``unset`` counts messages without a stamp, or with one of 0, ``early`` those that arrived before their
    stamp, ``late`` those that arrived more than a minute after. None of these has a latency.
    """

    __slots__ = ("_latencies_ns", "early", "late", "unset")

    def __init__(self) -> None:
        self._latencies_ns = array("q")
        self.unset = self.early = self.late = 0

    @property
    def used(self) -> int:
        """Messages that have a latency."""
        return len(self._latencies_ns)

    def add(self, latency_ns: int | None) -> None:
        """Count one message; ``None`` for one that was not stamped."""
        if latency_ns is None:
            self.unset += 1
        elif latency_ns in _LATENCIES_NS:
            self._latencies_ns.append(latency_ns)
        elif latency_ns < _LATENCIES_NS.start:
            self.early += 1
        else:
            self.late += 1

    def notice(self) -> str | None:
        """Stamps that are not used, and why; ``None`` where all are, or where nobody stamped."""
        others = {
            "not set": self.unset,
            "after the reception": self.early,
            f"more than {LONGEST_LATENCY_S} s before it": self.late,
        }
        if not (self.used or self.early or self.late) or not any(others.values()):
            return None
        differ = "the clocks differ: " if self.early else "the clocks differ, or messages waited: "
        if not (self.early or self.late):
            differ = ""
        listed = ", ".join(f"{grouped(count)} {which}" for which, count in others.items() if count)
        stamps = f"{grouped(self.used + sum(others.values()))} stamps"
        used = (
            f"its latency is of {grouped(self.used)} of {stamps}" if self.used else f"no latency of {stamps}"
        )
        return f"{differ}{used}; {listed}"

    def latency(self) -> Latency:
        """The numbers over all messages so far."""
        if not self._latencies_ns:
            return Latency()
        rising_ns = sorted(self._latencies_ns)
        return Latency(
            mean_s=sum(rising_ns) / len(rising_ns) / NS_PER_S,
            p95_s=rising_ns[-(-_P95_PERCENT * len(rising_ns) // 100) - 1] / NS_PER_S,
            max_s=rising_ns[-1] / NS_PER_S,
        )


BINS_PER_DECADE = 20
"""Equally wide on a logarithmic axis, each 12 % longer than the last."""


@dataclass(frozen=True, slots=True, kw_only=True)
class IntervalBin:
    """``count`` intervals from ``from_s`` to just below ``to_s`` seconds."""

    from_s: float
    to_s: float
    count: int


class IntervalHistogram:
    """Counts the intervals between messages, in constant memory.

    Stamps that do not rise, as of messages recorded at one instant, are left out.
    """

    __slots__ = ("_counts", "_last_ns")

    def __init__(self) -> None:
        self._counts: Counter[int] = Counter()
        self._last_ns: int | None = None

    def record(self, stamp_ns: int) -> None:
        """Take in the next message."""
        if self._last_ns is not None and stamp_ns > self._last_ns:
            self._counts[math.floor(math.log10(stamp_ns - self._last_ns) * BINS_PER_DECADE)] += 1
        self._last_ns = stamp_ns

    def bins(self) -> tuple[IntervalBin, ...]:
        """The bins that have an interval, rising."""
        return tuple(
            IntervalBin(from_s=_edge_s(index), to_s=_edge_s(index + 1), count=count)
            for index, count in sorted(self._counts.items())
        )


def _edge_s(index: int) -> float:
    return float(10 ** (index / BINS_PER_DECADE)) / NS_PER_S
