# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Events at the operator's end that wait to be read."""

from __future__ import annotations

import threading
from collections import deque
from dataclasses import dataclass

from smarttestudo.domain.link import ReceivedMessage, StreamInfo
from smarttestudo.link.worker import AutoResetEvent

MAX_WAITING_BYTES = 64_000_000
_EVENT_BYTES = 1_000
"""The size of an event in memory beside its payload and definition, about."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotPresence:
    """A robot's end appeared, or is gone; ``boot`` tells its runs apart."""

    robot: str
    boot: str
    is_present: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class StreamSaid:
    """A robot has this stream under a number of its own; without ``info``, it has it no more."""

    robot: str
    boot: str
    number: int
    info: StreamInfo | None


LinkEvent = RobotPresence | StreamSaid | ReceivedMessage


class EventQueue:
    """Events in the order of their arrival, of at most ``most_bytes``. Any thread may ``put``.

    One may ``wait``. Where nobody reads for long, the oldest messages that are not latched give way, then the
    oldest events.
    """

    def __init__(self, most_bytes: int) -> None:
        self.dropped = 0
        """Events that gave way."""
        self._most_bytes = most_bytes
        self._bytes = 0
        self._next = 0
        self._events: dict[int, LinkEvent] = {}
        self._may_go: deque[int] = deque()
        self._lock = threading.Lock()
        self._news = AutoResetEvent()

    def put(self, event: LinkEvent) -> None:
        """Have ``event`` read. Never waits for the reader."""
        with self._lock:
            self._events[self._next] = event
            self._bytes += _size_bytes(event)
            if isinstance(event, ReceivedMessage) and not event.stream.qos.transient_local:
                self._may_go.append(self._next)
            self._next += 1
            while self._bytes > self._most_bytes and len(self._events) > 1:
                oldest = self._may_go.popleft() if self._may_go else next(iter(self._events))
                self._bytes -= _size_bytes(self._events.pop(oldest))
                self.dropped += 1
            if len(self._events) == 1:
                self._news.set()

    def wait(self, timeout_s: float) -> list[LinkEvent]:
        """All that waits, as soon as there is something; nothing after ``timeout_s``."""
        self._news.wait(timeout_s)
        with self._lock:
            # What arrived since then is read now.
            self._news.wait(0)
            events = list(self._events.values())
            self._events.clear()
            self._may_go.clear()
            self._bytes = 0
            return events


def _size_bytes(event: LinkEvent) -> int:
    if isinstance(event, ReceivedMessage):
        return _EVENT_BYTES + len(event.payload)
    if isinstance(event, StreamSaid) and event.info is not None:
        return _EVENT_BYTES + len(event.info.definition)
    return _EVENT_BYTES
