# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a relay did. Where the clock jumps back, time stands still."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable

from smarttestudo.domain.units import NS_PER_S


class Flow:
    """Messages counted on one side of a relay; the last came at ``last_ns``, ``span_ns`` after the first."""

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

    def skip(self, messages: int, size_bytes: int) -> None:
        """Count messages that came before the next one to be recorded and were not looked at."""
        if self.messages:
            self.messages += messages
            self.size_bytes += size_bytes

    @property
    def mean_hz(self) -> float | None:
        """(n − 1) / (last − first); ``None`` where that is undefined."""
        return (self.messages - 1) * NS_PER_S / self.span_ns if self.span_ns else None


class Target:
    """The target rate of a relay over time, in Hz; infinite while Full, as it is at first."""

    __slots__ = ("_ns_at", "_since_ns", "rate_hz")

    def __init__(self, now_ns: int) -> None:
        self.rate_hz = math.inf
        self._since_ns = now_ns
        self._ns_at: Counter[float] = Counter()

    def change(self, rate_hz: float, now_ns: int) -> None:
        """Aim at ``rate_hz`` from ``now_ns`` on."""
        self.account(now_ns)
        self.rate_hz = rate_hz

    def account(self, now_ns: int) -> None:
        """Count the time up to ``now_ns``."""
        self._ns_at[self.rate_hz] += max(now_ns - self._since_ns, 0)
        self._since_ns = now_ns

    def mean_hz(self, source_hz: float) -> float | None:
        """The mean over the counted time, where Full counts as ``source_hz``; ``None`` over no time."""
        return self._mean_hz(lambda rate_hz: source_hz if math.isinf(rate_hz) else rate_hz)

    def attainable_hz(self, source_hz: float) -> float | None:
        """The mean over the counted time of the lesser of target and source; ``None`` over no time."""
        return self._mean_hz(lambda rate_hz: min(rate_hz, source_hz))

    def _mean_hz(self, counts_as: Callable[[float], float]) -> float | None:
        total_ns = self._ns_at.total()
        messages = sum(counts_as(rate_hz) * passed_ns for rate_hz, passed_ns in self._ns_at.items())
        return messages / total_ns if total_ns else None


class RelayStatistics:
    """The flows into and out of one relay, how many of the latter were repeated, and the target."""

    __slots__ = ("arrived", "relayed", "repeated", "target")

    def __init__(self, now_ns: int) -> None:
        self.arrived = Flow()
        self.relayed = Flow()
        self.repeated = 0
        self.target = Target(now_ns)
