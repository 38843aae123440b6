# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a topic's messages measure."""

from __future__ import annotations

from smarttestudo.domain.intervals import Intervals
from smarttestudo.domain.units import BYTES_PER_KB, NS_PER_S


class TopicMeasure:
    """Sizes and intervals of one topic's messages, counted one by one in constant memory.

    ``is_declared`` says that the sizes are not those of the messages but what the recording declares.
    """

    __slots__ = (
        "_bytes",
        "_first_ns",
        "_intervals",
        "_last_ns",
        "is_declared",
        "largest_bytes",
        "messages",
        "type_name",
    )

    def __init__(self, type_name: str, *, is_declared: bool = False) -> None:
        self.type_name = type_name
        self.is_declared = is_declared
        self.messages = 0
        self.largest_bytes = 0
        self._bytes = 0
        self._first_ns = 0
        self._last_ns = 0
        self._intervals = Intervals()

    def record(self, stamp_ns: int, size_bytes: int) -> None:
        """Count a message."""
        self.messages += 1
        self._bytes += size_bytes
        self.largest_bytes = max(self.largest_bytes, size_bytes)
        if self.messages == 1:
            self._first_ns = stamp_ns
        self._last_ns = stamp_ns
        self._intervals.record(stamp_ns)

    @property
    def message_kb(self) -> float | None:
        """The mean size in KB; ``None`` without messages."""
        return self._bytes / self.messages / BYTES_PER_KB if self.messages else None

    @property
    def largest_kb(self) -> float:
        """The largest size in KB."""
        return self.largest_bytes / BYTES_PER_KB

    @property
    def kb(self) -> float:
        """All messages together, in KB."""
        return self._bytes / BYTES_PER_KB

    @property
    def source_hz(self) -> float | None:
        """(n − 1) / (last − first); ``None`` where that is not defined."""
        duration_ns = self._last_ns - self._first_ns
        return (self.messages - 1) * NS_PER_S / duration_ns if duration_ns > 0 else None

    @property
    def jitter_s(self) -> float | None:
        """The standard deviation of the intervals in seconds; ``None`` below two intervals."""
        return self._intervals.jitter_s
