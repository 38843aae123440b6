# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Alarms that are put off far more often than they ring."""

from __future__ import annotations

from heapq import heappop, heappush
from typing import Generic, TypeVar

Key = TypeVar("Key", str, int)


class AlarmClock(Generic[Key]):
    """One alarm for each key, its cost independent of how many there are.

    Putting an alarm off does not touch the queue: the old entry, when its time comes, moves to the new one.
    """

    __slots__ = ("_entries", "_queued_ns", "_wanted_ns", "next_ns")

    next_ns: int | None
    """A time before which no alarm rings; ``None`` when none is set. It may come early."""

    def __init__(self) -> None:
        self._entries: list[tuple[int, Key]] = []
        self._queued_ns: dict[Key, int] = {}
        self._wanted_ns: dict[Key, int] = {}
        self.next_ns = None

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
