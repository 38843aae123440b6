# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Time of a clock that may jump, alarms, and turns that long work yields."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from heapq import heappop, heappush
from typing import Generic, TypeVar


@dataclass(slots=True, eq=False)
class SteadyTime:
    """The clock's time, where a clock that jumps back counts as one that stood still meanwhile.

    What is remembered (arrivals, waiting requests, held messages) so keeps its age across a jump: nothing
    waits for the clock to catch up, and nothing expires early. A jump ahead is time that passed, unless it
    is left out.
    """

    now_ns: int
    _behind_ns: int = 0

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


Key = TypeVar("Key", str, int)


@dataclass(slots=True, eq=False)
class AlarmClock(Generic[Key]):
    """One alarm for each key, its cost independent of how many there are.

    Putting an alarm off does not touch the queue: the old entry, when its time comes, moves to the new one.
    """

    next_ns: int | None = None
    """A time before which no alarm rings; ``None`` when none is set. It may come early."""
    _entries: list[tuple[int, Key]] = field(default_factory=list)
    _queued_ns: dict[Key, int] = field(default_factory=dict)
    _wanted_ns: dict[Key, int] = field(default_factory=dict)

    def set(self, key: Key, at_ns: int | None) -> None:
        """Let the alarm of ``key`` ring at ``at_ns`` only, or not at all."""
        if at_ns is None:
            self._wanted_ns.pop(key, None)
            return
        self._wanted_ns[key] = at_ns
        queued_ns = self._queued_ns.get(key)
        if queued_ns is None or at_ns < queued_ns:
            self._queued_ns[key] = at_ns
            heappush(self._entries, (at_ns, key))
            self.next_ns = self._entries[0][0]

    def take_due(self, now_ns: int) -> list[Key]:
        """The keys whose alarm rings by ``now_ns``, earliest queued first; their alarms are off then."""
        due: list[Key] = []
        while self._entries and self._entries[0][0] <= now_ns:
            at_ns, key = heappop(self._entries)
            if self._queued_ns.get(key) != at_ns:
                continue
            del self._queued_ns[key]
            wanted_ns = self._wanted_ns.pop(key, None)
            if wanted_ns is not None and wanted_ns <= now_ns:
                due.append(key)
            else:
                self.set(key, wanted_ns)
        self.next_ns = self._entries[0][0] if self._entries else None
        return due


_Item = TypeVar("_Item")

Yield = Callable[[], None]
"""Called between two small pieces of work, so that other threads have their turn."""


def never_yield() -> None:
    """Go on at once, for work that others wait for."""


def yielding(items: Iterable[_Item], yield_turn: Yield) -> Iterator[_Item]:
    """``items``, each after a turn of others."""
    for item in items:
        yield_turn()
        yield item
