# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Waits for messages of many sources at once, at a cost that does not depend on how many there are."""

from __future__ import annotations

import select
from typing import Protocol

MOST_AT_ONCE = 16
"""Messages that one source is served before the others have their turn."""


class Served(Protocol):
    """Source of messages to deliver; those of high ``priority`` come first."""

    priority: float

    def serve(self, most: int) -> bool:
        """Deliver up to ``most`` messages; whether there may be more."""


class RclWakeUps:
    """The event descriptors that the middleware counts up, and which sources are behind."""

    def __init__(self) -> None:
        self._poll = select.epoll()
        self._served: dict[int, Served | None] = {}
        self._behind: dict[Served, None] = {}

    def add(self, event_fd: int, served: Served | None) -> None:
        """Serve ``served`` when ``event_fd`` is counted up, or only wake where there is none."""
        self._served[event_fd] = served
        # Only the edge counts, so nobody needs to read the descriptor.
        self._poll.register(event_fd, select.EPOLLIN | select.EPOLLET)

    def remove(self, event_fd: int) -> None:
        """Wait for ``event_fd`` no longer."""
        self._poll.unregister(event_fd)
        del self._served[event_fd]

    def forget(self, served: Served) -> None:
        """Serve ``served`` no more."""
        self._behind.pop(served, None)

    def wait(self, timeout_s: float) -> None:
        """Wait until messages come, and serve them once around.

        While a topic of higher priority is behind, one of lower priority gets one message each time around:
        so it is there that queues overflow first, and nobody starves.
        """
        for event_fd, _ in self._poll.poll(0 if self._behind else timeout_s):
            if (served := self._served[event_fd]) is not None:
                self._behind[served] = None
        if not self._behind:
            return
        most, least_priority = MOST_AT_ONCE, None
        for served in sorted(self._behind, key=_priority, reverse=True):
            if least_priority is not None and served.priority < least_priority:
                most = 1
            if self._serve(served, most):
                least_priority = served.priority

    def _serve(self, served: Served, most: int) -> bool:
        # Whoever was served before it may have closed it.
        if served not in self._behind:
            return False
        is_behind = served.serve(most)
        if not is_behind:
            self._behind.pop(served, None)
        return is_behind

    def close(self) -> None:
        """Wait for nothing more."""
        self._poll.close()


def _priority(served: Served) -> float:
    return served.priority
