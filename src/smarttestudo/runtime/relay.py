# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""From one source to its output topic."""

from __future__ import annotations

import math
from collections.abc import Hashable, Sequence
from typing import NamedTuple

from smarttestudo.cdr import STAMPED_BYTES, FrameReader, header_stamp
from smarttestudo.domain.observation import SourceChanged
from smarttestudo.domain.payload import Payload
from smarttestudo.domain.profile import TopicProfile
from smarttestudo.domain.units import ns_from_s
from smarttestudo.pacing.follower import Follower
from smarttestudo.pacing.sample import Pass, Sample, StreamKind, WhenSlow
from smarttestudo.pacing.topic_pacer import TopicPacer
from smarttestudo.runtime.inputs import MessageInput
from smarttestudo.runtime.statistics import RelayStatistics


class Relayed(NamedTuple):
    """A message to publish now on the output topic of ``topic``; ``repeated``: it was relayed before.

    ``payload``, ``size_bytes`` and ``publisher`` are those of its arrival. A tuple, because one is made for
    all that passes.
    """

    topic: str
    stamp_ns: int
    payload: Payload
    size_bytes: int
    repeated: bool
    publisher: Hashable = None


class Relay:
    """The pacer of one topic, fed with what it must know of each message, and counts of what it lets pass.

    A relay with a ``leader`` passes the stamps that the leader passes, and so aims at the leader's rate,
    unless it is Off.
    """

    __slots__ = (
        "_frames",
        "_has_frames",
        "_rate_hz",
        "_stale_after_ns",
        "_type_name",
        "_when_slow",
        "followers",
        "leader",
        "pacer",
        "statistics",
        "topic",
    )

    def __init__(self, topic: str, profile: TopicProfile, when_slow: WhenSlow, now_ns: int) -> None:
        self.topic = topic
        self._type_name = profile.type_name or ""
        self._when_slow = when_slow
        self._stale_after_ns = _stale_after_ns(profile)
        self.pacer: TopicPacer | Follower = self._own_pacer()
        self.leader: Relay | None = None
        self.followers: list[Relay] = []
        self.statistics = RelayStatistics(now_ns)
        self._frames = FrameReader()
        self._rate_hz = math.inf
        kind = StreamKind.of(type_name=self._type_name, transient_local=False)
        self._has_frames = kind is StreamKind.TRANSFORMS

    @property
    def target_hz(self) -> float:
        """The rate that the relay aims at: infinite is Full, 0 is Off."""
        if self.leader is None or self._rate_hz == 0:
            return self._rate_hz
        return self.leader.target_hz

    def set_rate(self, rate_hz: float, now_ns: int) -> None:
        """Take the plan's rate."""
        self._rate_hz = rate_hz
        self.pacer.set_rate(rate_hz, now_ns)
        for relay in (self, *self.followers):
            relay.statistics.target.change(relay.target_hz, now_ns)

    def let_go(self) -> None:
        """Have no followers; they are to call ``follow`` again."""
        self.followers = []
        if isinstance(self.pacer, TopicPacer):
            self.pacer.drop_followers()

    def follow(self, leader: Relay | None, now_ns: int) -> None:
        """Be paced with ``leader``, or alone if ``None``; a change of that starts the pacing again."""
        changed, self.leader = leader is not self.leader, leader
        if changed:
            before, self.pacer = self.pacer, Follower() if leader else self._own_pacer()
            if isinstance(before, Follower) and isinstance(self.pacer, Follower):
                self.pacer.discarded = before.discarded + before.undecided
        if leader is not None and isinstance(leader.pacer, TopicPacer) and isinstance(self.pacer, Follower):
            leader.followers.append(self)
            leader.pacer.add_follower(self.pacer)
        if changed:
            self.set_rate(self._rate_hz, now_ns)

    def change_profile(self, profile: TopicProfile, now_ns: int) -> Sequence[Relayed]:
        """Another profile says when the source is stale; what was held may pass then."""
        self._stale_after_ns = _stale_after_ns(profile)
        if isinstance(self.pacer, Follower):
            return ()
        return self._relayed(self.pacer.set_stale_after(self._stale_after_ns, now_ns), now_ns)

    def offer(self, given: MessageInput) -> Sequence[Relayed]:
        """What passes now that a message arrived."""
        now_ns, payload, size_bytes = given.stamp_ns, given.payload, given.size_bytes
        self.statistics.arrived.record(now_ns, size_bytes)
        sample = Sample(payload, size_bytes, given.publisher)
        if self._has_frames:
            sample.frames = self._frames.child_frames(payload[:])
            frames = self.statistics.frames
            frames.record(frames.arrived, sample.frames, now_ns)
        if self.followers or self.leader:
            sample.stamp = header_stamp(payload[:STAMPED_BYTES])
        passes = self.pacer.offer(sample, now_ns)
        return self._relayed(passes, now_ns) if passes else ()

    def wake(self, now_ns: int) -> Sequence[Relayed]:
        """What passes now without a message."""
        return self._relayed(self.pacer.wake(now_ns), now_ns)

    def change_source(self, change: SourceChanged, now_ns: int) -> Sequence[Relayed]:
        """Take a change of the source; what was held may pass then."""
        if self._type_name and change.type_name not in ("", self._type_name):
            self.pacer.forget()
        self._type_name = change.type_name or self._type_name
        kind = StreamKind.of(type_name=self._type_name, transient_local=change.transient_local)
        self._has_frames = kind is StreamKind.TRANSFORMS
        if isinstance(self.pacer, Follower):
            return ()
        return self._relayed(self.pacer.set_kind(kind, now_ns), now_ns)

    def _own_pacer(self) -> TopicPacer:
        kind = StreamKind.of(type_name=self._type_name, transient_local=False)
        return TopicPacer(kind=kind, when_slow=self._when_slow, stale_after_ns=self._stale_after_ns)

    def _relayed(self, passes: Sequence[Pass], now_ns: int) -> list[Relayed]:
        statistics = self.statistics
        relayed = []
        for sample, repeated in passes:
            statistics.relayed.record(now_ns, sample.size_bytes)
            statistics.repeated += repeated
            if sample.frames:
                statistics.frames.record(statistics.frames.relayed, sample.frames, now_ns)
            relayed.append(
                Relayed(self.topic, now_ns, sample.payload, sample.size_bytes, repeated, sample.publisher)
            )
        return relayed


def _stale_after_ns(profile: TopicProfile) -> int | None:
    return None if profile.stale_after_s is None else ns_from_s(profile.stale_after_s)
