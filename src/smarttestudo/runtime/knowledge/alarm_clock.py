# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Alarms that are put off far more often than they ring."""

from __future__ import annotations

from heapq import heappop, heappush


class AlarmClock:
    """One alarm for each topic, its cost independent of how many there are.

    Putting an alarm off does not touch the queue: the old entry, when its time comes, moves to the new one.
    """

    __slots__ = ("_entries", "_queued_ns", "_wanted_ns", "next_ns")

    next_ns: int | None
    """A time before which no alarm rings; ``None`` when none is set. It may come early."""

    def __init__(self) -> None:
        self._entries: list[tuple[int, str]] = []
        self._queued_ns: dict[str, int] = {}
        self._wanted_ns: dict[str, int] = {}
        self.next_ns = None

    def set(self, topic: str, at_ns: int | None) -> None:
        """Let the alarm of ``topic`` ring at ``at_ns`` only, or not at all."""
        if at_ns is None:
            self._wanted_ns.pop(topic, None)
            return
        self._wanted_ns[topic] = at_ns
        queued_ns = self._queued_ns.get(topic)
        if queued_ns is None or at_ns < queued_ns:
            self._queued_ns[topic] = at_ns
            heappush(self._entries, (at_ns, topic))
            self.next_ns = self._entries[0][0]

    def take_due(self, now_ns: int) -> list[str]:
        """The topics whose alarm rings by ``now_ns``, earliest queued first; their alarms are off then."""
        due = []
        while self._entries and self._entries[0][0] <= now_ns:
            at_ns, topic = heappop(self._entries)
            if self._queued_ns.get(topic) != at_ns:
                continue
            del self._queued_ns[topic]
            wanted_ns = self._wanted_ns.pop(topic, None)
            if wanted_ns is not None and wanted_ns <= now_ns:
                due.append(topic)
            else:
                self.set(topic, wanted_ns)
        self.next_ns = self._entries[0][0] if self._entries else None
        return due
