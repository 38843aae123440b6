# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The deadline grid with capped credit."""

from __future__ import annotations

from smarttestudo.pacing.pace import NEVER_NS, Pace


class Grid:
    """The due times of one stream.

    A message passes when it is due, and the due time moves on by one period. A due time in the past is
    credit, at most the pace's slack of it, so the mean rate is exact to one message while no gap between
    messages exceeds the slack, and at most ``T·f + slack·f + 2`` messages pass in any window of length T.
    """

    __slots__ = ("due_ns", "pace")

    due_ns: int
    """When the next message may pass; at Full, when the last one did."""

    def __init__(self, pace: Pace, now_ns: int) -> None:
        self.pace = pace
        self.start(now_ns)

    def start(self, now_ns: int) -> None:
        """Begin anew, half a period before ``now_ns``.

        So the next message passes, the error of the mean is centred, and a jittering source at the target
        or below it keeps every message.
        """
        pace = self.pace
        self.due_ns = NEVER_NS if pace.is_off else now_ns - pace.period_ns // 2

    def charge(self, now_ns: int) -> None:
        """Pay for a message that passes now, due or not: afterwards, the next is due within one period."""
        pace = self.pace
        due_ns = self.due_ns
        if due_ns > now_ns:
            due_ns = now_ns
        elif due_ns < now_ns - pace.slack_ns:
            due_ns = now_ns - pace.slack_ns
        self.due_ns = due_ns + pace.period_ns

    def skip_to(self, now_ns: int) -> None:
        """A message passes now: move on to the first due time after it, without leaving the grid."""
        period_ns = self.pace.period_ns
        if not period_ns:
            self.due_ns = now_ns
        elif self.due_ns <= now_ns:
            self.due_ns += ((now_ns - self.due_ns) // period_ns + 1) * period_ns

    def change_pace(self, pace: Pace, now_ns: int) -> None:
        """Follow another pace from now on; what is owed or ahead, counted in messages, stays the same.

        Counted in time, each change to a faster pace would owe the messages of a whole slow period at
        once, and a rule that flickers between two rates would relay up to half more than they ask for.
        From Off the grid starts anew, from Full as if it had started at the last message.
        """
        old, self.pace = self.pace, pace
        if pace.is_full:
            self.due_ns = -NEVER_NS
        elif old.is_off or pace.is_off:
            self.start(now_ns)
        elif old.is_full:
            after_last_ns = self.due_ns + pace.period_ns - pace.period_ns // 2
            self.start(now_ns)
            self.due_ns = max(self.due_ns, after_last_ns)
        else:
            ahead_ns = max(self.due_ns - now_ns, -old.slack_ns)
            self.due_ns = now_ns + ahead_ns * pace.period_ns // old.period_ns
