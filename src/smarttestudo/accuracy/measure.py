# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The loss of an operator in a topic whose values count by their fields: errors, ages and thresholds."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import zip_longest

from smarttestudo.accuracy.loss_report import (
    Age,
    CrossingLoss,
    FieldLoss,
    Frames,
    ImageLoss,
    Sightings,
    TopicArm,
    TopicLoss,
)
from smarttestudo.accuracy.reconstruction import field_error
from smarttestudo.accuracy.samples import Field, Series, TopicSamples
from smarttestudo.domain.names import is_source
from smarttestudo.domain.signal import ArrivalProperty, Signal, SignalKind
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.language.formatter import value_text
from smarttestudo.language.normal_form import reads
from smarttestudo.language.properties.field_path import ANY
from smarttestudo.language.region import Region
from smarttestudo.language.rule_set import RuleSet, WrittenCheck
from smarttestudo.language.syntax import Operator
from smarttestudo.language.text_region import SetOfValues
from smarttestudo.pacing.coded_video import IMAGE_TYPES

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
        if field.word is None and (value_range or field.is_asked):
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
        field = fields.get(threshold.field.name)
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


Change = tuple[int, bool]
"""A stamp in ns, and whether the check holds from then on."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Threshold:
    """A check of a field: it holds in ``region``."""

    signal: Signal
    region: SetOfValues

    def __str__(self) -> str:
        """``/odom pose_y > 5.4``."""
        return f"{self.signal} {self._comparison}"

    @property
    def _comparison(self) -> str:
        comparison = self.region.comparison
        if comparison is None:
            raise ValueError(f"no comparison holds in {self.region}")
        operator, value = comparison
        return f"{operator.value} {value_text(value) if isinstance(value, str) else f'{value:g}'}"

    @property
    def is_word(self) -> bool:
        """Whether it compares with a text or a state, which is right or wrong and not far off."""
        return self.signal.kind is not SignalKind.NUMBER

    @property
    def field(self) -> Field:
        """The field to look at: the number, or whether the check holds where there is none."""
        name = self.signal.property
        if not self.is_word and ANY not in name:
            return Field(name=name)
        check = WrittenCheck(line=0, column=0, signal=self.signal, region=self.region)
        return Field(name=f"{name} {self._comparison}", word=check)

    @property
    def field_region(self) -> Region:
        """Where the values of ``field`` lie while it holds."""
        if self.field.word is None and isinstance(self.region, Region):
            return self.region
        return Region.where(Operator.GREATER_EQUAL, 1.0)


def thresholds_of(rule_set: RuleSet) -> tuple[Threshold, ...]:
    """The checks of ``rule_set`` that read a field, sorted; a check and its negation are one threshold."""
    found: dict[tuple[Signal, frozenset[SetOfValues]], Threshold] = {}
    for block in rule_set.blocks:
        for within in reads(block.form):
            signal, region = within.signal, within.region
            if signal.kind is SignalKind.UNRESOLVED or not _is_recorded(signal):
                continue
            if region.comparison is not None:
                sides = frozenset({region, region.complement()})
                found.setdefault((signal, sides), Threshold(signal=signal, region=region))
    return tuple(sorted(found.values(), key=lambda one: (one.signal, *_order_of(one.region))))


def _order_of(region: SetOfValues) -> tuple[object, object]:
    return (region.cuts, "") if isinstance(region, Region) else ((), str(region.comparison))


def _is_recorded(signal: Signal) -> bool:
    """Whether a recording has values of ``signal``, message by message."""
    return not is_source(signal.topic) and ArrivalProperty.named(signal.property) is None


def crossing_loss(
    threshold: Threshold, sent: Series, received: Series, fixed: Series, end_ns: int
) -> CrossingLoss:
    """How the crossings of ``sent`` until ``end_ns`` were seen in the other two."""
    region = threshold.field_region
    crossings, sent_changes = _crossings(region, sent, end_ns), changes(region, sent)

    def seen_in(series: Series) -> Sightings:
        seen = changes(region, series)
        sightings = _sightings(crossings, seen, end_ns)
        return (
            replace(sightings, wrong_s=_wrong_s(sent_changes, seen, end_ns))
            if threshold.is_word
            else sightings
        )

    return CrossingLoss(
        check=str(threshold), crossings=len(crossings), received=seen_in(received), fixed=seen_in(fixed)
    )


def _wrong_s(sent: Sequence[Change], seen: Sequence[Change], end_ns: int) -> float:
    """For how long the operator believed something else than what was so, or knew nothing of it."""
    both = [(at_ns, is_seen, holds) for is_seen, side in enumerate((sent, seen)) for at_ns, holds in side]
    now: list[bool | None] = [None, None]
    wrong_ns, before_ns = 0, end_ns
    for at_ns, is_seen, holds in sorted(one for one in both if one[0] <= end_ns):
        wrong_ns += max(at_ns - before_ns, 0)
        now[is_seen] = holds
        before_ns = end_ns if now[0] is None or now[0] == now[1] else at_ns
    return (wrong_ns + end_ns - before_ns) / NS_PER_S


def changes(region: Region, series: Series) -> list[Change]:
    """The first known truth of a check and each change of it; a value that is unknown changes nothing.

    Nor does one that is replaced at the same stamp.
    """
    found: list[Change] = []
    stamps_ns = series.stamps_ns
    for stamp_ns, value, next_ns in zip_longest(stamps_ns, series.values, stamps_ns[1:]):
        if stamp_ns == next_ns:
            continue
        holds = region.contains(value)
        if value == value and (not found or found[-1][1] != holds):  # noqa: PLR0124 - NaN differs from itself
            found.append((stamp_ns, holds))
    return found


@dataclass(frozen=True, slots=True, kw_only=True)
class _Crossing:
    """A change at ``stamp_ns``; ``before_ns`` is the sample before, ``after_ns`` when the next one comes.

    After the last sample, the next one counts as due after the same time once more.
    """

    stamp_ns: int
    holds: bool
    before_ns: int
    after_ns: int


def _crossings(region: Region, sent: Series, end_ns: int) -> list[_Crossing]:
    crossed = {stamp_ns: holds for stamp_ns, holds in changes(region, sent)[1:] if stamp_ns <= end_ns}
    stamps_ns = sorted(set(sent.stamps_ns)) if crossed else []
    return [
        _Crossing(
            stamp_ns=stamp_ns,
            holds=crossed[stamp_ns],
            before_ns=stamps_ns[index - 1],
            after_ns=(*stamps_ns[index + 1 : index + 2], 2 * stamp_ns - stamps_ns[index - 1])[0],
        )
        for index, stamp_ns in enumerate(stamps_ns)
        if stamp_ns in crossed
    ]


def _sightings(crossings: Sequence[_Crossing], seen: Sequence[Change], end_ns: int) -> Sightings:
    """Match each crossing with the first change to the same side before the robot crosses that way again.

    It is in time before the robot's next message. One that follows a missed one is missed too: it leads back
    to where the operator believes the robot to be.
    """
    in_time, delays_ns, place = 0, [], 0
    for crossing, again_ns in _with_deadlines(crossings, end_ns):
        found = _first_sight(crossing, again_ns, seen, place)
        if found is None:
            continue
        place = found + 1
        if seen[found][0] < crossing.after_ns:
            in_time += 1
        else:
            delays_ns.append(seen[found][0] - crossing.stamp_ns)
    late = len(delays_ns)
    return Sightings(
        in_time=in_time,
        late=late,
        missed=len(crossings) - in_time - late,
        late_mean_s=sum(delays_ns) / late / NS_PER_S if late else None,
        late_max_s=max(delays_ns) / NS_PER_S if late else None,
    )


def _first_sight(crossing: _Crossing, again_ns: int, seen: Sequence[Change], place: int) -> int | None:
    """Where in ``seen``, from ``place`` on, the crossing is seen; ``None`` if not before ``again_ns``."""
    while place < len(seen) and seen[place][0] <= again_ns:
        stamp_ns, holds = seen[place]
        if holds == crossing.holds and stamp_ns > crossing.before_ns:
            return place
        place += 1
    return None


def _with_deadlines(crossings: Sequence[_Crossing], end_ns: int) -> Iterator[tuple[_Crossing, int]]:
    """Pair each crossing with the last moment before the robot crosses the same way again."""
    for index, crossing in enumerate(crossings):
        again = index + 2
        yield crossing, crossings[again].stamp_ns - 1 if again < len(crossings) else end_ns
