# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How many messages come, how often, and how much they carry: counted, and measured over the last seconds."""

from __future__ import annotations

from collections import deque
from typing import NamedTuple

from smarttestudo.domain.source_period import INTERVALS_NEEDED, silence_limit_ns
from smarttestudo.domain.units import BYTES_PER_KB, NS_PER_S


def mean_hz(messages: int, span_ns: int) -> float | None:
    """(n − 1) / (last − first) of so many messages with ``span_ns`` from the first to the last.

    ``None`` where that is undefined.
    """
    return (messages - 1) * NS_PER_S / span_ns if span_ns > 0 else None


class Flow:
    """Messages counted one by one; the last came at ``last_ns``, ``span_ns`` after the first.

    Where the clock jumps back, time stands still.
    """

    __slots__ = ("last_ns", "messages", "size_bytes", "span_ns")

    def __init__(self) -> None:
        self.messages = 0
        self.size_bytes = 0
        self.span_ns = 0
        self.last_ns = 0

    def record(self, now_ns: int, size_bytes: int) -> None:
        """Count a message."""
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
        """Count messages that came before the next one to be recorded and were not seen."""
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


class RateWindow:
    """Message counts, read about a second apart, over ten seconds; longer where messages are rarer.

    Only reading them costs time, messages do not. The rate is exact: from the last message before the window
    to the last one in it, between which ``intervals`` lie, and ``span_ns`` of time.
    """

    __slots__ = ("_messages", "_readings", "intervals", "span_ns")

    def __init__(self) -> None:
        self.span_ns = 0
        self.intervals = 0
        self._readings: deque[_Reading] = deque()
        self._messages = 0

    def restart(self) -> None:
        """Forget what was: the next message begins a window."""
        self._readings.clear()
        self.span_ns = self.intervals = 0

    def begun_anew(self) -> RateWindow:
        """Another window of the same flow, which its next message begins."""
        window = RateWindow()
        window._messages = self._messages
        return window

    def measure(self, now_ns: int, messages: int, position_ns: int, size_bytes: int = 0) -> bool:
        """Take the counts at ``now_ns``; whether messages came. On a clock that jumped back, begin anew."""
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
        """KB per second that came since the window began; 0 while it is empty."""
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
        """Measure anew."""
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
