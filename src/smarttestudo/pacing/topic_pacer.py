# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Decides which messages of one relayed topic pass."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import cast

from smarttestudo.pacing.bound import BoundRecords, BoundStreams
from smarttestudo.pacing.follower import Follower, FollowerNotifier
from smarttestudo.pacing.grid import NEVER_NS, Pace
from smarttestudo.pacing.reckoning.estimate import Estimate
from smarttestudo.pacing.sample import Pacer, Pass, Sample, StreamKind, WhenSlow
from smarttestudo.pacing.stream import GroupStream, LatchedStream, PublisherStream, RepeatStream
from smarttestudo.pacing.streams import NamedStreams, PublisherStreams, Streams

AnyStreams = (
    Streams[PublisherStream]
    | Streams[LatchedStream]
    | Streams[RepeatStream]
    | Streams[GroupStream]
    | BoundStreams
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Accuracy:
    """Accuracy of a topic's estimate: a bound for each property that ``estimate`` measures.

    ``heartbeat_hz`` passes all the same; ``records`` are written to.
    """

    estimate: Estimate
    bounds: Mapping[str, float]
    heartbeat_hz: float
    records: BoundRecords


class TopicPacer(Pacer):
    """The pacer of one topic.

    It is at Full until ``set_rate``. ``stale_after_ns`` replaces the rule that ends repeating
    (``SourcePeriod.stale_from_ns``). With an ``Accuracy`` the rate is a ceiling, and nothing is repeated.
    """

    __slots__ = (
        "_accuracy",
        "_kind",
        "_notifier",
        "_now_ns",
        "_pace",
        "_stale_after_ns",
        "_streams",
        "_when_slow",
    )

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
        self._accuracy: Accuracy | None = None
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
        """Whether messages before ``due_ns`` can be skipped, except for the final one.

        Of coded video, which frame one is must be known, unless none passes.
        """
        passes_none = self._kind is StreamKind.CODED_VIDEO and self._pace.is_off and self._accuracy is None
        return (self._is_plain or passes_none) and not self._notifier.followers

    @property
    def may_leave(self) -> bool:
        """Whether another pacer can go on with its streams."""
        return self._is_plain and not self._notifier.followers

    @property
    def comes_in_bursts(self) -> bool:
        """Whether messages come in bursts, so that which of them passes depends on those before it."""
        return any(stream.source.comes_in_bursts for stream in self._plain_streams)

    def skipped(self, messages: int) -> None:
        """Count messages that were skipped before the next message."""
        for stream in self._plain_streams:
            stream.skip(messages)

    def restart(self, now_ns: int) -> None:
        """Begin anew on a clock that jumped to ``now_ns``; what is held stays held."""
        self._streams.restart(now_ns)
        self._now_ns = now_ns

    def hand_over(self) -> dict[bytes, PublisherStream]:
        """Let another pacer go on with these streams, while messages may be skipped; none is left here."""
        streams, self._streams = self._streams, self._make_streams()
        return cast("Streams[PublisherStream]", streams).by_publisher()

    def take_back(self, streams: Mapping[bytes, PublisherStream], now_ns: int) -> Sequence[Pass]:
        """Go on with these; where pacing is of another kind by now, what they hold is offered again."""
        self._now_ns = now_ns
        if self._is_plain:
            cast("Streams[PublisherStream]", self._streams).go_on(streams, now_ns)
            return ()
        return self._offer_again(
            [stream.held for stream in streams.values() if stream.held is not None], now_ns
        )

    def offer(self, sample: Sample, now_ns: int, /) -> Sequence[Pass]:
        """Pace ``sample``, which arrived: return it if it passes now, else nothing."""
        self._see(now_ns)
        passes = self._streams.offer(sample, now_ns)
        if self._notifier.followers:
            self._notifier.on_offer(sample, passes, self._streams.holds, now_ns)
        return passes

    def wake(self, now_ns: int, /) -> Sequence[Pass]:
        """Samples to relay now without a new one: final messages, due samples, repetitions."""
        self._see(now_ns)
        passes = self._streams.wake(now_ns)
        if passes and self._notifier.followers:
            self._notifier.on_wake(passes, self._streams.holds, now_ns)
        return passes

    def wake_until(self, end_ns: int, /) -> Iterator[tuple[int, Sequence[Pass]]]:
        """Wake whenever something may pass until ``end_ns``: when, and what passes then."""
        while (wake_ns := self.wake_ns) is not None and wake_ns <= end_ns:
            yield wake_ns, self.wake(wake_ns)

    def set_rate(self, rate_hz: float, now_ns: int, /) -> None:
        """Aim at another rate from now on: infinite is Full, 0 is Off; ValueError if negative or NaN."""
        pace = Pace.at(rate_hz)
        if pace == self._pace:
            return
        self._see(now_ns)
        self._pace = pace
        self._streams.change_pace(pace, now_ns)
        self._notifier.on_pace(pace, self._streams.holds, now_ns)

    def set_accuracy(self, accuracy: Accuracy | None, now_ns: int, /) -> Sequence[Pass]:
        """Keep an estimate within bounds from now on, or none; with another estimate, begin anew.

        What is held is read and offered again; samples that come must have readings of that estimate.
        """
        before, self._accuracy = self._accuracy, accuracy
        if before is None and accuracy is None:
            return ()
        self._see(now_ns)
        streams = self._streams
        if accuracy is None or before is None or before.estimate is not accuracy.estimate:
            return self._begin_anew(now_ns)
        if isinstance(streams, BoundStreams):
            streams.change_bounds(accuracy.bounds, accuracy.heartbeat_hz, now_ns)
        return ()

    def forget_receivers(self, now_ns: int, /) -> None:
        """Serve a new receiver, which has got nothing yet."""
        if isinstance(self._streams, BoundStreams):
            self._see(now_ns)
            self._streams.forget_receivers(now_ns)

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

    def end_groups(self) -> None:
        """End the groups of messages of the source that are not received from now on."""
        self._streams.end_groups()

    def forget(self) -> None:
        """The topic has another type now: what is held is of the old one and must not go out."""
        self._streams = self._make_streams()

    def finish(self) -> None:
        """The recording ended: repeat nothing; what is held still goes out at its own time, by ``wake``."""
        self._streams.finish()

    def add_follower(self, follower: Follower) -> None:
        """Pass each decision on a stamp to ``follower``; after each call here, call its ``wake``."""
        self._notifier.add(follower, self._pace)

    def drop_follower(self, follower: Follower) -> None:
        """Pass nothing more to ``follower``."""
        self._notifier.followers.remove(follower)

    def drop_followers(self) -> None:
        self._notifier.followers.clear()

    def _begin_anew(self, now_ns: int) -> Sequence[Pass]:
        held = self._streams.held()
        self._streams = self._make_streams()
        return self._offer_again(held, now_ns)

    def _offer_again(self, held: Sequence[Sample], now_ns: int) -> Sequence[Pass]:
        if self._accuracy is not None:
            for sample in held:
                sample.readings = self._accuracy.estimate.read(sample.payload[:], None, now_ns)
        return [passed for sample in held for passed in self.offer(sample, now_ns)]

    @property
    def _plain_streams(self) -> Sequence[PublisherStream]:
        return [stream for stream in self._streams.streams() if isinstance(stream, PublisherStream)]

    @property
    def _is_plain(self) -> bool:
        is_volatile = self._kind is StreamKind.VOLATILE and self._when_slow is WhenSlow.PASS
        return is_volatile and self._accuracy is None

    def _see(self, now_ns: int) -> None:
        if now_ns < self._now_ns:
            self.restart(now_ns)
        self._now_ns = now_ns

    def _make_streams(self) -> AnyStreams:
        accuracy = self._accuracy
        if accuracy is not None:
            return BoundStreams(
                accuracy.estimate,
                accuracy.bounds,
                accuracy.records,
                ceiling=self._pace,
                heartbeat_hz=accuracy.heartbeat_hz,
            )
        if self._kind is StreamKind.NAMED:
            return NamedStreams(PublisherStream, self._pace)
        if self._kind is StreamKind.TRANSIENT_LOCAL:
            return NamedStreams(LatchedStream, self._pace)
        if self._kind is StreamKind.CODED_VIDEO:
            return PublisherStreams(GroupStream, self._pace)
        if self._when_slow is WhenSlow.REPEAT:
            return PublisherStreams(partial(RepeatStream, stale_after_ns=self._stale_after_ns), self._pace)
        return PublisherStreams(PublisherStream, self._pace)
