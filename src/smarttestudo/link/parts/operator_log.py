# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Lines of the robot's log on operators that come and go."""

from __future__ import annotations

from collections.abc import Callable, Collection

from smarttestudo.domain.units import NS_PER_S, counted

MOST_LINES = 6
"""So many are said at once; then one for each ``REFILL_NS``, with all that happened meanwhile."""
REFILL_NS = 30 * NS_PER_S
_DIGITS = 4


class OperatorLog:
    """Says by ``say`` which operator's ends came or left; ``now_ns`` is of a clock that never jumps."""

    def __init__(self, say: Callable[[str], None]) -> None:
        self._say = say
        self._there: frozenset[int] = frozenset()
        self._said: frozenset[int] = frozenset()
        self._moves = 0
        self._lines = float(MOST_LINES)
        self._looked_ns = 0
        self._left_ns: int | None = None
        """When the last one left."""
        self._absent_s = 0.0
        """For how long there was none, until one came again of which nothing was said yet."""

    def look(self, there: frozenset[int], now_ns: int) -> None:
        """These are there now."""
        self._lines = min(self._lines + (now_ns - self._looked_ns) / REFILL_NS, MOST_LINES)
        self._looked_ns = now_ns
        if there != self._there:
            self._moves += len(there ^ self._there)
            if not there:
                self._left_ns = now_ns
            elif not self._there and self._left_ns is not None:
                self._absent_s = (now_ns - self._left_ns) / NS_PER_S
            self._there = there
        if self._moves and self._lines >= 1:
            self._lines -= 1
            self._say(self._sentence())
            self._said, self._moves, self._absent_s = there, 0, 0.0

    def _sentence(self) -> str:
        came, left = self._there - self._said, self._said - self._there
        parts = [f"{_names(left)} left the link"] if left else []
        if came:
            absent = f", after {self._absent_s:.0f} s without any" if self._absent_s >= 1 else ""
            parts.append(f"{_names(came)} came over the link{absent}")
        if others := self._moves - len(came) - len(left):
            parts.append(f"operators came or left {counted(others, 'more time')} meanwhile")
        if not self._there:
            parts.append("none is there now")
        return "; ".join(parts)


def _names(numbers: Collection[int]) -> str:
    names = ", ".join(sorted(f"{number:016x}"[:_DIGITS] for number in numbers))
    return f"operator {names}" if len(numbers) == 1 else f"operators {names}"
