# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""One stream of messages: volatile, or latched."""

from __future__ import annotations

from abc import ABC, abstractmethod

from smarttestudo.domain.units import NS_PER_S
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
        """Follow another pace from now on."""
        self.grid.change_pace(pace, now_ns, self.slack_ns)

    def restart(self, now_ns: int) -> None:
        """Begin anew on a clock that jumped back to ``now_ns``; what is held stays held."""
        self.grid.start(now_ns)
        self.source = self.new_source()
        self.held_ns = now_ns

    def end_groups(self) -> None:  # noqa: B027 - only some streams mind
        """Some messages do not come to this stream from now on."""

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

    None of those starves: the messages of a burst are due as if they came one mean gap apart, and the phase
    of the grid moves wherever something was held back.
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
        """So many messages came that nobody looked at, before the next one."""
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
        """Whether a message that came now, and was counted, passes."""
        grid = self.grid
        return now_ns - self.source.lag_ns >= grid.due_ns or grid.pace.is_full

    def charge(self, now_ns: int) -> None:
        """Something passes now."""
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
