# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A recording at fixed rates and under rules: how far the operator's picture is off, for how many bytes."""

from __future__ import annotations

import math
from collections import Counter, defaultdict
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, field, replace
from pathlib import Path

from smarttestudo.accuracy.comparison import (
    AccuracyComparison,
    Arm,
    Decode,
    Message,
    PropertyAccuracy,
    TopicAccuracy,
    View,
    picture_errors,
)
from smarttestudo.accuracy.recorded_samples import SampleTaker, TopicReading
from smarttestudo.accuracy.samples import IMAGE_TYPES, TopicSamples
from smarttestudo.bags.definitions import RosbagDecoder
from smarttestudo.bags.reader import open_recording
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.recording import Channel, RecordingReader
from smarttestudo.language.properties import (
    accuracy_properties_of,
    gauges_for,
    needs_decoded,
    properties_for_bounds,
)
from smarttestudo.language.rule_set import RuleSet
from smarttestudo.pacing.bound import BoundRecord
from smarttestudo.pacing.reckoning.picture import Picture
from smarttestudo.pacing.sample import StreamKind
from smarttestudo.replays.outcome import ReplayOutcome
from smarttestudo.replays.replay import ReplayRequest, replay_together

FIXED = "fixed rates"
_HALVINGS = 16
Progress = Callable[[str], AbstractContextManager[Callable[[float], None]]]


@dataclass(frozen=True, slots=True, kw_only=True)
class NamedRules:
    """Rules as the comparison calls them, for an operator whose end shows ``view``."""

    name: str
    rule_set: RuleSet
    view: View = View.HOLD


@dataclass(frozen=True, slots=True, kw_only=True)
class AccuracyRequest:
    """A recording, and the rules to compare; fixed rates get the bytes of the first.

    Where the rules bound no property, the poses and joints of what the first relay are compared. ``called``
    is what the user calls the recording, where that is not its path. ``received`` is the recording that a
    replay under the first rules made, if there is one: rules without a bound are then not replayed again.
    """

    bag: Path
    rules: Sequence[NamedRules]
    progress: Progress
    called: str | None = None
    profile: Profile = field(default_factory=Profile)
    received: Path | None = None


def compare_accuracy(request: AccuracyRequest) -> AccuracyComparison | None:
    """Replay the recording under all of the rules, thin it to fixed rates, and measure the pictures.

    It is read once. Topics of images are left out. ``None`` where nothing that is relayed can be measured.

    Raises:
        RecordingError: the recording cannot be read, or a check reads a topic of unknown type.
    """
    with open_recording(request.bag) as recording:
        channels = {channel.topic: channel for channel in reversed(recording.channels)}
        first = request.rules[0].rule_set
        measured = _measured(request.rules, channels)
        if not measured:
            return None
        relayed = dict.fromkeys(topic for one in request.rules for topic in one.rule_set.relayed)
        compared = [
            topic for topic in relayed if topic in channels and channels[topic].type_name not in IMAGE_TYPES
        ]
        left_out = [topic for topic in first.relayed if topic in channels and topic not in compared]
        source, runs = _read(request, recording, compared, measured)
    rates_hz = _fixed_rates(source, runs[0])
    fixed = _thinned(source, rates_hz, measured)
    judge = _Judge(source, {topic: (channels[topic], names) for topic, names in measured.items()})
    return AccuracyComparison(
        bag=request.called or str(request.bag),
        arms=tuple(judge.arm(run) for run in (fixed, *runs)),
        fixed_hz=rates_hz,
        left_out=tuple(left_out),
        notices=source.notices,
    )


Measured = Mapping[str, Sequence[str]]
"""The properties that are measured, by topic."""


def _measured(rules: Sequence[NamedRules], channels: Mapping[str, Channel]) -> Measured:
    """What any of the rules bounds; without a bound, poses and joints of the topics that the first relay."""
    bounded: dict[str, dict[str, None]] = defaultdict(dict)
    for one in rules:
        for topic, bounds in _bounds(one.rule_set).items():
            if topic in channels:
                bounded[topic].update(dict.fromkeys(bounds))
    if bounded:
        return {topic: tuple(names) for topic, names in bounded.items()}
    usual = properties_for_bounds()
    return {
        topic: tuple(spec.name for spec in usual[channels[topic].type_name])
        for topic in rules[0].rule_set.relayed
        if topic in channels and channels[topic].type_name in usual
    }


def _bounds(rule_set: RuleSet) -> dict[str, dict[str, set[float]]]:
    """Every bound that the rules name, by topic and property."""
    found: dict[str, dict[str, set[float]]] = defaultdict(lambda: defaultdict(set))
    for bounds in (rule_set.bounds, *(block.bounds for block in rule_set.blocks)):
        for topic, of_topic in bounds.items():
            for name, bound in of_topic.items():
                found[topic][name].add(bound)
    return found


@dataclass(frozen=True, slots=True, kw_only=True)
class _Source:
    """What the robot sent: all of the measured topics, stamps and sizes of each compared one."""

    messages: Mapping[str, Sequence[Message]]
    samples: Mapping[str, TopicSamples]
    end_ns: int
    notices: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class _Run:
    """What passed: all of the measured topics, and of each compared one how much."""

    name: str
    view: View
    messages: Mapping[str, Sequence[Message]]
    counts: Mapping[str, int]
    sizes: Mapping[str, int]
    bounds: Mapping[str, Mapping[str, set[float]]] = field(default_factory=dict)
    records: Mapping[str, Mapping[str, BoundRecord]] = field(default_factory=dict)


class _Passed:
    """Takes what a replay relays, as a recording would."""

    def __init__(self, measured: Measured, declared_bytes: Mapping[str, int]) -> None:
        self.messages: dict[str, list[Message]] = {topic: [] for topic in measured}
        self.counts: Counter[str] = Counter()
        self.sizes: Counter[str] = Counter()
        self._declared_bytes = declared_bytes

    def add(self, channel: Channel) -> None:
        """Nothing is announced."""

    def write(self, channel: Channel, stamp_ns: int, payload: bytes) -> None:
        """Count one message."""
        topic = channel.topic
        self.counts[topic] += 1
        self.sizes[topic] += self._declared_bytes.get(topic, len(payload))
        if topic in self.messages:
            self.messages[topic].append((stamp_ns, payload))


class _Sent:
    """Takes what the robot sent, in the time of the recording."""

    def __init__(self, recording: RecordingReader, compared: Sequence[str], measured: Measured) -> None:
        self._recording = recording
        self._messages: dict[str, list[Message]] = {topic: [] for topic in measured}
        self._taker = SampleTaker(
            dict.fromkeys(compared, TopicReading()),
            recording.declared_bytes,
            start_ns=recording.start_ns,
            end_ns=recording.end_ns,
        )
        for channel in recording.channels:
            self._taker.add(channel)

    def take(self, channel: Channel, stamp_ns: int, payload: bytes) -> None:
        """Take one message."""
        if self._taker.take(channel, stamp_ns, payload) and channel.topic in self._messages:
            self._messages[channel.topic].append((stamp_ns, payload))

    def source(self) -> _Source:
        """What was taken."""
        return _Source(
            messages=self._messages,
            samples=self._taker.samples,
            end_ns=self._recording.end_ns,
            notices=(*self._recording.notices(), *self._taker.notices()),
        )


def _read(
    request: AccuracyRequest, recording: RecordingReader, compared: Sequence[str], measured: Measured
) -> tuple[_Source, list[_Run]]:
    """What the robot sent, and what passes of it under each of the rules."""
    sent = _Sent(recording, compared, measured)
    known = _received(request, measured)
    passed = [_Passed(measured, recording.declared_bytes) for _ in request.rules[len(known) :]]
    replayed = request.rules[len(known) :]
    with request.progress("Comparing fixed rates and rules") as report:
        requests = [
            ReplayRequest(
                recording=recording,
                rule_set=rules.rule_set,
                profile=request.profile,
                output=request.bag,
                writer=writer,
                predict=frozenset(_bounds(rules.rule_set)) if rules.view is View.RECKONED else (),
                left_out=_images_without_effect(recording.channels, rules.rule_set, request.profile),
            )
            for rules, writer in zip(replayed, passed, strict=True)
        ]
        requests[0] = replace(requests[0], arrived=sent.take, report=report)
        records = [_records(outcome) for outcome in replay_together(requests)]
    runs = [
        _Run(
            name=rules.name,
            view=rules.view,
            messages=one.messages,
            counts=one.counts,
            sizes={topic: one.sizes[topic] for topic in compared},
            bounds=_bounds(rules.rule_set),
            records=found,
        )
        for rules, one, found in zip(
            request.rules, (*known, *passed), (*({} for _ in known), *records), strict=True
        )
    ]
    return sent.source(), runs


def _received(request: AccuracyRequest, measured: Measured) -> list[_Passed]:
    """What passes under the first rules, where it was recorded and no bound of theirs could be broken."""
    first, *others = request.rules
    if request.received is None or not others or _bounds(first.rule_set) or first.view is View.RECKONED:
        return []
    with open_recording(request.received) as recording:
        passed = _Passed(measured, recording.declared_bytes)
        for message in recording.messages():
            passed.write(*message)
    return [passed]


def _images_without_effect(
    channels: Sequence[Channel], rule_set: RuleSet, profile: Profile
) -> frozenset[str]:
    """The topics of images that no check reads, no bound is for, and no other topic is paced with."""
    needed = {
        *(signal.topic for signal in rule_set.signals),
        *(entry.paced_with for entry in profile.topics.values()),
        *_bounds(rule_set),
    }
    return frozenset(one.topic for one in channels if one.type_name in IMAGE_TYPES).difference(needed)


def _records(outcome: ReplayOutcome) -> Mapping[str, Mapping[str, BoundRecord]]:
    return {topic: one.bounds for topic, one in outcome.topics.items()}


def _fixed_rates(source: _Source, first: _Run) -> dict[str, float]:
    """For each topic the rate that carries the bytes that the first rules let pass, infinite for all."""
    rates_hz: dict[str, float] = {}
    for topic, samples in source.samples.items():
        share = first.sizes[topic] / samples.size_bytes if samples.size_bytes else 1.0
        source_hz = samples.mean_hz
        if share >= 1 or not source_hz:
            rates_hz[topic] = math.inf
        elif samples.kind is StreamKind.TRANSFORMS:
            rates_hz[topic] = _rate_of_frames(samples, first.sizes[topic], source_hz, source.end_ns)
        else:
            rates_hz[topic] = share * source_hz
    return rates_hz


def _rate_of_frames(samples: TopicSamples, size_bytes: int, source_hz: float, end_ns: int) -> float:
    """The rate of each frame at which about so many bytes pass, which is found by halving.

    Slow frames pass whole, so that bytes are not in proportion to rates; none is faster than ``source_hz``.
    """
    low_hz, high_hz = 0.0, source_hz
    for _ in range(_HALVINGS):
        rate_hz = (low_hz + high_hz) / 2
        passed_bytes = sum(samples.sizes[index] for index in samples.at_rate(rate_hz, end_ns).indices)
        low_hz, high_hz = (rate_hz, high_hz) if passed_bytes <= size_bytes else (low_hz, rate_hz)
    return low_hz


def _thinned(source: _Source, rates_hz: Mapping[str, float], measured: Measured) -> _Run:
    """The recording at fixed rates, by the pacer that relays use."""
    passed = {
        topic: samples.at_rate(rates_hz[topic], source.end_ns) for topic, samples in source.samples.items()
    }
    return _Run(
        name=FIXED,
        view=View.HOLD,
        messages={
            topic: [
                (stamp_ns, source.messages[topic][index][1])
                for stamp_ns, index in zip(passed[topic].stamps_ns, passed[topic].indices, strict=True)
            ]
            for topic in measured
        },
        counts={topic: len(one.indices) for topic, one in passed.items()},
        sizes={
            topic: sum(source.samples[topic].sizes[index] for index in one.indices)
            for topic, one in passed.items()
        },
    )


class _Judge:
    """Compares the operator's pictures with what the robot sent."""

    def __init__(self, source: _Source, measured: Mapping[str, tuple[Channel, Sequence[str]]]) -> None:
        self._source = source
        self._measured = measured
        self._decoder = RosbagDecoder()

    def arm(self, run: _Run) -> Arm:
        """The accuracy of each measured topic in one run."""
        return Arm(
            name=run.name,
            view=run.view,
            size_bytes=sum(run.sizes.values()),
            topics={topic: self._topic(topic, run) for topic in self._measured},
        )

    def _topic(self, topic: str, run: _Run) -> TopicAccuracy:
        channel, names = self._measured[topic]
        gauges = gauges_for(channel.type_name, names)
        errors = picture_errors(
            Picture(gauges, reckons=run.view is View.RECKONED),
            self._source.messages[topic],
            run.messages[topic],
            self._source.end_ns,
            self._decode(channel) if needs_decoded(gauges) else _leave,
        )
        specs = accuracy_properties_of(channel.type_name)
        bounds, records = run.bounds.get(topic, {}), run.records.get(topic, {})
        return TopicAccuracy(
            messages=run.counts.get(topic, 0),
            size_bytes=run.sizes.get(topic, 0),
            properties={
                name: PropertyAccuracy(
                    unit=specs[name].unit if name in specs else "",
                    error=errors.get(name),
                    bounds=tuple(sorted(bounds.get(name, ()))),
                    broken=records[name].broken if name in records else 0,
                )
                for name in names
            },
        )

    def _decode(self, channel: Channel) -> Decode:
        def decode(payload: bytes) -> object | None:
            try:
                return self._decoder.decode(channel, payload)
            except RecordingError:
                return None

        return decode


def _leave(_: bytes) -> None:
    """No decoded message is needed."""
