# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a topic's source sent in the last ten seconds."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

from smarttestudo.domain.units import BYTES_PER_KB, NS_PER_S

WINDOW_S = 10
WINDOW_NS = WINDOW_S * NS_PER_S


@dataclass(slots=True)
class _Second:
    """The messages of one second: when the first came, how many, how many bytes."""

    first_ns: int
    messages: int = 0
    size_bytes: int = 0


class SourceLoad:
    """Mean message size and rate of a source over ten seconds, in steps of a second.

    Memory and time do not depend on how many messages there are.
    """

    __slots__ = ("_last_ns", "_seconds")

    def __init__(self) -> None:
        self._seconds: deque[_Second] = deque()
        self._last_ns = 0

    def record(self, now_ns: int, size_bytes: int) -> None:
        """Count a message; times never fall."""
        if not self._seconds or now_ns - self._seconds[-1].first_ns >= NS_PER_S:
            self._seconds.append(_Second(now_ns))
            self.forget(now_ns)
        second = self._seconds[-1]
        second.messages += 1
        second.size_bytes += size_bytes
        self._last_ns = now_ns

    def forget(self, now_ns: int) -> None:
        """Drop the seconds that began before the window."""
        while self._seconds and self._seconds[0].first_ns <= now_ns - WINDOW_NS:
            self._seconds.popleft()

    @property
    def is_empty(self) -> bool:
        """Whether nothing came in the window."""
        return not self._seconds

    @property
    def message_kb(self) -> float:
        """The mean size in KB; there must be a message."""
        size_bytes = sum(second.size_bytes for second in self._seconds)
        return size_bytes / BYTES_PER_KB / self._messages

    @property
    def source_hz(self) -> float:
        """(n - 1) / (last - first) in the window; one message counts as one in ten seconds."""
        duration_ns = self._last_ns - self._seconds[0].first_ns
        return (self._messages - 1) * NS_PER_S / duration_ns if duration_ns else self._messages / WINDOW_S

    @property
    def _messages(self) -> int:
        return sum(second.messages for second in self._seconds)
