# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the operator would lose in a trial, by the measure of ``testudo bag loss``."""

from __future__ import annotations

from array import array
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

from smarttestudo.adirf.rule_set import RuleSet
from smarttestudo.composition.recorded_samples import SampleTaker, TopicReading
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.recording import Channel, RecordingReader
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.visualizer.loss.course import Course, Stretches, age_course, error_course
from smarttestudo.visualizer.loss.crossings import thresholds_of
from smarttestudo.visualizer.loss.fields import BULK_TYPES, Field, fields_of
from smarttestudo.visualizer.loss.measure import (
    SharedTopic,
    crossing_losses,
    field_losses,
    image_losses,
    topic_loss,
)
from smarttestudo.visualizer.loss.report import CrossingLoss, FieldLoss, ImageLoss, TopicLoss
from smarttestudo.visualizer.loss.samples import TopicSamples
from smarttestudo.visualizer.loss.thinning import Thinned

MAX_SAMPLES = 5_000_000
"""Messages whose numbers are kept; what comes after them is not looked at."""

_NO_THIRD_ARM = Thinned(stamps_ns=array("q"), indices=array("q"))


@dataclass(frozen=True, slots=True, kw_only=True)
class TrialLoss:
    """What the operator would lose; the courses are the largest error and age in each stretch of time.

    ``fields`` and ``topics`` are without a third arm. ``notices`` say what was left out, a line each.
    """

    topics: tuple[tuple[TopicLoss, Course], ...]
    fields: tuple[tuple[FieldLoss, Course], ...]
    crossings: tuple[CrossingLoss, ...]
    images: tuple[ImageLoss, ...]
    notices: tuple[str, ...]


class LossWatch:
    """Keeps the numbers of the relayed topics, as sent and as received, while a recording is replayed.

    Payloads of images and point clouds are not looked at.
    """

    def __init__(self, recording: RecordingReader, rule_set: RuleSet, profile: Profile) -> None:
        self._thresholds = thresholds_of(rule_set)
        self._start_ns, self._end_ns = recording.start_ns, recording.end_ns
        self._left = MAX_SAMPLES
        readings = {topic: self._reading(topic, profile) for topic in rule_set.relayed}
        take = partial(
            SampleTaker, declared_bytes=recording.declared_bytes, start_ns=self._start_ns, end_ns=self._end_ns
        )
        self._sent = take(readings)
        for channel in recording.channels:
            self._sent.add(channel)
        self._received = take({topic: self._same(reading, topic) for topic, reading in readings.items()})

    def arrived(self, channel: Channel, stamp_ns: int, payload: bytes) -> None:
        """The robot sent a message."""
        if self._left and self._sent.take(channel, stamp_ns, payload):
            self._left -= 1
            if not self._left:
                self._end_ns = stamp_ns

    def add(self, channel: Channel) -> None:
        """Messages of ``channel`` may be relayed."""
        self._received.add(channel)

    def relayed(self, channel: Channel, stamp_ns: int, payload: bytes) -> None:
        """The operator received a message."""
        if self._left or stamp_ns <= self._end_ns:
            self._received.take(channel, stamp_ns, payload)

    def loss(self, stretches: Stretches) -> TrialLoss:
        """What was lost; the courses are over ``stretches``."""
        shared = list(self._shared())
        return TrialLoss(
            topics=tuple(
                (topic_loss(one), age_course(one.received.stamps_ns, one.end_ns, stretches)) for one in shared
            ),
            fields=tuple(
                (loss, _error_course(one, loss.field, stretches))
                for one in shared
                for loss in field_losses(one)
            ),
            crossings=tuple(loss for one in shared for loss in crossing_losses(one, self._thresholds)),
            images=tuple(loss for one in shared for loss in image_losses(one)),
            notices=tuple(self._notices()),
        )

    def _shared(self) -> Iterator[SharedTopic]:
        received = self._received.samples
        for topic, sent in sorted(self._sent.samples.items()):
            if sent.stamps_ns and topic in received:
                yield SharedTopic(
                    sent=sent,
                    received=received[topic],
                    fixed=_NO_THIRD_ARM,
                    fixed_hz=0.0,
                    end_ns=self._end_ns,
                )

    def _reading(self, topic: str, profile: Profile) -> TopicReading:
        needed = tuple(one.signal.property for one in self._thresholds if one.signal.topic == topic)
        return TopicReading(
            choose_fields=partial(_choose_fields, needed=needed),
            undecoded_types=frozenset() if needed else BULK_TYPES,
            level_unit=profile.topic(topic).level_unit,
        )

    def _same(self, reading: TopicReading, topic: str) -> TopicReading:
        """How a topic is read as received: the fields that were found in it as it was sent."""

        def choose(_type_name: str, _message: object) -> Sequence[Field]:
            samples: Mapping[str, TopicSamples] = self._sent.samples
            return samples[topic].fields

        return TopicReading(
            choose_fields=choose, undecoded_types=reading.undecoded_types, level_unit=reading.level_unit
        )

    def _notices(self) -> Iterator[str]:
        yield from self._sent.notices()
        if not self._left:
            until_s = (self._end_ns - self._start_ns) / NS_PER_S
            yield f"the loss is that of the first {until_s:,.0f} s, in which {MAX_SAMPLES:,} messages came"


def _choose_fields(type_name: str, message: object, *, needed: Sequence[str]) -> Sequence[Field]:
    return fields_of(type_name, message, needed=needed)


def _error_course(shared: SharedTopic, name: str, stretches: Stretches) -> Course:
    field = next(field for field in shared.sent.fields if field.name == name)
    sent, received, _ = shared.series(field)
    return error_course(sent, received, shared.end_ns, stretches)
