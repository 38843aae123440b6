# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How many messages each accuracy of a recording's topics needs."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from smarttestudo.accuracy.accuracy_curve import (
    AccuracyCurve,
    AccuracyMeter,
    AccuracyPoint,
    BoundPrice,
    MotionMeter,
    Paced,
    PacedPicture,
    usual_bounds,
)
from smarttestudo.accuracy.samples import TopicSamples
from smarttestudo.bags.definitions import RosbagDecoder
from smarttestudo.bags.reader import open_recording
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.profile import LevelUnit, Profile
from smarttestudo.domain.recording import Channel, RecordingReader
from smarttestudo.domain.units import NS_PER_S, counted
from smarttestudo.language.properties import gauges_for, needs_decoded, properties_for_bounds
from smarttestudo.pacing.cdr import FrameReader
from smarttestudo.pacing.reckoning.gauges import Gauge, Reading
from smarttestudo.pacing.sample import StreamKind

_MESSAGES_PER_REPORT = 4096
_TRIES = 4
_NEAR_ENOUGH = 0.01


@dataclass(frozen=True, slots=True, kw_only=True)
class WantedProperty:
    """A property to measure, with the bounds to try, in its unit."""

    name: str
    unit: str
    bounds: tuple[float, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Accuracies:
    """The curves of a recording, by topic and property; ``notices`` say what was left out."""

    curves: tuple[AccuracyCurve, ...] = ()
    notices: tuple[str, ...] = ()


def geometry_of(channels: Iterable[Channel]) -> dict[str, tuple[WantedProperty, ...]]:
    """Positions, orientations and joints of the topics that have any, with their usual bounds."""
    specs = properties_for_bounds()
    return {
        channel.topic: tuple(
            WantedProperty(name=spec.name, unit=spec.unit, bounds=usual_bounds(spec.unit, None))
            for spec in specs[channel.type_name]
        )
        for channel in channels
        if channel.type_name in specs
    }


def accuracy_wanted(samples: TopicSamples, asked: Collection[str]) -> tuple[WantedProperty, ...]:
    """Of a topic whose fields are ``asked`` for, those that change; else its geometry."""
    if not asked:
        return geometry_of([samples.channel]).get(samples.channel.topic, ())
    changing = ((one, samples.series(one).value_range) for one in samples.fields if one.name in asked)
    return tuple(
        WantedProperty(name=one.name, unit=one.unit, bounds=usual_bounds(one.unit, value_range))
        for one, value_range in changing
        if value_range
    )


_POSITIONS = (
    "nav_msgs/msg/Odometry",
    "geometry_msgs/msg/PoseWithCovarianceStamped",
    "geometry_msgs/msg/PoseStamped",
    "tf2_msgs/msg/TFMessage",
)


def position_wanted(
    channels: Iterable[Channel], topics: Collection[str]
) -> dict[str, tuple[WantedProperty, ...]]:
    """The position of one of ``topics``: of odometry, else of a pose, else of frames; empty without any."""
    known = [one for one in channels if one.topic in topics and one.type_name in _POSITIONS]
    first = min(known, key=lambda one: (_POSITIONS.index(one.type_name), one.topic), default=None)
    return {} if first is None else {first.topic: geometry_of([first])[first.topic][:1]}


def measure_accuracy(
    bag: Path,
    wanted: Mapping[str, Sequence[WantedProperty]],
    profile: Profile,
    report: Callable[[float], None],
) -> Accuracies:
    """What each bound costs, in two passes: one for all bounds, one for the fixed rates of as many messages.

    Raises ``RecordingError`` where the recording cannot be read.
    """
    with open_recording(bag) as recording:
        topics = {
            channel.topic: _Topic(channel, wanted[channel.topic], profile.topic(channel.topic).level_unit)
            for channel in reversed(recording.channels)
            if wanted.get(channel.topic)
        }
        if not topics:
            return Accuracies()
        _pass(recording, topics, lambda done: report(done / 2))
        for topic in topics.values():
            topic.turn_to_fixed_rates(recording.end_ns)
        _pass(recording, topics, lambda done: report((1 + done) / 2))
        curves = [curve for _, one in sorted(topics.items()) for curve in one.curves(recording.end_ns)]
        notices = [notice for _, one in sorted(topics.items()) for notice in one.notices()]
    return Accuracies(curves=tuple(curves), notices=tuple(notices))


def _pass(recording: RecordingReader, topics: Mapping[str, _Topic], report: Callable[[float], None]) -> None:
    start_ns, length_ns = recording.start_ns, max(recording.end_ns - recording.start_ns, 1)
    for number, (channel, stamp_ns, payload) in enumerate(recording.messages(topics)):
        if number % _MESSAGES_PER_REPORT == 0:
            report((stamp_ns - start_ns) / length_ns)
        topic = topics[channel.topic]
        if topic.samples.channel is channel:
            topic.take(stamp_ns, payload)


class _Topic:
    """A topic that is sent in all ways: first within each bound, then at fixed rates."""

    def __init__(
        self, channel: Channel, wanted: Sequence[WantedProperty], level_unit: LevelUnit | None
    ) -> None:
        self.samples = TopicSamples(channel)
        kind = self.samples.kind
        self._decoder = RosbagDecoder()
        self._frames = FrameReader() if kind is StreamKind.TRANSFORMS else None
        self._properties = [
            _Property(one, gauges_for(channel.type_name, [one.name], level_unit), kind) for one in wanted
        ]
        self._decodes = any(needs_decoded(one.gauges) for one in self._properties)
        self._is_second_pass = False
        self._unreadable = 0

    def take(self, stamp_ns: int, payload: bytes) -> None:
        message = self._decoded(payload) if self._decodes else None
        read = [(one, one.read(payload, message, stamp_ns)) for one in self._properties]
        if any(None in readings for _, readings in read):
            self._unreadable += not self._is_second_pass
            return
        frames = self._frames.child_frames(payload) if self._frames else ()
        if not self._is_second_pass:
            self.samples.add(stamp_ns, len(payload), frames)
        for one, readings in read:
            one.meter.take(readings, frames, stamp_ns)
            if not self._is_second_pass:
                one.motion.take(readings)

    def turn_to_fixed_rates(self, end_ns: int) -> None:
        """All bounds were measured: next are the rates of as many messages."""
        self._is_second_pass = True
        for one in self._properties:
            one.turn_to_fixed_rates(self.samples, end_ns)

    def curves(self, end_ns: int) -> Iterator[AccuracyCurve]:
        """Of what moves at all."""
        for one in self._properties:
            curve = one.curve(self.samples, end_ns)
            if curve.motion.max_per_s:
                yield curve

    def notices(self) -> Iterator[str]:
        if self._unreadable:
            unread = counted(self._unreadable, "message")
            yield f"{self.samples.channel.topic}: {unread} could not be read and stand in no bound's figures"

    def _decoded(self, payload: bytes) -> object | None:
        try:
            return self._decoder.decode(self.samples.channel, payload)
        except RecordingError:
            return None


@dataclass(slots=True)
class _Property:
    wanted: WantedProperty
    gauges: tuple[Gauge, ...]
    kind: StreamKind
    meter: AccuracyMeter = field(init=False)
    motion: MotionMeter = field(init=False)
    _within: list[PacedPicture] = field(init=False, default_factory=list)
    _rates_hz: list[float] = field(init=False, default_factory=list)

    def __post_init__(self) -> None:
        self.motion = MotionMeter(self.gauges, self.wanted.name)
        self._send([Paced(reckons=reckons, bound=bound) for reckons, bound in self._ways()])

    def read(self, payload: bytes, message: object | None, now_ns: int) -> tuple[Reading | None, ...]:
        return tuple(gauge.read(payload, message, now_ns) for gauge in self.gauges)

    def turn_to_fixed_rates(self, samples: TopicSamples, end_ns: int) -> None:
        self._within = self.meter.finish(end_ns)
        self._rates_hz = [_rate_of(error.messages, samples, end_ns) for error in self._within]
        self._send(list(dict.fromkeys(self._fixed_ways())))

    def curve(self, samples: TopicSamples, end_ns: int) -> AccuracyCurve:
        ways = self._fixed_ways()
        found = dict(zip(dict.fromkeys(ways), self.meter.finish(end_ns), strict=True))
        fixed = [found[way] for way in ways]
        prices = [
            BoundPrice(within=within, fixed=error, fixed_hz=rate_hz)
            for within, error, rate_hz in zip(self._within, fixed, self._rates_hz, strict=True)
        ]
        bounds = self.wanted.bounds
        held = prices[: len(bounds)]
        reckoned: Sequence[BoundPrice | None] = prices[len(bounds) :] or [None] * len(bounds)
        return AccuracyCurve(
            topic=samples.channel.topic,
            property_name=self.wanted.name,
            unit=self.wanted.unit,
            messages=len(samples.stamps_ns),
            source_hz=samples.mean_hz,
            motion=self.motion.motion,
            points=tuple(
                AccuracyPoint(bound=bound, hold=hold, reckoned=reckon)
                for bound, hold, reckon in zip(bounds, held, reckoned, strict=True)
            ),
        )

    def _ways(self) -> list[tuple[bool, float]]:
        """First those with hold; fields that are read by decoding stay as they are, also for who reckons."""
        receivers = (False,) if needs_decoded(self.gauges) else (False, True)
        return [(reckons, bound) for reckons in receivers for bound in self.wanted.bounds]

    def _fixed_ways(self) -> list[Paced]:
        rates = zip(self._ways(), self._rates_hz, strict=True)
        return [Paced(reckons=reckons, rate_hz=rate_hz) for (reckons, _), rate_hz in rates]

    def _send(self, ways: Sequence[Paced]) -> None:
        self.meter = AccuracyMeter(self.gauges, self.wanted.name, self.kind, ways)


def _rate_of(messages: int, samples: TopicSamples, end_ns: int) -> float:
    """The fixed rate at which about so many messages pass, infinite for all.

    Transforms have the rate for each frame, so that their messages at a rate must be counted.
    """
    lasted_s = (end_ns - samples.stamps_ns[0]) / NS_PER_S if samples.stamps_ns else 0.0
    if messages >= len(samples.stamps_ns) or not lasted_s:
        return math.inf
    rate_hz = max(messages - 1, 1) / lasted_s
    for _ in range(_TRIES):
        passed = len(samples.at_rate(rate_hz, end_ns).stamps_ns)
        if abs(passed - messages) <= max(1, _NEAR_ENOUGH * messages):
            break
        rate_hz *= messages / passed
    return rate_hz
