# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Streams that repeat: a timer on the grid sends the newest sample."""

from __future__ import annotations

from smarttestudo.domain.rate_meter import SourcePeriod, silence_limit_ns
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.pacing.grid import NEVER_NS, Pace
from smarttestudo.pacing.sample import Pass, Sample
from smarttestudo.pacing.stream import Stream

YOUNG_NS = 10 * NS_PER_S
"""How long a message is repeated while the period of its source is unknown."""


class RepeatStream(Stream):
    """Sends the newest sample at each due time, sent before or not, until its source is stale.

    Until three intervals give the source's period, that is ten seconds after each message; and an interval
    that was a pause does not count.

    The grid starts at the first message, which is sent at once; so is the first after the source was
    stale or Off. A wake-up that comes late sends one sample and skips the due times it missed. ``held`` is
    the newest sample while it was never sent. Full passes everything and repeats nothing.
    """

    __slots__ = ("_newest", "_period", "_stale_after_ns")

    def __init__(self, pace: Pace, now_ns: int, *, stale_after_ns: int | None) -> None:
        super().__init__(pace, now_ns)
        self._period = SourcePeriod()
        self._newest: Sample | None = None
        self._stale_after_ns = stale_after_ns

    def offer(self, sample: Sample, now_ns: int) -> bool:
        """Whether ``sample`` is sent now; if not, the next due time sends it or a newer one."""
        grid = self.grid
        missed_its_time = grid.due_ns <= now_ns and self.release_ns == NEVER_NS
        self._record(now_ns)
        if grid.pace.is_off:
            return False
        self._newest = sample
        if missed_its_time:
            grid.due_ns = now_ns
        if now_ns < grid.due_ns:
            self.hold(sample, now_ns)
            return False
        self.settle(now_ns)
        return True

    def settle(self, now_ns: int) -> None:
        """Something is sent now; the next due time is the first of the grid after it."""
        self.grid.skip_to(now_ns)
        self.held = None

    @property
    def release_ns(self) -> int:
        """The next due time at which there is something to send."""
        due_ns = self.grid.due_ns
        return due_ns if self.held is not None or self._repeats_at(due_ns) else NEVER_NS

    def release(self, now_ns: int) -> tuple[Pass, ...]:
        """Send the newest sample."""
        repeated = self.held is None
        self.settle(now_ns)
        return () if self._newest is None else (Pass(self._newest, repeated),)

    def change_pace(self, pace: Pace, now_ns: int) -> None:
        """Follow another pace from now on; Off lets go of the newest sample."""
        super().change_pace(pace, now_ns)
        if pace.is_off:
            self.held = self._newest = None

    def restart(self, now_ns: int) -> None:
        """Begin anew on a clock that jumped back: only what was never sent is still sent."""
        super().restart(now_ns)
        self._period = SourcePeriod()
        self._newest = self.held

    def is_idle(self, now_ns: int) -> bool:
        """Whether a fresh stream would do as well: nothing to send, nothing ahead."""
        return self.release_ns == NEVER_NS and super().is_idle(now_ns)

    def _repeats_at(self, due_ns: int) -> bool:
        is_silent = self._newest is None or self._period.last_ns is None
        if is_silent or self.finished or self.grid.pace.is_full:
            return False
        return due_ns < self._stale_ns

    @property
    def _stale_ns(self) -> int:
        stale_ns = self._period.stale_from_ns(stale_after_ns=self._stale_after_ns, transient_local=False)
        return (self._period.last_ns or 0) + YOUNG_NS if stale_ns is None else stale_ns

    def _record(self, now_ns: int) -> None:
        period, last_ns, mean_ns = self._period, self._period.last_ns, self._period.mean_ns
        if last_ns is not None and mean_ns is not None:
            silent_ns = now_ns - last_ns
            if silent_ns > silence_limit_ns(mean_ns, 1) and period.is_known:
                self._period = SourcePeriod()
            elif mean_ns > silence_limit_ns(max(silent_ns, 0), 1):
                self._period = SourcePeriod()
                self._period.record(last_ns)
        self._period.record(now_ns)
