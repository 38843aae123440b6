# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Deadlines of one stream: a grid with capped credit."""

from __future__ import annotations

import math

from smarttestudo.domain.dataclass import dataclass
from smarttestudo.domain.units import NS_PER_S

NEVER_NS = 1 << 96
"""A time after all others, in ns; the period of Off."""

SLACK_PERIODS = 2
SLACK_AT_LEAST_NS = NS_PER_S // 4


@dataclass(frozen=True, slots=True)
class Pace:
    """A period, and the slack: how much unused time counts as credit; both in ns.

    The period is rounded down, so that a target equal to its source never falls behind it. Full has a
    period and a slack of 0: the next message is always due, and nothing is saved up.
    """

    period_ns: int
    slack_ns: int

    @staticmethod
    def at(rate_hz: float) -> Pace:
        """The pace of ``rate_hz``: infinite is Full, 0 is Off; ValueError if negative or NaN."""
        if math.isnan(rate_hz) or rate_hz < 0:
            raise ValueError(f"a rate is not negative: {rate_hz}")
        if math.isinf(rate_hz):
            return Pace(0, 0)
        if rate_hz * NEVER_NS <= NS_PER_S:
            return Pace(NEVER_NS, 0)
        period_ns = int(NS_PER_S / rate_hz)
        return Pace(period_ns, max(SLACK_PERIODS * period_ns, SLACK_AT_LEAST_NS))

    @property
    def is_full(self) -> bool:
        """Whether every message passes."""
        return self.period_ns == 0

    @property
    def is_off(self) -> bool:
        """Whether nothing passes."""
        return self.period_ns == NEVER_NS


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
        """Advance for a message that passes now, due or not: the next is due within one period."""
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
