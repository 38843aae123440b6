# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Time that passes, by a clock that may jump."""

from __future__ import annotations


class SteadyTime:
    """The clock's time, where a clock that jumps back counts as one that stood still meanwhile.

    What is remembered (arrivals, waiting requests, held messages) so keeps its age across a jump: nothing
    waits for the clock to catch up, and nothing expires early. A jump ahead is time that passed, unless it
    is left out.
    """

    __slots__ = ("_behind_ns", "now_ns")

    def __init__(self, start_ns: int) -> None:
        self.now_ns = start_ns
        self._behind_ns = 0

    def advance(self, clock_ns: int) -> int:
        """The steady time when the clock shows ``clock_ns``."""
        steady_ns = clock_ns + self._behind_ns
        if steady_ns < self.now_ns:
            self._behind_ns += self.now_ns - steady_ns
            return self.now_ns
        self.now_ns = steady_ns
        return steady_ns

    def leave_out(self, ahead_ns: int) -> None:
        """The clock jumped ahead by so much, and has not been asked since."""
        self._behind_ns -= ahead_ns

    def at(self, clock_ns: int) -> int:
        """Time that ``advance`` would return; nothing changes."""
        return max(self.now_ns, clock_ns + self._behind_ns)

    def on_clock(self, steady_ns: int) -> int:
        """Time that the clock will show at ``steady_ns``, unless it jumps again."""
        return steady_ns - self._behind_ns
