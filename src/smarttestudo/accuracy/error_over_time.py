# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The error of what an operator's end shows, over time."""

from __future__ import annotations

import math


class ErrorOverTime:
    """Adds up an error that counts until the next one: RMSE = √(Σ d·e² / Σ d).

    It is taken at each message of the source, after what passed until then. An infinite one is unknown, and
    counts in ``unknown`` alone.
    """

    __slots__ = ("_error", "_now_ns", "_squares", "_total_ns", "unknown", "worst")

    def __init__(self, now_ns: int) -> None:
        self._now_ns, self._error = now_ns, math.inf
        self._squares, self._total_ns = 0.0, 0
        self.worst, self.unknown = 0.0, 0

    @property
    def rmse(self) -> float:
        """Over the time in which the error was known; one that lasts no time is as large as it is."""
        return math.sqrt(self._squares / self._total_ns) if self._total_ns else self.worst

    def add(self, error: float, now_ns: int) -> None:
        """The error after a message of the source."""
        self.pass_time(now_ns)
        self._error = error
        if error < math.inf:
            self.worst = max(self.worst, error)
        else:
            self.unknown += 1

    def pass_time(self, now_ns: int) -> None:
        """The error was the same until now."""
        lasted_ns = max(0, now_ns - self._now_ns)
        if self._error < math.inf:
            self._squares += lasted_ns * self._error * self._error
            self._total_ns += lasted_ns
        self._now_ns = now_ns
