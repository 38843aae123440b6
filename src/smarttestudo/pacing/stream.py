# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Streams of one publisher: volatile, latched, repeated, or of coded video."""

from __future__ import annotations

from abc import ABC, abstractmethod

from smarttestudo.domain.rate_meter import SourcePeriod, silence_limit_ns
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.pacing.coded_video import VideoFrame, VideoGroup
from smarttestudo.pacing.grid import NEVER_NS, Grid, Pace
from smarttestudo.pacing.sample import Pass, Sample
from smarttestudo.pacing.source_gaps import BurstGaps, SourceGaps


class Stream(ABC):
    """The messages of one publisher, or those that hold one name; opened by its first message."""

    __slots__ = ("finished", "grid", "held", "held_ns", "held_number", "source")

    def __init__(self, pace: Pace, now_ns: int) -> None:
        self.grid = Grid(pace, now_ns)
        self.source = self.new_source()
        self.held: Sample | None = None
        self.held_ns = now_ns
        self.held_number = 0
        """Which of the topic's messages is held, where they name streams."""
        self.finished = False

    def offer(self, sample: Sample, now_ns: int) -> bool:
        """Whether ``sample`` passes now; if not, it may be held."""
        self.source.record(now_ns)
        if self.is_due(now_ns):
            self.settle(now_ns)
            return True
        self.hold(sample, now_ns)
        return False

    def is_due(self, now_ns: int) -> bool:
        """Whether a message that comes now passes."""
        return now_ns >= self.grid.due_ns

    @property
    @abstractmethod
    def release_ns(self) -> int:
        """When the stream relays something without a new message; or ``NEVER_NS``."""

    def hold(self, sample: Sample, now_ns: int) -> None:
        """Keep ``sample`` as the newest that did not pass."""
        self.held = sample
        self.held_ns = now_ns

    def new_source(self) -> SourceGaps:
        """The gaps of the source, of which nothing is known yet."""
        return SourceGaps()

    def charge(self, now_ns: int) -> None:
        """Something passes now that counts for this stream: advance the due time."""
        self.grid.charge(now_ns, self.slack_ns)

    def settle(self, now_ns: int) -> None:
        """Something passes now; what was held before it is no longer the newest."""
        self.charge(now_ns)
        self.held = None

    @property
    def slack_ns(self) -> int:
        """How much unused time counts as credit."""
        return self.grid.pace.slack_ns(self.source.longest_ns)

    def release(self, now_ns: int) -> tuple[Pass, ...]:
        """Relay what ``release_ns`` announced."""
        sample = self.held
        self.settle(now_ns)
        return () if sample is None else (Pass(sample),)

    def change_pace(self, pace: Pace, now_ns: int) -> None:
        self.grid.change_pace(pace, now_ns, self.slack_ns)

    def restart(self, now_ns: int) -> None:
        """Begin anew on a clock that jumped back to ``now_ns``; what is held stays held."""
        self.grid.start(now_ns)
        self.source = self.new_source()
        self.held_ns = now_ns

    def end_groups(self) -> None:  # noqa: B027 - only some streams mind
        """End the groups of messages that do not come to this stream from now on."""

    def is_idle(self, now_ns: int) -> bool:
        """Whether a fresh stream would do as well: nothing held, nothing ahead."""
        pace = self.grid.pace
        return self.held is None and (pace.is_off or self.grid.due_ns < now_ns - self.slack_ns)


QUIET_SOURCE_PERIODS = 2


class VolatileStream(Stream):
    """Passes what is due, and the newest held sample once the source is quiet.

    Quiet is the longer of one period and two source periods without a newer message; the source period of
    bursts is that from one to the next. What arrives while Off is not held.
    """

    __slots__ = ()

    def hold(self, sample: Sample, now_ns: int) -> None:
        """Keep ``sample`` as the newest that did not pass, unless Off."""
        if self.grid.due_ns < NEVER_NS:
            self.held = sample
            self.held_ns = now_ns

    @property
    def release_ns(self) -> int:
        """When the held sample is relayed as the final message."""
        if self.held is None:
            return NEVER_NS
        grid = self.grid
        return max(grid.due_ns, self.held_ns + max(self.quiet_ns, grid.pace.period_ns))

    @property
    def quiet_ns(self) -> int:
        """After how long without a message the source is quiet, at any rate."""
        return QUIET_SOURCE_PERIODS * self.source.weighted_mean_ns

    def change_pace(self, pace: Pace, now_ns: int) -> None:
        """Follow another pace from now on; Off lets go of what is held."""
        super().change_pace(pace, now_ns)
        if pace.is_off:
            self.held = None


class PublisherStream(VolatileStream):
    """All messages of one publisher, or of one name; several things may come in turn, or in bursts.

    None of those starves: the messages of a burst are due as if they arrived one mean gap apart, and the
    phase of the grid moves wherever something was held back.
    """

    __slots__ = ("_has_skipped",)

    source: BurstGaps

    def __init__(self, pace: Pace, now_ns: int) -> None:
        super().__init__(pace, now_ns)
        self._has_skipped = False

    def new_source(self) -> BurstGaps:
        """The gaps of the source, of which nothing is known yet."""
        return BurstGaps()

    def skip(self, messages: int) -> None:
        """Count messages that nobody looked at, before the next message."""
        self.source.skip(messages)
        self._has_skipped = True

    @property
    def slack_ns(self) -> int:
        """How much unused time counts as credit: more where a message counts as if it had come earlier."""
        return self.grid.pace.slack_ns(self.source.longest_ns + self.source.lag_ns)

    @property
    def quiet_ns(self) -> int:
        """After how long without a message the source is quiet: not before the next burst is late."""
        source = self.source
        if source.comes_in_bursts:
            return max(super().quiet_ns, source.longest_ns + source.step_ns)
        return super().quiet_ns

    def is_due(self, now_ns: int) -> bool:
        """Whether a message that arrived now, and was counted, passes."""
        grid = self.grid
        return now_ns - self.source.lag_ns >= grid.due_ns or grid.pace.is_full

    def charge(self, now_ns: int) -> None:
        super().charge(now_ns)
        if self.held is not None or self._has_skipped:
            self.grid.move_phase(self.source.step_ns)
            self._has_skipped = False


WHOLE_AT_FIRST_NS = 2 * NS_PER_S
WHOLE_FROM_PERIOD_NS = NS_PER_S


class LatchedStream(Stream):
    """The samples of one transient_local publisher, or of one name in them.

    All pass in its first 2 s and while its mean rate is at most 1 Hz. Above that they are
    thinned, and the newest held sample goes out as soon as it is due. Off lets nothing pass, but the
    newest sample stays held and follows when Off ends, as a late subscriber would get it.
    """

    __slots__ = ("_first_ns",)

    def __init__(self, pace: Pace, now_ns: int) -> None:
        super().__init__(pace, now_ns)
        self._first_ns = now_ns

    def is_due(self, now_ns: int) -> bool:
        """Whether a message that comes now passes."""
        grid = self.grid
        return now_ns >= grid.due_ns or (not grid.pace.is_off and self._passes_whole(now_ns))

    @property
    def release_ns(self) -> int:
        """When the held sample is due."""
        return NEVER_NS if self.held is None else self.grid.due_ns

    def restart(self, now_ns: int) -> None:
        """Begin anew on a clock that jumped back to ``now_ns``."""
        super().restart(now_ns)
        self._first_ns = now_ns

    def _passes_whole(self, now_ns: int) -> bool:
        source = self.source
        is_slow = not source.count or source.mean_ns >= WHOLE_FROM_PERIOD_NS
        return is_slow or now_ns - self._first_ns <= WHOLE_AT_FIRST_NS


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


AHEAD_AT_MOST_NS = 2 * NS_PER_S
"""A group takes what its rate gives in so long, or in as long as the groups before it lasted, at once."""
LATER_AHEAD_NS = NS_PER_S * 5 // 4
"""Later in a long group, frames pass that are due in so long: near the source's rate, only the last wait."""
FIRST_AHEAD_NS = NS_PER_S * 3 // 8
"""The same for the first group, of which nothing is known yet: its frames may come in lumps."""
_FORGOTTEN_AFTER_NS = 60 * NS_PER_S


class GroupStream(VolatileStream):
    """Passes whole beginnings of groups: a key frame, and what follows it until one is not due.

    A group has what the rate gives for as long as the groups before it lasted, however soon its frames come,
    but of one that is long not much ahead of its time.
    Parameters before a key frame count with it. Before the first key frame all passes. Of what did not pass
    only a key frame is held.
    """

    __slots__ = ("_began_ns", "_last_ns", "_lasted_ns", "group")

    def __init__(self, pace: Pace, now_ns: int) -> None:
        super().__init__(pace, now_ns)
        self.group = VideoGroup()
        self._began_ns = self._last_ns = now_ns
        self._lasted_ns = (0, 0)
        """How long the last two groups lasted."""

    def offer(self, sample: Sample, now_ns: int) -> bool:
        """Whether ``sample`` passes now; if not, it is held if it is a key frame."""
        self.source.record(now_ns)
        self._last_ns = now_ns
        group, grid, is_first = self.group, self.grid, not self.group.is_known
        begins = group.take(sample.frame)
        if begins:
            self._lasted_ns = (self._lasted_ns[1], 0 if is_first else now_ns - self._began_ns)
            self._began_ns = now_ns
        is_due = now_ns >= grid.due_ns or (sample.frame is not None and grid.due_ns < self._until_ns(now_ns))
        if not group.is_broken and (is_due or (not group.is_known and not grid.pace.is_off)):
            self._pass(now_ns)
            return True
        group.is_broken = True
        if begins and sample.frame is not VideoFrame.PARAMETERS:
            self.hold(sample, now_ns)
        else:
            # A key frame that is held is final only once nothing arrived after it for a while.
            self.held_ns = now_ns
        return False

    def change_pace(self, pace: Pace, now_ns: int) -> None:
        """Follow another pace from now on; what comes while Off is left out."""
        if pace.is_off:
            self.end_groups()
        super().change_pace(pace, now_ns)

    def end_groups(self) -> None:
        """Break the group: some of its frames do not come to this stream from now on."""
        self.group.is_broken = True

    def restart(self, now_ns: int) -> None:
        """Begin anew on a clock that jumped back to ``now_ns``."""
        super().restart(now_ns)
        self._began_ns = self._last_ns = now_ns

    def is_idle(self, now_ns: int) -> bool:
        """Whether a fresh stream would do as well, which takes any frame for one that can be decoded."""
        is_forgotten = not self.group.is_broken or now_ns - self._last_ns > _FORGOTTEN_AFTER_NS
        return is_forgotten and super().is_idle(now_ns)

    def _until_ns(self, now_ns: int) -> int:
        """Frames that are due before that pass now: what the rate gives while the group lasts.

        Where frames come in lumps, two of them may be missing in how long it is known to last.
        """
        began_ns, lasted_ns = self._began_ns, max(self._lasted_ns)
        if lasted_ns == 0:
            return now_ns + FIRST_AHEAD_NS
        at_most_ns = max(began_ns + AHEAD_AT_MOST_NS, now_ns + LATER_AHEAD_NS)
        return min(began_ns + lasted_ns + 2 * self.source.longest_ns, at_most_ns)

    def _pass(self, now_ns: int) -> None:
        if self.group.awaits_key:
            self.held = None
        elif self.grid.due_ns > now_ns and self.group.is_known:
            self.grid.due_ns += self.grid.pace.period_ns
            self.held = None
        else:
            self.settle(now_ns)
