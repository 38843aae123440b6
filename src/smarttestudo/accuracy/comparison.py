# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The accuracy of an operator's picture, by several ways of choosing what passes."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, field, replace
from enum import Enum
from itertools import zip_longest
from pathlib import Path
from typing import Annotated

from smarttestudo.accuracy.arms import PacedPicture, Receiver, picture_errors, rate_of_bytes
from smarttestudo.accuracy.bounds import bounds_of
from smarttestudo.accuracy.recorded_samples import RecordedSamples, SampleTaker, TopicReading, read_samples
from smarttestudo.accuracy.samples import TopicSamples
from smarttestudo.bags.reader import open_recording
from smarttestudo.bags.type_definitions import rules_for
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.record import JsonEntry, derived, to_columns
from smarttestudo.domain.recording import Channel, RecordingReader, first_of_topics
from smarttestudo.language.properties import accuracy_properties_of, properties_for_bounds
from smarttestudo.language.rule_set import RuleSet
from smarttestudo.pacing.bound import BoundRecord
from smarttestudo.pacing.coded_video import IMAGE_TYPES
from smarttestudo.replays.replay import ReplayRequest, replay_together


class View(Enum):
    """The picture that an operator's end shows between two messages."""

    HOLD = "hold"
    RECKONED = "dead reckoning"


@dataclass(frozen=True, slots=True, kw_only=True)
class PropertyAccuracy:
    """One property of a topic, in ``unit``: its error, ``None`` where it was never known, and its bounds.

    ``bounds`` are those that the rules name, rising, empty where there is none; ``broken`` counts messages of
    the source after which the bound in force did not hold.
    """

    unit: str
    error: Annotated[PacedPicture | None, JsonEntry(is_absent=True)]
    bounds: tuple[float, ...] = ()
    broken: int = 0

    @property
    @derived()
    def rmse(self) -> float | None:
        """The error over time."""
        return self.error.rmse if self.error else None

    @property
    @derived()
    def worst(self) -> float | None:
        """The largest error."""
        return self.error.worst if self.error else None


@dataclass(frozen=True, slots=True, kw_only=True)
class TopicAccuracy:
    """A topic in one run: how much of it passed, and how accurate its properties were."""

    messages: int
    size_bytes: Annotated[int, JsonEntry(name="bytes")]
    properties: Mapping[str, PropertyAccuracy]


@dataclass(frozen=True, slots=True, kw_only=True)
class ArmAccuracy:
    """One way of choosing what passes; ``size_bytes`` are those of all topics that are compared."""

    name: str
    view: Annotated[View, JsonEntry(name="shows")]
    is_fixed: Annotated[bool, JsonEntry(name="fixed")]
    size_bytes: Annotated[int, JsonEntry(name="bytes")]
    topics: Mapping[str, TopicAccuracy]


@dataclass(frozen=True, slots=True, kw_only=True)
class AccuracyComparison:
    """The ways beside each other, of a recording called ``bag``.

    The first are fixed rates for the bytes of the first rules, then come the rules. After rules that are
    shown reckoned come fixed rates for their bytes, shown alike. ``fixed_hz`` are the first rates by topic,
    infinite where everything passes. ``left_out`` are topics of images, which would hide the others' bytes.
    """

    bag: str
    arms: tuple[ArmAccuracy, ...]
    fixed_hz: Mapping[str, float]
    left_out: tuple[str, ...]
    notices: tuple[str, ...] = ()

    def pairs(self) -> Iterator[tuple[ArmAccuracy, ArmAccuracy | None]]:
        """All ways, those of rules with the fixed rates that are shown alike."""
        for arm, after in zip_longest(self.arms, self.arms[1:]):
            fixed = self.arms[0] if arm.view is View.HOLD else after
            yield arm, None if arm.is_fixed else fixed

    def rows(self) -> Iterator[dict[str, object]]:
        """One row for each way, topic and property, for ``--csv``."""
        for arm in self.arms:
            for topic, passed in arm.topics.items():
                for name, one in passed.properties.items():
                    row = AccuracyRow(
                        name=arm.name,
                        view=arm.view,
                        all_bytes=arm.size_bytes,
                        topic=topic,
                        messages=passed.messages,
                        size_bytes=passed.size_bytes,
                        property_name=name,
                        unit=one.unit,
                        rmse=one.rmse,
                        worst=one.worst,
                        bounds=one.bounds,
                        broken=one.broken,
                    )
                    yield to_columns(row)


@dataclass(frozen=True, slots=True, kw_only=True)
class AccuracyRow:
    """A property of a topic by one way of choosing what passes, as a row."""

    name: str
    view: Annotated[View, JsonEntry(name="shows")]
    all_bytes: int
    topic: str
    messages: int
    size_bytes: Annotated[int, JsonEntry(name="bytes")]
    property_name: Annotated[str, JsonEntry(name="property")]
    unit: str
    rmse: float | None
    worst: float | None
    bounds: tuple[float, ...]
    broken: int


FIXED = "fixed rates"
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

    It is read once. Topics of images are left out. ``None`` where nothing that is relayed can be measured,
    unless the recording holds no message at all.

    Raises:
        RecordingError: the recording cannot be read, or a check reads a topic of unknown type.
    """
    with open_recording(request.bag) as recording:
        measurement = ComparisonMeasurement(request, recording)
        if not measurement.properties and recording.message_count:
            return None
        return measurement.comparison(measurement.read(measurement.readings()))


class ComparisonMeasurement:
    """The reading of an opened recording, ``properties`` of which are compared, by topic."""

    def __init__(self, request: AccuracyRequest, recording: RecordingReader) -> None:
        rules = [replace(one, rule_set=rules_for(one.rule_set, recording.channels)) for one in request.rules]
        request = replace(request, rules=rules)
        self._request, self._recording = request, recording
        self._channels = first_of_topics(recording.channels)
        self._bounds = [bounds_of(one.rule_set) for one in request.rules]
        relayed = dict.fromkeys(topic for one in request.rules for topic in one.rule_set.relayed)
        self._compared = [
            topic
            for topic in relayed
            if topic in self._channels and self._channels[topic].type_name not in IMAGE_TYPES
        ]
        self.properties = self._measured()
        self._runs: list[_Run] = []

    def _measured(self) -> dict[str, tuple[str, ...]]:
        """Properties with a bound in any of the rules, else poses and joints of what the first relay."""
        bounded: dict[str, dict[str, None]] = {}
        for bounds in self._bounds:
            for topic, names in bounds.items():
                if topic in self._compared:
                    bounded.setdefault(topic, {}).update(dict.fromkeys(names))
        if bounded:
            return {topic: tuple(names) for topic, names in bounded.items()}
        usual = properties_for_bounds()
        return {
            topic: tuple(spec.name for spec in usual[self._channels[topic].type_name])
            for topic in self._request.rules[0].rule_set.relayed
            if topic in self._channels and self._channels[topic].type_name in usual
        }

    def readings(self) -> dict[str, TopicReading]:
        """How the recording, and what passes of it, is to be read."""
        return {topic: TopicReading(properties=self.properties.get(topic, ())) for topic in self._compared}

    def read(self, readings: Mapping[str, TopicReading]) -> RecordedSamples:
        """Read the recording in one pass, in which what passes under each of the rules is read, too."""
        request, recording = self._request, self._recording
        sent = SampleTaker(
            readings, recording.declared_bytes, start_ns=recording.start_ns, end_ns=recording.end_ns
        )
        for channel in recording.channels:
            sent.add(channel)
        self._runs = self._received()
        replayed = request.rules[len(self._runs) :]
        passed = [SampleTaker(self.readings(), recording.declared_bytes) for _ in replayed]
        with request.progress("Comparing fixed rates and rules") as report:
            requests = [self._replay(rules, writer) for rules, writer in zip(replayed, passed, strict=True)]
            requests[0] = replace(requests[0], arrived=sent.write, report=report)
            outcomes = replay_together(requests)
        self._runs += (
            _Run(
                name=rules.name,
                view=rules.view,
                topics=taker.samples,
                bounds=bounds_of(rules.rule_set),
                records={topic: one.bounds for topic, one in outcome.topics.items()},
            )
            for rules, taker, outcome in zip(replayed, passed, outcomes, strict=True)
        )
        told = (*recording.notices(), *sent.notices(), *(line for one in outcomes for line in one.notices))
        return RecordedSamples(topics=sent.samples, notices=tuple(dict.fromkeys(told)))

    def _received(self) -> list[_Run]:
        """The run under the first rules, where it was recorded and no bound of theirs could be broken."""
        request = self._request
        first, *others = request.rules
        if request.received is None or not others or self._bounds[0] or first.view is View.RECKONED:
            return []
        with open_recording(request.received) as recording:
            passed = read_samples(recording, self.readings(), report=lambda _: None)
        return [_Run(name=first.name, topics=passed.topics)]

    def _replay(self, rules: NamedRules, writer: SampleTaker) -> ReplayRequest:
        bounded, profile = bounds_of(rules.rule_set), self._request.profile
        return ReplayRequest(
            recording=self._recording,
            rule_set=rules.rule_set,
            profile=profile,
            output=self._request.bag,
            writer=writer,
            predict=frozenset(bounded) if rules.view is View.RECKONED else (),
            left_out=_images_without_effect(self._recording.channels, rules.rule_set, profile),
        )

    def comparison(self, sent: RecordedSamples) -> AccuracyComparison:
        """Compare the pictures of all runs with what the robot ``sent``."""
        request, end_ns = self._request, self._recording.end_ns
        samples = {topic: one for topic, one in sent.topics.items() if topic in self._compared}

        def rates_for(run: _Run) -> dict[str, float]:
            return {
                topic: rate_of_bytes(one, run.size_bytes(topic), end_ns) for topic, one in samples.items()
            }

        def at_rates(name: str, view: View, rates_hz: Mapping[str, float]) -> _Run:
            topics = {topic: one.at_rate(rates_hz[topic], end_ns) for topic, one in samples.items()}
            return _Run(name=name, view=view, topics=topics, is_fixed=True)

        fixed_hz = rates_for(self._runs[0])
        runs = [at_rates(FIXED, View.HOLD, fixed_hz)]
        for run in self._runs:
            runs.append(run)
            if run.view is View.RECKONED:
                runs.append(at_rates(f"{FIXED} for {run.name}", run.view, rates_for(run)))
        errors = {topic: self._errors(samples[topic], runs) for topic in self.properties}
        return AccuracyComparison(
            bag=request.called or str(request.bag),
            arms=tuple(
                self._arm(run, {topic: errors[topic][number] for topic in errors})
                for number, run in enumerate(runs)
            ),
            fixed_hz=fixed_hz,
            left_out=tuple(
                topic
                for topic in request.rules[0].rule_set.relayed
                if topic in self._channels and topic not in self._compared
            ),
            notices=sent.notices,
        )

    def _errors(self, sent: TopicSamples, runs: Sequence[_Run]) -> list[dict[str, PacedPicture]]:
        """The errors of one topic in each of the runs."""
        topic, track = sent.channel.topic, sent.track
        names = self.properties[topic]
        receivers = [
            Receiver(
                track.gauges(names),
                run.topics[topic].track.messages(names) if topic in run.topics else (),
                reckons=run.view is View.RECKONED,
            )
            for run in runs
        ]
        return picture_errors(track.messages(names), receivers, self._recording.end_ns)

    def _arm(self, run: _Run, errors: Mapping[str, Mapping[str, PacedPicture]]) -> ArmAccuracy:
        return ArmAccuracy(
            name=run.name,
            view=run.view,
            is_fixed=run.is_fixed,
            size_bytes=sum(run.size_bytes(topic) for topic in self._compared),
            topics={
                topic: TopicAccuracy(
                    messages=len(run.topics[topic].stamps_ns) if topic in run.topics else 0,
                    size_bytes=run.size_bytes(topic),
                    properties=self._properties(topic, run, errors[topic]),
                )
                for topic in self.properties
            },
        )

    def _properties(
        self, topic: str, run: _Run, errors: Mapping[str, PacedPicture]
    ) -> dict[str, PropertyAccuracy]:
        specs = accuracy_properties_of(self._channels[topic].type_name)
        bounds, records = run.bounds.get(topic, {}), run.records.get(topic, {})
        return {
            name: PropertyAccuracy(
                unit=specs[name].unit if name in specs else "",
                error=errors.get(name),
                bounds=tuple(sorted(bounds.get(name, ()))),
                broken=sum(one.broken for one in records.get(name, ())),
            )
            for name in self.properties[topic]
        }


@dataclass(frozen=True, slots=True, kw_only=True)
class _Run:
    """The messages that passed in one way, and by topic its bounds and how they were kept."""

    name: str
    view: View = View.HOLD
    topics: Mapping[str, TopicSamples]
    is_fixed: bool = False
    bounds: Mapping[str, Mapping[str, Collection[float]]] = field(default_factory=dict)
    records: Mapping[str, Mapping[str, Sequence[BoundRecord]]] = field(default_factory=dict)

    def size_bytes(self, topic: str) -> int:
        return self.topics[topic].size_bytes if topic in self.topics else 0


def _images_without_effect(
    channels: Sequence[Channel], rule_set: RuleSet, profile: Profile
) -> frozenset[str]:
    """The topics of images that no check reads, no bound is for, and no other topic is paced with."""
    needed = {
        *rule_set.topics_read,
        *(entry.paced_with for entry in profile.topics.values()),
        *bounds_of(rule_set),
    }
    return frozenset(one.topic for one in channels if one.type_name in IMAGE_TYPES).difference(needed)
