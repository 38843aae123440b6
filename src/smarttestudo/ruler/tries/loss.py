# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Loss of the operator in a try, by the measure of ``testudo bag loss``, and its headline."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Annotated

from smarttestudo.accuracy.loss_report import ErrorSize, FieldLoss, Frames, Sightings, TopicArm
from smarttestudo.accuracy.measure import (
    SharedTopic,
    crossing_losses,
    field_losses,
    image_losses,
    thresholds_of,
    topic_loss,
)
from smarttestudo.accuracy.reconstruction import BinnedSeries, TimeBins, binned_age, binned_error
from smarttestudo.accuracy.recorded_samples import SampleTaker, TopicReading
from smarttestudo.accuracy.samples import BULK_TYPES, Field, TopicSamples, fields_of
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.record import Mark
from smarttestudo.domain.recording import Channel, RecordingReader
from smarttestudo.domain.units import NS_PER_S, counted, grouped
from smarttestudo.language.rule_set import RuleSet


@dataclass(frozen=True, slots=True, kw_only=True)
class TryTopicLoss:
    """How old a topic was; the bins have the greatest age in s."""

    topic: str
    sent: TopicArm
    received: TopicArm
    age_s_bins: BinnedSeries


@dataclass(frozen=True, slots=True, kw_only=True)
class TryFieldLoss:
    """How far a field's last value received was from the robot's; the bins have the largest error.

    ``sent`` are the least and the greatest value sent, null where none was; ``range`` is what lies between
    them, of an angle that goes round that of its course; ``hold`` is null where nothing of it was received.
    """

    topic: str
    field: str
    unit: str
    sent: tuple[float, float] | None
    range: float
    hold: ErrorSize | None
    error_bins: BinnedSeries


@dataclass(frozen=True, slots=True, kw_only=True)
class TryCrossing:
    """How the operator saw a value cross the threshold of a check."""

    check: str
    crossings: int
    received: Sightings


@dataclass(frozen=True, slots=True, kw_only=True)
class TryImages:
    """A topic of images as sent and as received."""

    topic: str
    sent: Frames
    received: Frames


@dataclass(frozen=True, slots=True, kw_only=True)
class TryLoss:
    """Loss of the operator: the numbers of ``testudo bag loss``, without its third arm."""

    topics: tuple[TryTopicLoss, ...]
    fields: tuple[TryFieldLoss, ...]
    crossings: tuple[TryCrossing, ...]
    images: tuple[TryImages, ...]


class LossWatch:
    """Keeps the numbers of the relayed topics, as sent and as received, while a recording is replayed.

    They are those of the first ``max_samples`` messages. Images and point clouds are not looked into.
    """

    def __init__(
        self, recording: RecordingReader, rule_set: RuleSet, profile: Profile, *, max_samples: int
    ) -> None:
        self._thresholds = thresholds_of(rule_set)
        self._start_ns, self._end_ns = recording.start_ns, recording.end_ns
        self._max_samples = self._left = max_samples
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
        if self._left and self._sent.on_message(channel, stamp_ns, payload):
            self._left -= 1
            if not self._left:
                self._end_ns = stamp_ns

    def add(self, channel: Channel) -> None:
        """Messages of ``channel`` may be relayed."""
        self._received.add(channel)

    def relayed(self, channel: Channel, stamp_ns: int, payload: bytes) -> None:
        """The operator received a message."""
        if self._left or stamp_ns <= self._end_ns:
            self._received.on_message(channel, stamp_ns, payload)

    def loss(self, bins: TimeBins) -> TryLoss:
        """Loss so far; the courses are over ``bins``."""
        shared = list(self._shared())
        return TryLoss(
            topics=tuple(_topic_loss(one, bins) for one in shared),
            fields=tuple(_field_loss(one, loss, bins) for one in shared for loss in field_losses(one)),
            crossings=tuple(
                TryCrossing(check=loss.check, crossings=loss.crossings, received=loss.received)
                for one in shared
                for loss in crossing_losses(one, self._thresholds)
            ),
            images=tuple(
                TryImages(topic=loss.topic, sent=loss.sent, received=loss.received)
                for one in shared
                for loss in image_losses(one)
            ),
        )

    def _shared(self) -> Iterator[SharedTopic]:
        received = self._received.samples
        for topic, sent in sorted(self._sent.samples.items()):
            if sent.stamps_ns and topic in received:
                yield SharedTopic(
                    sent=sent,
                    received=received[topic],
                    fixed=TopicSamples(sent.channel),
                    fixed_hz=0.0,
                    end_ns=self._end_ns,
                )

    def _reading(self, topic: str, profile: Profile) -> TopicReading:
        needed = tuple(one.field for one in self._thresholds if one.signal.topic == topic)
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

    def notices(self) -> Iterator[str]:
        """Notices of what was left out, a line each."""
        yield from self._sent.notices()
        if not self._left:
            until_s = (self._end_ns - self._start_ns) / NS_PER_S
            came = f"{grouped(self._max_samples)} messages came"
            yield f"the loss is that of the first {grouped(until_s)} s, in which {came}"


def _choose_fields(type_name: str, message: object, *, needed: Sequence[Field]) -> Sequence[Field]:
    return fields_of(type_name, message, needed=needed)


def _topic_loss(shared: SharedTopic, bins: TimeBins) -> TryTopicLoss:
    loss = topic_loss(shared)
    ages = binned_age(shared.received.stamps_ns, shared.end_ns, bins)
    return TryTopicLoss(topic=loss.topic, sent=loss.sent, received=loss.received, age_s_bins=_short(ages))


def _field_loss(shared: SharedTopic, loss: FieldLoss, bins: TimeBins) -> TryFieldLoss:
    field = next(field for field in shared.sent.fields if field.name == loss.field)
    sent, received, _ = shared.series(field)
    known = sent.known().values
    return TryFieldLoss(
        topic=loss.topic,
        field=loss.field,
        unit=loss.unit,
        sent=(min(known), max(known)) if known else None,
        range=loss.value_range,
        hold=loss.received.hold if loss.received else None,
        error_bins=_short(binned_error(sent, received, shared.end_ns, bins)),
    )


def _short(binned: BinnedSeries) -> BinnedSeries:
    """Four digits, which is what a chart can show."""
    return tuple(None if value is None else float(f"{value:.4g}") for value in binned)


_MAX_NOTICES = 3


@dataclass(frozen=True, slots=True, kw_only=True)
class WorstTopic:
    """The topic that lost most: ``received`` of ``sent`` messages, or frames where it ``is_image``.

    ``longest_s`` is the greatest age of its newest message at the operator, or the longest time without a
    frame; ``more_s`` is how much longer that is than at the robot, null where nothing arrived.
    """

    topic: str
    sent: int
    received: int
    longest_s: float
    more_s: Annotated[float, Mark.NULL_IS_INFINITE]
    is_image: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class WorstField:
    """The property with the largest error when its last value is held: its RMSE, ``share`` of its range."""

    topic: str
    field: str
    unit: str
    rmse: float
    share: float


@dataclass(frozen=True, slots=True, kw_only=True)
class TryHeadline:
    """Headline of a try on a bag; ``percent`` is how much less of the relayed topics was sent.

    The worst are null where nothing was lost. ``missed_crossings`` of the ``crossings`` of checks' thresholds
    were not seen by the operator.
    """

    duration_s: float
    before_kb: float
    after_kb: float
    percent: float
    worst_topic: WorstTopic | None
    worst_field: WorstField | None
    crossings: int
    missed_crossings: int
    notices: tuple[str, ...]

    def headline(self) -> TryHeadline:
        """The headline alone, with the first notices."""
        left_out = len(self.notices) - _MAX_NOTICES
        more = (f"{counted(left_out, 'more notice')}",) if left_out > 0 else ()
        return TryHeadline(
            duration_s=self.duration_s,
            before_kb=self.before_kb,
            after_kb=self.after_kb,
            percent=self.percent,
            worst_topic=self.worst_topic,
            worst_field=self.worst_field,
            crossings=self.crossings,
            missed_crossings=self.missed_crossings,
            notices=(*self.notices[:_MAX_NOTICES], *more),
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class TriedRecording:
    """The headline of a try, or why the recording cannot be tried."""

    headline: TryHeadline | None
    problem: str = ""
    remedy: str = ""


def worst_topic(loss: TryLoss) -> WorstTopic | None:
    """The topic whose newest message, or picture, was old for longer than at the robot, by the most."""
    images = [_image(one) for one in loss.images]
    shown = {one.topic for one in images}
    others = (_topic(one) for one in loss.topics if one.topic not in shown)
    lost = (one for one in (*images, *others) if one.received < one.sent)
    return max(lost, key=lambda one: one.more_s, default=None)


def worst_field(loss: TryLoss) -> WorstField | None:
    """The property with the largest error as a share of its range, of those that the operator received."""
    return max(_fields(loss), key=lambda one: one.share, default=None)


def _image(loss: TryImages) -> WorstTopic:
    sent, received = loss.sent, loss.received
    return WorstTopic(
        topic=loss.topic,
        sent=sent.frames,
        received=received.frames,
        longest_s=received.longest_blind_s,
        more_s=received.longest_blind_s - sent.longest_blind_s if received.frames else math.inf,
        is_image=True,
    )


def _topic(loss: TryTopicLoss) -> WorstTopic:
    sent_s = loss.sent.age.max_s if loss.sent.age else 0.0
    received = loss.received
    return WorstTopic(
        topic=loss.topic,
        sent=loss.sent.messages,
        received=received.messages,
        longest_s=received.age.max_s if received.age else 0.0,
        more_s=received.age.max_s - sent_s if received.age else math.inf,
        is_image=False,
    )


def _fields(loss: TryLoss) -> Iterator[WorstField]:
    for one in loss.fields:
        if one.hold is not None and one.hold.relative_rmse:
            yield WorstField(
                topic=one.topic,
                field=one.field,
                unit=one.unit,
                rmse=one.hold.rmse,
                share=one.hold.relative_rmse,
            )
