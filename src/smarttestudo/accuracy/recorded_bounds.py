# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The bounds of the rules, judged on two recordings of one run."""

from __future__ import annotations

import heapq
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from smarttestudo.accuracy.bounds import BoundLoss, BoundWatch, bounds_in_force, bounds_of
from smarttestudo.bags.definitions import RosbagDecoder
from smarttestudo.bags.reader import open_recording
from smarttestudo.domain.decision import Decision
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.recording import Channel, RecordedMessage, RecordingReader
from smarttestudo.language.properties import accuracy_properties_of, gauges_for, needs_decoded
from smarttestudo.language.rule_set import RuleSet

_MESSAGES_PER_REPORT = 4096
_RECEIVED, _SENT = 0, 1


@dataclass(frozen=True, slots=True, kw_only=True)
class BoundQuestion:
    """What bounds are judged by: ``decisions`` say which of those in blocks were in force.

    ``channels`` are the topics to judge as sent, by name, ``partners`` what each is called where it was
    received. Of topics in ``predict`` the receiver shows dead reckoning.
    """

    rule_set: RuleSet
    decisions: Sequence[Decision]
    channels: Mapping[str, Channel]
    partners: Mapping[str, str]
    predict: Collection[str] = ()
    profile: Profile = field(default_factory=Profile)


def judge_bounds(
    a: Path, b: Path, question: BoundQuestion, report: Callable[[float], None]
) -> tuple[BoundLoss, ...]:
    """How each bound was kept, in one pass over both recordings at once.

    Raises ``RecordingError`` where one cannot be read.
    """
    with open_recording(a) as sent, open_recording(b) as received:
        watched = {
            topic: _Watched(channel, question, sent.start_ns) for topic, channel in question.channels.items()
        }
        by_partner = {question.partners[topic]: one for topic, one in watched.items()}
        length_ns = max(sent.end_ns - sent.start_ns, 1)
        sides = ((received, _RECEIVED, by_partner), (sent, _SENT, watched))
        for number, (stamp_ns, side, (channel, _, payload)) in enumerate(_merged(sides, sent.end_ns)):
            if number % _MESSAGES_PER_REPORT == 0:
                report(max(stamp_ns - sent.start_ns, 0) / length_ns)
            if side == _RECEIVED:
                by_partner[channel.topic].received(channel, stamp_ns, payload)
            else:
                watched[channel.topic].sent(channel, stamp_ns, payload)
        return tuple(loss for one in watched.values() for loss in one.losses(sent.end_ns))


def _merged(
    sides: Iterable[tuple[RecordingReader, int, Collection[str]]], end_ns: int
) -> Iterator[tuple[int, int, RecordedMessage]]:
    """All messages in time order until ``end_ns``; of one stamp, those of the lower side first."""
    streams = (_tagged(*side) for side in sides)
    for entry in heapq.merge(*streams, key=lambda entry: entry[:2]):
        if entry[0] > end_ns:
            return
        yield entry


def _tagged(
    recording: RecordingReader, side: int, topics: Collection[str]
) -> Iterator[tuple[int, int, RecordedMessage]]:
    for message in recording.messages(topics):
        yield message[1], side, message


class _Watched:
    """One topic with bounds, of the type that it was sent with."""

    def __init__(self, channel: Channel, question: BoundQuestion, start_ns: int) -> None:
        rule_set, topic = question.rule_set, channel.topic
        in_force = bounds_in_force(rule_set, topic, question.decisions)
        written = bounds_of(rule_set, topic)
        names = dict.fromkeys(
            [*sorted(name for name, _ in written), *(name for _, bounds in in_force for name in bounds)]
        )
        type_name = channel.type_name
        gauges = gauges_for(type_name, names, question.profile.topic(topic).level_unit)
        self._channel = channel
        self._decoder = RosbagDecoder() if needs_decoded(gauges) else None
        self._units = {name: spec.unit for name, spec in accuracy_properties_of(type_name).items()}
        self._watch = BoundWatch(
            gauges, in_force, written, reckons=topic in question.predict, start_ns=start_ns
        )

    def received(self, channel: Channel, stamp_ns: int, payload: bytes) -> None:
        if channel.type_name == self._channel.type_name:
            self._watch.received(stamp_ns, payload, self._decoded(channel, payload))

    def sent(self, channel: Channel, stamp_ns: int, payload: bytes) -> None:
        if channel.type_name == self._channel.type_name:
            self._watch.sent(stamp_ns, payload, self._decoded(channel, payload))

    def losses(self, end_ns: int) -> Iterator[BoundLoss]:
        return self._watch.losses(self._channel.topic, self._units, end_ns)

    def _decoded(self, channel: Channel, payload: bytes) -> object | None:
        if self._decoder is None:
            return None
        try:
            return self._decoder.decode(channel, payload)
        except RecordingError:
            return None
