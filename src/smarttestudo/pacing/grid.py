# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Deadlines of one stream: a grid with capped credit."""

from __future__ import annotations

import math
from dataclasses import dataclass

from smarttestudo.domain.units import NS_PER_S

NEVER_NS = 1 << 96
"""A time after all others, in ns; the period of Off."""

SLACK_PERIODS = 2
SLACK_AT_LEAST_NS = NS_PER_S // 4
SLACK_AT_MOST_NS = 2 * NS_PER_S

STEP_OF_PERIOD = 10
STEP_PERMILLE = 693
"""In a period the phase moves by ln 2 of a tenth of the period, at most of the source's mean gap.

That share is near no simple fraction, so that of any number of turns, at any rate, each comes to pass; of
such shares, it is the one with which the last waits least. A tenth, so that what passes is evenly spaced.
"""


@dataclass(frozen=True, slots=True)
class Pace:
    """A period in ns, rounded down, so that a target equal to its source never falls behind it.

    Full has a period of 0: the next message is always due.
    """

    period_ns: int

    @staticmethod
    def at(rate_hz: float) -> Pace:
        """The pace of ``rate_hz``: infinite is Full, 0 is Off; ValueError if negative or NaN."""
        if math.isnan(rate_hz) or rate_hz < 0:
            raise ValueError(f"a rate is not negative: {rate_hz}")
        if math.isinf(rate_hz):
            return Pace(0)
        return Pace(NEVER_NS if rate_hz * NEVER_NS <= NS_PER_S else int(NS_PER_S / rate_hz))

    def slack_ns(self, longest_gap_ns: int) -> int:
        """How much unused time counts as credit, where a source has gaps so long; at Full and Off none."""
        if self.is_full or self.is_off:
            return 0
        gap_ns = min(max(longest_gap_ns, SLACK_AT_LEAST_NS), SLACK_AT_MOST_NS)
        return max(SLACK_PERIODS * self.period_ns, gap_ns)

    @property
    def is_full(self) -> bool:
        return self.period_ns == 0

    @property
    def is_off(self) -> bool:
        return self.period_ns == NEVER_NS


class Grid:
    """The due times of one stream.

    A message passes when it is due, and the due time moves on by one period. A due time in the past is
    credit, at most the slack of it, so the mean rate is exact to one message while no gap between
    messages exceeds the slack, and at most ``T·f + slack·f + 2`` messages pass in any window of length T.

    Where the source sends more than passes, the phase can move as well: each period is a share of the
    source's gap longer, until the phase is half a period late, and then shorter until it is half a period
    early. So it is not always the same one of several messages in turn that passes, and the mean stays.
    """

    __slots__ = ("due_ns", "is_phase_falling", "pace", "phase_ns")

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
        self.phase_ns, self.is_phase_falling = 0, False

    def charge(self, now_ns: int, slack_ns: int) -> None:
        """Advance for a message that passes now, due or not: the next is due within one period."""
        due_ns = self.due_ns
        if due_ns > now_ns:
            due_ns = now_ns
        elif due_ns < now_ns - slack_ns:
            due_ns = now_ns - slack_ns
        self.due_ns = due_ns + self.pace.period_ns

    def move_phase(self, gap_ns: int) -> None:
        """Move the phase on for a source whose mean gap is ``gap_ns``, if that is less than the period."""
        period_ns = self.pace.period_ns
        if not 0 < gap_ns < period_ns:
            return
        # Nearly the whole period; the closer the target to its source, the less.
        left_ns = gap_ns * gap_ns // period_ns
        range_ns = period_ns - left_ns
        step_ns = min(period_ns // STEP_OF_PERIOD, gap_ns)
        step_ns = (step_ns - left_ns * step_ns // period_ns) * STEP_PERMILLE // 1000
        before_ns = -self.phase_ns if self.is_phase_falling else self.phase_ns
        after_ns = before_ns + step_ns
        turns = after_ns > range_ns // 2
        if turns:
            after_ns = max(range_ns - after_ns, -(range_ns // 2))
        moved_ns = before_ns - after_ns if self.is_phase_falling else after_ns - before_ns
        self.phase_ns += moved_ns
        self.due_ns += moved_ns
        self.is_phase_falling ^= turns

    def skip_to(self, now_ns: int) -> None:
        """A message passes now: move on to the first due time after it, without leaving the grid."""
        period_ns = self.pace.period_ns
        if not period_ns:
            self.due_ns = now_ns
        elif self.due_ns <= now_ns:
            self.due_ns += ((now_ns - self.due_ns) // period_ns + 1) * period_ns

    def change_pace(self, pace: Pace, now_ns: int, slack_ns: int) -> None:
        """Follow another pace from now on; what is owed or ahead, counted in messages, stays the same.

        Counted in time, each change to a faster pace would owe the messages of a whole slow period at
        once, and a rule that flickers between two rates would relay up to half more than they ask for.
        From Off the grid starts anew, from Full as if it had started at the last message. ``slack_ns`` is
        that of the pace until now.
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
            ahead_ns = max(self.due_ns - now_ns, -slack_ns)
            self.due_ns = now_ns + ahead_ns * pace.period_ns // old.period_ns
            self.phase_ns = self.phase_ns * pace.period_ns // old.period_ns
