# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The numbers that publishers give their messages."""

from __future__ import annotations

MAX_PUBLISHERS = 256
"""Publishers that are remembered at once; beyond, all are counted anew."""


class MessageNumbers:
    """What follows from the numbers of one topic's messages: how many were sent, lost, or came twice.

    ``sent`` counts from each publisher's first message that came. What is skipped while resting is not lost.
    """

    __slots__ = ("_gap_is_wanted", "_last", "_rests", "lost", "sent")

    def __init__(self) -> None:
        self.sent = 0
        self.lost = 0
        self._last: dict[bytes, int] = {}
        self._rests = False
        self._gap_is_wanted = False

    def rest(self) -> None:
        """From now on most messages are skipped."""
        self._rests = self._gap_is_wanted = True

    def work(self) -> None:
        """From the next message on, none is skipped."""
        self._rests = False

    def is_new(self, publisher: bytes, number: int) -> bool:
        """Count message ``number`` of ``publisher``, unless it or a later one came before."""
        last = self._last.get(publisher)
        if last is None:
            if len(self._last) >= MAX_PUBLISHERS:
                self._last.clear()
            last = number - 1
        elif number <= last:
            return False
        self._last[publisher] = number
        self.sent += number - last
        if not self._gap_is_wanted:
            self.lost += number - last - 1
        self._gap_is_wanted = self._rests
        return True
