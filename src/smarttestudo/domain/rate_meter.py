# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How often messages come: rates, periods and intervals of a flow."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import NamedTuple

from smarttestudo.domain.units import BYTES_PER_KB, NS_PER_S

SOURCE_INTERVALS_KEPT = 20
INTERVALS_NEEDED = 3
STALE_PERIODS = 5
STALE_AT_LEAST_NS = 2 * NS_PER_S


class SourcePeriod:
    """The mean of a source's last 20 arrival intervals."""

    __slots__ = ("_arrivals_ns",)

    def __init__(self) -> None:
        self._arrivals_ns: deque[int] = deque(maxlen=SOURCE_INTERVALS_KEPT + 1)

    def record(self, now_ns: int) -> None:
        """Count an arrival; a clock that jumped back starts the count anew."""
        arrivals_ns = self._arrivals_ns
        if arrivals_ns and now_ns < arrivals_ns[-1]:
            arrivals_ns.clear()
        arrivals_ns.append(now_ns)

    @property
    def arrivals_ns(self) -> tuple[int, ...]:
        """The arrivals that count, oldest first."""
        return tuple(self._arrivals_ns)

    @property
    def last_ns(self) -> int | None:
        """The last arrival, ``None`` before the first."""
        return self._arrivals_ns[-1] if self._arrivals_ns else None

    @property
    def mean_ns(self) -> int | None:
        """The mean interval in ns, ``None`` before the second arrival."""
        arrivals_ns = self._arrivals_ns
        intervals = len(arrivals_ns) - 1
        return (arrivals_ns[-1] - arrivals_ns[0]) // intervals if intervals > 0 else None

    @property
    def is_known(self) -> bool:
        """Whether enough intervals were seen to say when silence makes the source stale."""
        return len(self._arrivals_ns) > INTERVALS_NEEDED

    def stale_from_ns(self, *, stale_after_ns: int | None, transient_local: bool) -> int | None:
        """The first time at which the last arrival counts as stale; ``None`` while it never will.

        Stale is older than the larger of 2 s and five periods, not before three intervals were seen, nor
        ever on a transient_local topic. ``stale_after_ns`` replaces all of that.
        """
        arrivals_ns = self._arrivals_ns
        if not arrivals_ns:
            return None
        last_ns, intervals = arrivals_ns[-1], len(arrivals_ns) - 1
        if stale_after_ns is not None:
            return last_ns + stale_after_ns + 1
        if transient_local or not self.is_known:
            return None
        return last_ns + silence_limit_ns(last_ns - arrivals_ns[0], intervals) + 1


def silence_limit_ns(span_ns: int, intervals: int) -> int:
    """How long a source may be silent that had so many ``intervals`` in ``span_ns``: 2 s or five of them."""
    return max(STALE_AT_LEAST_NS, STALE_PERIODS * span_ns // intervals)


def mean_hz(messages: int, span_ns: int) -> float | None:
    """(n − 1) / (last − first) of so many messages with ``span_ns`` from the first to the last.

    ``None`` where that is undefined.
    """
    return (messages - 1) * NS_PER_S / span_ns if span_ns > 0 else None


@dataclass(slots=True, eq=False)
class Flow:
    """Messages counted one by one; the last arrived at ``last_ns``, ``span_ns`` after the first.

    Where the clock jumps back, time stands still.
    """

    messages: int = 0
    size_bytes: int = 0
    span_ns: int = 0
    last_ns: int = 0

    def record(self, now_ns: int, size_bytes: int) -> None:
        if self.messages and now_ns > self.last_ns:
            self.span_ns += now_ns - self.last_ns
        self.last_ns = now_ns
        self.messages += 1
        self.size_bytes += size_bytes

    def leave_out(self, ahead_ns: int, now_ns: int) -> None:
        """The clock jumped ahead by so much, to ``now_ns`` or just before; messages may have come since."""
        if self.last_ns <= now_ns - ahead_ns:
            self.last_ns += ahead_ns
        else:
            self.span_ns = max(self.span_ns - ahead_ns, 0)

    def skip(self, messages: int, size_bytes: int) -> None:
        """Count messages that arrived before the next one to be recorded and were not seen."""
        if self.messages:
            self.messages += messages
            self.size_bytes += size_bytes

    @property
    def mean_hz(self) -> float | None:
        """(n − 1) / (last − first); ``None`` where that is undefined."""
        return mean_hz(self.messages, self.span_ns)


WINDOW_NS = 10 * NS_PER_S
INTERVALS_KEPT = 2


class _Reading(NamedTuple):
    """Counts of a flow at ``now_ns``; ``position_ns`` is where its last message lies in time."""

    now_ns: int
    messages: int
    position_ns: int
    size_bytes: int


@dataclass(slots=True, eq=False)
class RateWindow:
    """Message counts, read about a second apart, over ten seconds; longer where messages are rarer.

    Only reading them costs time, messages do not. The rate is exact: from the last message before the window
    to the last one in it, between which ``intervals`` lie, and ``span_ns`` of time.
    """

    span_ns: int = 0
    intervals: int = 0
    _readings: deque[_Reading] = field(default_factory=deque)
    _messages: int = 0

    def restart(self) -> None:
        """Forget what was: the next message begins a window."""
        self._readings.clear()
        self.span_ns = self.intervals = 0

    def begun_anew(self) -> RateWindow:
        """A window of the same flow that begins with its next message."""
        return RateWindow(_messages=self._messages)

    def measure(self, now_ns: int, messages: int, position_ns: int, size_bytes: int = 0) -> bool:
        """Take the counts at ``now_ns``; whether they grew. Begin anew if the clock jumped back."""
        readings = self._readings
        if readings and now_ns < readings[-1].now_ns:
            self.restart()
        has_come = messages != self._messages
        if has_come:
            self._messages = messages
            readings.append(_Reading(now_ns, messages, position_ns, size_bytes))
        while (
            len(readings) > 1 and readings[1].now_ns <= now_ns - WINDOW_NS and self._has_enough_without_first
        ):
            readings.popleft()
        if readings:
            first, last = readings[0], readings[-1]
            self.span_ns = last.position_ns - first.position_ns
            self.intervals = last.messages - first.messages
        return has_come

    @property
    def rate_hz(self) -> float | None:
        """(n − 1) / (last − first); ``None`` where the window does not determine it."""
        return mean_hz(self.intervals + 1, self.span_ns)

    def kb_per_s(self, now_ns: int) -> float:
        """KB per second that arrived since the window began; 0 while it is empty."""
        if not self._readings or now_ns <= self._readings[0].now_ns:
            return 0.0
        size_bytes = self._readings[-1].size_bytes - self._readings[0].size_bytes
        return size_bytes * NS_PER_S / BYTES_PER_KB / (now_ns - self._readings[0].now_ns)

    @property
    def _has_enough_without_first(self) -> bool:
        return self._readings[-1].messages - self._readings[1].messages >= INTERVALS_KEPT


class FlowMeter:
    """Rate and bandwidth of a flow over the last ten seconds, as last measured.

    A flow is silent where a check would call its values stale (``SourcePeriod.stale_from_ns``, with the
    mean interval of the window); from then on its rate is 0.
    """

    __slots__ = ("_bandwidth", "_window", "flow", "is_silent", "kb_per_s", "rate_hz", "span_ns")

    def __init__(self, flow: Flow) -> None:
        self.flow = flow
        self.is_silent = False
        self.rate_hz: float | None = None
        self.kb_per_s = 0.0
        self.span_ns = 0
        self._window = self._bandwidth = RateWindow()

    def restart(self) -> None:
        """Measure the rate from the next message on; the bandwidth stays that of the last seconds."""
        self._window = self._window.begun_anew()

    def measure(
        self, now_ns: int, *, stale_after_ns: int | None = None, transient_local: bool = False
    ) -> None:
        flow = self.flow
        if self._bandwidth.measure(now_ns, flow.messages, flow.span_ns, flow.size_bytes):
            self.is_silent = False
        if self._window is not self._bandwidth:
            self._window.measure(now_ns, flow.messages, flow.span_ns)
        limit_ns = self._limit_ns(stale_after_ns)
        if limit_ns is not None and not transient_local and now_ns - flow.last_ns > limit_ns:
            self.is_silent = True
            self._window = self._bandwidth
            self._window.restart()
        self.rate_hz = 0.0 if self.is_silent else self._window.rate_hz
        self.kb_per_s = self._bandwidth.kb_per_s(now_ns)
        self.span_ns = self._window.span_ns

    def _limit_ns(self, stale_after_ns: int | None) -> int | None:
        """How long the flow may be silent; ``None`` if unknown."""
        if stale_after_ns is not None:
            return stale_after_ns if self.flow.messages else None
        if self.flow.messages <= INTERVALS_NEEDED or not self._window.intervals:
            return None
        return silence_limit_ns(self._window.span_ns, self._window.intervals)


@dataclass(slots=True, eq=False)
class Intervals:
    """How even a topic's messages are, counted one by one in constant memory."""

    count: int = 0
    longest_ns: int = 0
    _last_ns: int | None = None
    _mean_ns: float = 0.0
    _squares_ns2: float = 0.0

    def record(self, stamp_ns: int) -> None:
        """Take in the next message; B. P. Welford, Technometrics 1962, on corrected sums of squares."""
        if self._last_ns is not None:
            interval_ns = stamp_ns - self._last_ns
            self.count += 1
            if interval_ns > self.longest_ns:  # noqa: PLR1730 - half the time of max()
                self.longest_ns = interval_ns
            distance = interval_ns - self._mean_ns
            self._mean_ns += distance / self.count
            self._squares_ns2 += distance * (interval_ns - self._mean_ns)
        self._last_ns = stamp_ns

    def record_all(self, stamps_ns: Iterable[int]) -> None:
        """Take in several messages, at a fraction of what ``record`` costs for each."""
        last_ns, count, longest_ns = self._last_ns, self.count, self.longest_ns
        mean_ns, squares_ns2 = self._mean_ns, self._squares_ns2
        for stamp_ns in stamps_ns:
            if last_ns is not None:
                interval_ns = stamp_ns - last_ns
                count += 1
                if interval_ns > longest_ns:  # noqa: PLR1730 - half the time of max()
                    longest_ns = interval_ns
                distance = interval_ns - mean_ns
                mean_ns += distance / count
                squares_ns2 += distance * (interval_ns - mean_ns)
            last_ns = stamp_ns
        self._last_ns, self.count, self.longest_ns = last_ns, count, longest_ns
        self._mean_ns, self._squares_ns2 = mean_ns, squares_ns2

    @property
    def longest_s(self) -> float | None:
        """The longest interval in seconds; ``None`` without one."""
        return self.longest_ns / NS_PER_S if self.count else None

    @property
    def jitter_s(self) -> float | None:
        """The standard deviation of the intervals in seconds; ``None`` below two intervals."""
        return math.sqrt(self._squares_ns2 / self.count) / NS_PER_S if self.count > 1 else None
