# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The least of the last values."""

from __future__ import annotations

from collections import deque

from smarttestudo.domain.units import NS_PER_S

CLOCK_WINDOW_NS = 60 * NS_PER_S
"""For how long a comparison of two clocks counts: clocks drift."""


class LeastOfWindow:
    """The least of what was added in the last ``window_ns``. Times never fall."""

    def __init__(self, window_ns: int) -> None:
        self._window_ns = window_ns
        self._least: deque[tuple[int, int]] = deque()

    def add(self, value: int, now_ns: int) -> int:
        """The least value, this one included."""
        while self._least and self._least[-1][1] >= value:
            self._least.pop()
        self._least.append((now_ns, value))
        least = self.at(now_ns)
        assert least is not None
        return least

    def at(self, now_ns: int) -> int | None:
        """The least value at ``now_ns``; ``None`` where none was added lately."""
        while self._least and self._least[0][0] < now_ns - self._window_ns:
            self._least.popleft()
        return self._least[0][1] if self._least else None
