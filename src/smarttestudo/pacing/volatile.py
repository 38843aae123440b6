# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Streams of volatile topics: thinned, with the last word."""

from __future__ import annotations

from smarttestudo.pacing.pace import NEVER_NS, Pace
from smarttestudo.pacing.sample import Sample
from smarttestudo.pacing.stream import Stream

QUIET_SOURCE_PERIODS = 2


class VolatileStream(Stream):
    """Passes what is due, and the newest held sample once the source fell quiet.

    Quiet is the longer of one period and two source periods without a newer message. What arrives
    while Off is not held.
    """

    __slots__ = ()

    def offer(self, sample: Sample, now_ns: int) -> bool:
        """Whether ``sample`` passes now; if not, it is held."""
        self.source.record(now_ns)
        if now_ns >= self.grid.due_ns:
            self.settle(now_ns)
            return True
        self.hold(sample, now_ns)
        return False

    def hold(self, sample: Sample, now_ns: int) -> None:
        """Keep ``sample`` as the newest that did not pass, unless Off."""
        if self.grid.due_ns < NEVER_NS:
            self.held = sample
            self.held_ns = now_ns

    @property
    def release_ns(self) -> int:
        """When the held sample becomes the last word."""
        if self.held is None:
            return NEVER_NS
        grid = self.grid
        quiet_ns = max(grid.pace.period_ns, QUIET_SOURCE_PERIODS * (self.source.mean_ns or 0))
        return max(self.held_ns + quiet_ns, grid.due_ns)

    def change_pace(self, pace: Pace, now_ns: int) -> None:
        """Follow another pace from now on; Off lets go of what is held."""
        super().change_pace(pace, now_ns)
        if pace.is_off:
            self.held = None
