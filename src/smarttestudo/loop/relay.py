# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""From one source to its output topic."""

from __future__ import annotations

import math
from collections.abc import Hashable, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

from smarttestudo.domain.observation import SourceChanged
from smarttestudo.domain.profile import TopicProfile
from smarttestudo.domain.recording import Channel
from smarttestudo.domain.robot import Payload
from smarttestudo.domain.units import ns_from_s
from smarttestudo.language.properties import gauges_for, needs_decoded
from smarttestudo.loop.inputs import MessageInput
from smarttestudo.loop.statistics import RelayStatistics, VideoCounts
from smarttestudo.pacing.bound import HEARTBEAT_HZ
from smarttestudo.pacing.cdr import STAMPED_BYTES, STREAM_TYPES, StreamReader, header_stamp
from smarttestudo.pacing.coded_video import VideoReader
from smarttestudo.pacing.follower import Follower
from smarttestudo.pacing.reckoning.estimate import Estimate
from smarttestudo.pacing.sample import Pass, Sample, StreamKind, WhenSlow
from smarttestudo.pacing.topic_pacer import Accuracy, TopicPacer


class Relayed(NamedTuple):
    """A message to publish now on the output topic of ``topic``; ``repeated``: it was relayed before.

    ``payload``, ``size_bytes``, ``publisher`` and ``channel`` are those of its arrival. A tuple, because one
    is made for all that passes.
    """

    topic: str
    stamp_ns: int
    payload: Payload
    size_bytes: int
    repeated: bool
    publisher: Hashable = None
    channel: Channel | None = None


class PredictedEstimate(NamedTuple):
    """Estimate that receivers reckon of a topic, with bounds by property; infinite where there is none.

    ``number`` is another one when they have to begin anew with the next message. Where the motion comes from
    the last two messages, ``needs_every_message``.
    """

    number: int
    within: Mapping[str, float]
    heartbeat_hz: float
    needs_every_message: bool


class Relay:
    """The pacer of one topic, fed with what it must know of each message, and counts of what it lets pass.

    A relay with a ``leader`` passes the stamps that the leader passes, and so aims at the leader's rate,
    unless it is Off. Coded video has none, as its groups begin elsewhere.
    """

    __slots__ = (
        "_accuracy",
        "_estimate_number",
        "_floor_hz",
        "_is_reckoned",
        "_is_standard",
        "_level_unit",
        "_rate_hz",
        "_reader",
        "_stale_after_ns",
        "_type_name",
        "_video",
        "_when_slow",
        "followers",
        "leader",
        "needs_decoded",
        "pacer",
        "statistics",
        "topic",
    )

    needs_decoded: bool
    """Whether messages must be decoded, because the estimate has bounds on fields that are read so."""

    def __init__(
        self,
        topic: str,
        profile: TopicProfile,
        when_slow: WhenSlow,
        now_ns: int,
        *,
        is_reckoned: bool = False,
    ) -> None:
        self.topic = topic
        self.needs_decoded = False
        self._accuracy: Accuracy | None = None
        self._floor_hz = 0.0
        self._is_reckoned = is_reckoned
        self._estimate_number = 0
        self._level_unit = profile.level_unit
        self._type_name = profile.type_name or ""
        self._is_standard = True
        self._when_slow = when_slow
        self._stale_after_ns = _stale_after_ns(profile)
        self.statistics = RelayStatistics(now_ns)
        self._video = VideoReader.of(self._type_name)
        self.pacer: TopicPacer | Follower = self._own_pacer()
        self.leader: Relay | None = None
        self.followers: list[Relay] = []
        self._reader = self._stream_reader()
        self._rate_hz = math.inf

    @property
    def target_hz(self) -> float:
        """The rate that the relay aims at: infinite is Full, 0 is Off."""
        if self.leader is None or self._rate_hz == 0:
            return self._rate_hz
        return self.leader.target_hz

    def set_rate(self, rate_hz: float, now_ns: int) -> None:
        self._rate_hz = rate_hz
        self.pacer.set_rate(rate_hz, now_ns)
        for relay in (self, *self.followers):
            relay.statistics.target.change(relay.target_hz, now_ns)

    def set_floor(self, floor_hz: float, now_ns: int) -> None:
        """The topic's KeepAtLeast, the heartbeat where its estimate has bounds; 0 where there is none."""
        self._floor_hz = floor_hz
        heartbeat_hz = floor_hz or HEARTBEAT_HZ
        if self._accuracy is not None and self._accuracy.heartbeat_hz != heartbeat_hz:
            self._accuracy = replace(self._accuracy, heartbeat_hz=heartbeat_hz)
            self._apply_accuracy(now_ns)
            if self._is_reckoned:
                # The heartbeat says which stamps have jumped, so no estimate goes on from one to another.
                self.begin_estimate(now_ns)

    def set_within(self, within: Mapping[str, float], now_ns: int) -> Sequence[Relayed]:
        """Keep the receiver's estimate within these bounds, by property; what was held may pass then."""
        accuracy = self._accuracy
        known = {} if accuracy is None else dict.fromkeys(accuracy.bounds, math.inf)
        if accuracy is None and not within:
            return ()
        self._accuracy = None
        if within:
            is_same = accuracy is not None and known.keys() >= within.keys()
            estimate = (
                accuracy.estimate if accuracy is not None and is_same else self._estimate((*known, *within))
            )
            self._accuracy = Accuracy(
                estimate=estimate,
                bounds={**known, **within},
                heartbeat_hz=self._floor_hz or HEARTBEAT_HZ,
                records=self.statistics.bounds,
            )
        self.needs_decoded = self.needs_decoded and self._accuracy is not None
        return self._apply_accuracy(now_ns)

    def begin_estimate(self, now_ns: int) -> None:
        """Begin receivers' estimate anew: the newest message is due where there are bounds."""
        self._estimate_number += 1
        if isinstance(self.pacer, TopicPacer):
            self.pacer.forget_receivers(now_ns)

    def set_reckoned(self, *, is_reckoned: bool, now_ns: int) -> Sequence[Relayed]:
        """Whether receivers reckon the topic from now on; a change of that begins with a new estimate."""
        if is_reckoned == self._is_reckoned:
            return ()
        self._is_reckoned = is_reckoned
        if self._accuracy is None:
            return ()
        self._accuracy = replace(self._accuracy, estimate=self._estimate(self._accuracy.bounds))
        return self._apply_accuracy(now_ns)

    @property
    def predicted_estimate(self) -> PredictedEstimate | None:
        """Estimate that receivers reckon; ``None`` where they show the last value."""
        accuracy = self._accuracy
        if accuracy is None or not self._is_reckoned or isinstance(self.pacer, Follower):
            return None
        return PredictedEstimate(
            self._estimate_number,
            accuracy.bounds,
            accuracy.heartbeat_hz,
            accuracy.estimate.needs_every_message,
        )

    def _estimate(self, names: Iterable[str]) -> Estimate:
        gauges = gauges_for(
            self._type_name, dict.fromkeys(names), self._level_unit, is_standard=self._is_standard
        )
        self.needs_decoded = needs_decoded(gauges)
        self._estimate_number += 1
        return Estimate(gauges, reckons=self._is_reckoned)

    def _apply_accuracy(self, now_ns: int) -> Sequence[Relayed]:
        if isinstance(self.pacer, Follower):
            return ()
        return self.relayed(self.pacer.set_accuracy(self._accuracy, now_ns), now_ns)

    def detach_followers(self) -> None:
        """Have no followers; they are to call ``follow`` again."""
        self.followers = []
        if isinstance(self.pacer, TopicPacer):
            self.pacer.drop_followers()

    def follow(self, leader: Relay | None, now_ns: int) -> None:
        """Pace this topic with ``leader``, or alone if ``None``; another leader starts the pacing again."""
        if self._kind() is StreamKind.CODED_VIDEO:
            leader = None
        changed, self.leader = leader is not self.leader, leader
        if changed:
            before, self.pacer = self.pacer, Follower() if leader else self._own_pacer()
            if isinstance(before, Follower) and isinstance(self.pacer, Follower):
                self.pacer.discarded = before.discarded + before.undecided
        if leader is not None and isinstance(leader.pacer, TopicPacer) and isinstance(self.pacer, Follower):
            leader.followers.append(self)
            leader.pacer.add_follower(self.pacer)
        if changed:
            self._apply_accuracy(now_ns)
            self.set_rate(self._rate_hz, now_ns)

    def change_profile(self, profile: TopicProfile, now_ns: int) -> Sequence[Relayed]:
        """Take another profile, which says when the source is stale; held messages may pass then."""
        self._stale_after_ns = _stale_after_ns(profile)
        if isinstance(self.pacer, Follower):
            return ()
        return self.relayed(self.pacer.set_stale_after(self._stale_after_ns, now_ns), now_ns)

    def offer(self, given: MessageInput) -> Sequence[Relayed]:
        """Pace a message that arrived: return what passes now."""
        now_ns, payload, size_bytes = given.stamp_ns, given.payload, given.size_bytes
        self.statistics.arrived.record(now_ns, size_bytes)
        sample = Sample(payload, size_bytes, given.publisher, channel=given.channel)
        freed: Sequence[Relayed] = ()
        if self._video is not None:
            freed = self._read_video(self._video, sample, now_ns)
        if self._reader is not None:
            sample.frames, sample.deletion = self._reader.streams_and_deletion(payload[:])
            frames = self.statistics.frames
            frames.record(frames.arrived, sample.frames, now_ns)
        if self._accuracy is not None:
            sample.readings = self._accuracy.estimate.read(payload[:], given.message, now_ns)
            self.statistics.unreadable += not self._accuracy.estimate.says_all(sample.readings)
        if self.followers or self.leader:
            sample.stamp = header_stamp(payload[:STAMPED_BYTES])
        passes = self.pacer.offer(sample, now_ns)
        if not passes:
            return freed
        return [*freed, *self.relayed(passes, now_ns)] if freed else self.relayed(passes, now_ns)

    def wake(self, now_ns: int) -> Sequence[Relayed]:
        """Messages that pass now without a new one."""
        return self.relayed(self.pacer.wake(now_ns), now_ns)

    def change_source(self, change: SourceChanged, now_ns: int) -> Sequence[Relayed]:
        """Take a change of the source; what was held may pass then."""
        has_other_type = change.type_name not in ("", self._type_name)
        if self._type_name and has_other_type:
            self.pacer.forget()
        has_other_type = has_other_type or change.is_standard is not self._is_standard
        self._type_name, self._is_standard = change.type_name or self._type_name, change.is_standard
        if has_other_type and self._accuracy is not None:
            self._accuracy = replace(self._accuracy, estimate=self._estimate(self._accuracy.bounds))
            self._apply_accuracy(now_ns)
        if has_other_type:
            self._reader = self._stream_reader()
            self._video, self.statistics.video = VideoReader.of(self._type_name), None
        return self._set_kind(self._kind(transient_local=change.transient_local), now_ns)

    def end_groups(self) -> None:
        """Messages of the source do not come from now on."""
        if isinstance(self.pacer, TopicPacer):
            self.pacer.end_groups()

    def _read_video(self, video: VideoReader, sample: Sample, now_ns: int) -> Sequence[Relayed]:
        """Find out what ``sample`` is to a decoder; what passes because it is the first of coded video."""
        sample.frame = video.frame(sample.payload)
        if sample.frame is None and self.statistics.video is None:
            return ()
        frames = self.statistics.video
        if frames is None:
            frames = self.statistics.video = VideoCounts(now_ns)
        frames.record(sample.frame, now_ns)
        return self._set_kind(StreamKind.CODED_VIDEO, now_ns)

    def _kind(self, *, transient_local: bool = False) -> StreamKind:
        if self.statistics.video is not None:
            return StreamKind.CODED_VIDEO
        return StreamKind.of(type_name=self._type_name, transient_local=transient_local)

    def _set_kind(self, kind: StreamKind, now_ns: int) -> Sequence[Relayed]:
        leader = self.leader
        if kind is StreamKind.CODED_VIDEO and leader is not None and isinstance(self.pacer, Follower):
            leader.followers.remove(self)
            if isinstance(leader.pacer, TopicPacer):
                leader.pacer.drop_follower(self.pacer)
            self.follow(None, now_ns)
        if isinstance(self.pacer, Follower):
            return ()
        return self.relayed(self.pacer.set_kind(kind, now_ns), now_ns)

    def _stream_reader(self) -> StreamReader | None:
        is_read = self._is_standard and self._type_name in STREAM_TYPES
        return StreamReader(self._type_name) if is_read else None

    def _own_pacer(self) -> TopicPacer:
        return TopicPacer(kind=self._kind(), when_slow=self._when_slow, stale_after_ns=self._stale_after_ns)

    def relayed(self, passes: Sequence[Pass], now_ns: int) -> list[Relayed]:
        """Count what the pacer lets pass; returns it as it is to be published."""
        statistics = self.statistics
        relayed = []
        for sample, repeated in passes:
            statistics.relayed.record(now_ns, sample.size_bytes)
            statistics.repeated += repeated
            if sample.frames:
                statistics.frames.record(statistics.frames.relayed, sample.frames, now_ns)
            payload, size_bytes, publisher = sample.payload, sample.size_bytes, sample.publisher
            relayed.append(
                Relayed(self.topic, now_ns, payload, size_bytes, repeated, publisher, sample.channel)
            )
        return relayed


def _stale_after_ns(profile: TopicProfile) -> int | None:
    return None if profile.stale_after_s is None else ns_from_s(profile.stale_after_s)
