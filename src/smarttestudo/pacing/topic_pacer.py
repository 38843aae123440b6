# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Decides which messages of one relayed topic pass."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial

from smarttestudo.pacing.follower import Follower, FollowerNotifier
from smarttestudo.pacing.grid import NEVER_NS, Pace
from smarttestudo.pacing.repeat import RepeatStream
from smarttestudo.pacing.sample import Pacer, Pass, Sample, StreamKind, WhenSlow
from smarttestudo.pacing.stream import LatchedStream, VolatileStream
from smarttestudo.pacing.streams import FrameStreams, PublisherStreams, Streams

AnyStreams = Streams[VolatileStream] | Streams[LatchedStream] | Streams[RepeatStream]


class TopicPacer(Pacer):
    """The pacer of one topic.

    It is at Full until ``set_rate``. ``stale_after_ns`` replaces the rule that ends repeating
    (``SourcePeriod.stale_from_ns``).
    """

    __slots__ = ("_kind", "_notifier", "_now_ns", "_pace", "_stale_after_ns", "_streams", "_when_slow")

    def __init__(
        self,
        *,
        kind: StreamKind = StreamKind.VOLATILE,
        when_slow: WhenSlow = WhenSlow.PASS,
        stale_after_ns: int | None = None,
    ) -> None:
        self._kind = kind
        self._when_slow = when_slow
        self._stale_after_ns = stale_after_ns
        self._pace = Pace.at(math.inf)
        self._notifier = FollowerNotifier()
        self._now_ns = -NEVER_NS
        self._streams = self._make_streams()

    @property
    def wake_ns(self) -> int | None:
        """When ``wake`` may have something to relay; ``None`` while nothing waits."""
        wake_ns = self._streams.wake_ns
        return wake_ns if wake_ns < NEVER_NS else None

    @property
    def due_ns(self) -> int | None:
        """When the next message may pass; ``None`` while any may."""
        return self._streams.due_ns

    @property
    def may_skip(self) -> bool:
        """Whether messages before ``due_ns`` can be skipped, except for the final one."""
        is_volatile = self._kind is StreamKind.VOLATILE and self._when_slow is WhenSlow.PASS
        return is_volatile and not self._notifier.followers

    def offer(self, sample: Sample, now_ns: int, /) -> Sequence[Pass]:
        """What to relay now that ``sample`` arrived: the sample or nothing."""
        self._see(now_ns)
        passes = self._streams.offer(sample, now_ns)
        if self._notifier.followers:
            self._notifier.offered(sample, passes, self._streams, now_ns)
        return passes

    def wake(self, now_ns: int, /) -> Sequence[Pass]:
        """What to relay now without a message: final messages, due samples, repetitions."""
        self._see(now_ns)
        passes = self._streams.wake(now_ns)
        if passes and self._notifier.followers:
            self._notifier.woken(passes, self._streams, now_ns)
        return passes

    def set_rate(self, rate_hz: float, now_ns: int, /) -> None:
        """Aim at another rate from now on: infinite is Full, 0 is Off; ValueError if negative or NaN."""
        pace = Pace.at(rate_hz)
        if pace == self._pace:
            return
        self._see(now_ns)
        self._pace = pace
        self._streams.change_pace(pace, now_ns)
        self._notifier.pace_changed(pace, self._streams, now_ns)

    def set_kind(self, kind: StreamKind, now_ns: int, /) -> Sequence[Pass]:
        """The source turned out to be of another kind: begin anew, and offer again what was held."""
        if kind is self._kind:
            return ()
        self._kind = kind
        return self._begin_anew(now_ns)

    def set_stale_after(self, stale_after_ns: int | None, now_ns: int, /) -> Sequence[Pass]:
        """Repeating ends after another time; where it is done, begin anew, and offer again what was held."""
        if stale_after_ns == self._stale_after_ns:
            return ()
        self._stale_after_ns = stale_after_ns
        return self._begin_anew(now_ns) if self._when_slow is WhenSlow.REPEAT else ()

    def forget(self) -> None:
        """The topic has another type now: what is held is of the old one and must not go out."""
        self._streams = self._make_streams()

    def finish(self) -> None:
        """The recording ended: repeat nothing; what is held still goes out at its own time, by ``wake``."""
        self._streams.finish()

    def add_follower(self, follower: Follower) -> None:
        """Pass each decision on a stamp to ``follower``; after each call here, call its ``wake``."""
        self._notifier.add(follower, self._pace)

    def drop_followers(self) -> None:
        """Remove all followers."""
        self._notifier.followers.clear()

    def _begin_anew(self, now_ns: int) -> Sequence[Pass]:
        held = self._streams.held()
        self._streams = self._make_streams()
        return [passed for sample in held for passed in self.offer(sample, now_ns)]

    def _see(self, now_ns: int) -> None:
        if now_ns < self._now_ns:
            self._streams.restart(now_ns)
        self._now_ns = now_ns

    def _make_streams(self) -> AnyStreams:
        if self._kind is StreamKind.TRANSFORMS:
            return FrameStreams(self._pace)
        if self._kind is StreamKind.TRANSIENT_LOCAL:
            return PublisherStreams(LatchedStream, self._pace)
        if self._when_slow is WhenSlow.REPEAT:
            return PublisherStreams(partial(RepeatStream, stale_after_ns=self._stale_after_ns), self._pace)
        return PublisherStreams(VolatileStream, self._pace)
