# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The measures of what an operator lost of a topic."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from smarttestudo.accuracy.crossings import Threshold, crossing_loss
from smarttestudo.accuracy.loss_report import (
    Age,
    CrossingLoss,
    FieldLoss,
    Frames,
    ImageLoss,
    TopicArm,
    TopicLoss,
)
from smarttestudo.accuracy.reconstruction import field_error
from smarttestudo.accuracy.samples import IMAGE_TYPES, Field, Series, TopicSamples
from smarttestudo.domain.units import NS_PER_S

_PERCENTILE = 0.95


def age_of(stamps_ns: Sequence[int], *, sent_from_ns: int, end_ns: int) -> Age | None:
    """The age between the first of ``stamps_ns``, which rise, and ``end_ns``; ``None`` without a message.

    The age is a sawtooth that falls to 0 with each message: over intervals d its mean is Σd² / 2Σd (Kaul,
    Yates and Gruteser, "Real-time status: how often should one update?", INFOCOM 2012, with messages that
    count from their reception).
    """
    received_ns = [stamp_ns for stamp_ns in stamps_ns if stamp_ns <= end_ns]
    if not received_ns:
        return None
    intervals_ns = [after - before for before, after in itertools.pairwise([*received_ns, end_ns])]
    total_ns = sum(intervals_ns)
    squares = sum(interval_ns * interval_ns for interval_ns in intervals_ns)
    return Age(
        mean_s=squares / (2 * total_ns) / NS_PER_S if total_ns else 0.0,
        p95_s=_percentile(intervals_ns, _PERCENTILE) / NS_PER_S,
        max_s=max(intervals_ns) / NS_PER_S,
        unseen_s=max(0, received_ns[0] - sent_from_ns) / NS_PER_S,
    )


def _percentile(intervals_ns: Sequence[int], share: float) -> float:
    """The age that is not exceeded for ``share`` of the time: the a with Σ min(d, a) = share · Σ d."""
    left_ns = share * sum(intervals_ns)
    below_ns = 0
    rising = sorted(intervals_ns)
    for index, interval_ns in enumerate(rising):
        teeth = len(rising) - index
        if below_ns + interval_ns * teeth >= left_ns:
            return (left_ns - below_ns) / teeth
        below_ns += interval_ns
    return float(rising[-1])


@dataclass(frozen=True, slots=True, kw_only=True)
class SharedTopic:
    """A topic as sent, as received, and at a fixed rate of ``fixed_hz``; all until ``end_ns``."""

    sent: TopicSamples
    received: TopicSamples
    fixed: TopicSamples
    fixed_hz: float
    end_ns: int

    @property
    def topic(self) -> str:
        """Its name as sent."""
        return self.sent.channel.topic

    def series(self, field: Field) -> tuple[Series, Series, Series]:
        """One field as sent, as received, and at the fixed rate."""
        return self.sent.series(field), self.received.series(field), self.fixed.series(field)


def topic_loss(shared: SharedTopic) -> TopicLoss:
    """The messages and bytes of the topic that each arm carried, and their age."""
    channel = shared.sent.channel
    return TopicLoss(
        topic=shared.topic,
        received_topic=shared.received.channel.topic,
        type_name=channel.type_name,
        sent=_arm(shared.sent, shared),
        received=_arm(shared.received, shared),
        fixed=_arm(shared.fixed, shared),
        fixed_hz=shared.fixed_hz,
    )


def field_losses(shared: SharedTopic) -> Iterator[FieldLoss]:
    """The loss of each field that ever changed, or that was asked for."""
    for field in shared.sent.fields:
        sent, received, fixed = shared.series(field)
        value_range = sent.value_range
        if value_range or field.is_asked:
            yield FieldLoss(
                topic=shared.topic,
                field=field.name,
                unit=field.unit,
                value_range=value_range,
                received=field_error(sent, received, shared.end_ns),
                fixed=field_error(sent, fixed, shared.end_ns),
                excluded_sent=sent.unknown,
                excluded_received=received.unknown,
            )


def crossing_losses(shared: SharedTopic, thresholds: Sequence[Threshold]) -> Iterator[CrossingLoss]:
    """How the thresholds that are fields of this topic were seen."""
    fields = {field.name: field for field in shared.sent.fields}
    for threshold in thresholds:
        field = fields.get(threshold.signal.property)
        if threshold.signal.topic == shared.topic and field is not None:
            yield crossing_loss(threshold, *shared.series(field), shared.end_ns)


def image_losses(shared: SharedTopic) -> Iterator[ImageLoss]:
    """The frames of the topic, if it is one of images."""
    if shared.sent.channel.type_name in IMAGE_TYPES:
        yield ImageLoss(
            topic=shared.topic,
            sent=_frames(shared.sent, shared),
            received=_frames(shared.received, shared),
            fixed=_frames(shared.fixed, shared),
        )


def _arm(arm: TopicSamples, shared: SharedTopic) -> TopicArm:
    age = age_of(arm.stamps_ns, sent_from_ns=shared.sent.stamps_ns[0], end_ns=shared.end_ns)
    return TopicArm(messages=len(arm.stamps_ns), size_bytes=arm.size_bytes, age=age)


def _frames(arm: TopicSamples, shared: SharedTopic) -> Frames:
    start_ns, end_ns = shared.sent.stamps_ns[0], shared.end_ns
    seen_ns = [start_ns, *(stamp_ns for stamp_ns in arm.stamps_ns if start_ns < stamp_ns < end_ns), end_ns]
    longest_ns = max(after - before for before, after in itertools.pairwise(seen_ns))
    return Frames(frames=len(arm.stamps_ns), longest_blind_s=longest_ns / NS_PER_S)
