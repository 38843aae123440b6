# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The messages that an accuracy needs, under bounds and at fixed rates."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import Annotated

from smarttestudo.accuracy.arms import Arm, PacedPicture, Strategy, rate_of_messages
from smarttestudo.accuracy.recorded_samples import TopicReading, read_samples
from smarttestudo.accuracy.samples import Message, TopicSamples
from smarttestudo.bags.reader import open_recording
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.rate_meter import mean_hz
from smarttestudo.domain.record import JsonEntry, derived
from smarttestudo.domain.recording import Channel
from smarttestudo.domain.units import NS_PER_S, counted
from smarttestudo.language.properties import needs_decoded, properties_for_bounds
from smarttestudo.pacing.reckoning.estimate import MAX_PARTS, Estimate
from smarttestudo.pacing.reckoning.gauges import Distance, MovingPart, Reading

_SMALL_BOUNDS = (0.01, 0.02, 0.05, 0.1, 0.2)
_BOUNDS_BY_UNIT: Mapping[str, tuple[float, ...]] = MappingProxyType(
    {"m": _SMALL_BOUNDS, "rad": _SMALL_BOUNDS, "°": (1.0, 2.0, 5.0, 10.0, 20.0)}
)
_POSITIONS = (
    "nav_msgs/msg/Odometry",
    "geometry_msgs/msg/PoseWithCovarianceStamped",
    "geometry_msgs/msg/PoseStamped",
    "tf2_msgs/msg/TFMessage",
)


@dataclass(frozen=True, slots=True, kw_only=True)
class FixedPicture(PacedPicture):
    """The picture at a fixed rate of ``hz``, which is infinite where every message passes."""

    hz: float


@dataclass(frozen=True, slots=True, kw_only=True)
class BoundCost:
    """The cost and effect of a bound, and beside it the fixed rate of as many messages."""

    within: Annotated[PacedPicture, JsonEntry(is_merged=True)]
    fixed: FixedPicture


@dataclass(frozen=True, slots=True, kw_only=True)
class AccuracyPoint:
    """One bound, with a receiver that holds and with one that reckons, if what it shows can be reckoned."""

    bound: float
    hold: BoundCost
    reckoned: BoundCost | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Motion:
    """Speed of a property from message to message, of the part that moves most: |x′| per s.

    ``part`` is a child frame or a joint, or empty.
    """

    mean_per_s: float
    max_per_s: float
    part: str = ""

    @property
    @derived("mean_over_max")
    def share(self) -> float | None:
        """Mean over maximum: what share of a fixed rate's messages a bound needs at best with hold."""
        return self.mean_per_s / self.max_per_s if self.max_per_s else None


@dataclass(frozen=True, slots=True, kw_only=True)
class AccuracyCurve:
    """A property of a topic at some bounds, beside the ``messages`` of its source and their mean rate.

    ``source_hz`` is ``None`` where all of them have one stamp.
    """

    topic: str
    property_name: Annotated[str, JsonEntry(name="property")]
    unit: str
    messages: int
    source_hz: Annotated[float | None, JsonEntry(is_absent=True)]
    motion: Annotated[Motion, JsonEntry(is_merged=True)]
    points: tuple[AccuracyPoint, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class WantedProperty:
    """A property to measure, with the bounds to try, in its unit."""

    name: str
    unit: str
    bounds: tuple[float, ...]


def usual_bounds(unit: str, value_range: float | None) -> tuple[float, ...]:
    """1, 2, 5, 10 and 20 cm, hundredths of a rad, degrees, or percent of ``value_range``."""
    if unit in _BOUNDS_BY_UNIT:
        return _BOUNDS_BY_UNIT[unit]
    return tuple(share * value_range for share in _SMALL_BOUNDS) if value_range else ()


def geometry_of(type_name: str) -> tuple[WantedProperty, ...]:
    """Positions, orientations and joints of a type that has any, with their usual bounds."""
    return tuple(
        WantedProperty(name=spec.name, unit=spec.unit, bounds=usual_bounds(spec.unit, None))
        for spec in properties_for_bounds().get(type_name, ())
    )


def accuracy_wanted(samples: TopicSamples, asked: Collection[str]) -> tuple[WantedProperty, ...]:
    """Of a topic whose fields are ``asked`` for, those that change; else its geometry."""
    if not asked:
        return geometry_of(samples.channel.type_name)
    changing = ((one, samples.series(one).value_range) for one in samples.fields if one.name in asked)
    return tuple(
        WantedProperty(name=one.name, unit=one.unit, bounds=usual_bounds(one.unit, value_range))
        for one, value_range in changing
        if value_range
    )


def position_wanted(
    channels: Iterable[Channel], topics: Collection[str]
) -> dict[str, tuple[WantedProperty, ...]]:
    """The position of one of ``topics``: of odometry, else of a pose, else of frames; empty without any."""
    known = [one for one in channels if one.topic in topics and one.type_name in _POSITIONS]
    first = min(known, key=lambda one: (_POSITIONS.index(one.type_name), one.topic), default=None)
    return {} if first is None else {first.topic: geometry_of(first.type_name)[:1]}


Wanted = Mapping[str, Sequence[WantedProperty]]
"""By topic."""

Accuracies = tuple[tuple[AccuracyCurve, ...], tuple[str, ...]]
"""The curves of some topics, by topic and property, and what was left out, a line each."""


def readings_for(wanted: Wanted, profile: Profile) -> dict[str, TopicReading]:
    """How the topics are to be read for ``accuracies``."""
    return {
        topic: TopicReading(
            properties=tuple(one.name for one in properties), level_unit=profile.topic(topic).level_unit
        )
        for topic, properties in wanted.items()
        if properties
    }


def measure_accuracy(
    bag: Path, wanted: Wanted, profile: Profile, report: Callable[[float], None]
) -> Accuracies:
    """Measure what each bound costs in a recording. Raises ``RecordingError`` where it cannot be read."""
    readings = readings_for(wanted, profile)
    if not readings:
        return (), ()
    with open_recording(bag) as recording:
        samples = read_samples(recording, readings, topics=readings, report=lambda done: report(done / 2))
        end_ns = recording.end_ns
    return accuracies(samples.topics, wanted, end_ns, lambda done: report((1 + done) / 2))


def accuracies(
    samples: Mapping[str, TopicSamples], wanted: Wanted, end_ns: int, report: Callable[[float], None]
) -> Accuracies:
    """Measure what each bound costs of what is ``wanted``; ``samples`` keep these properties."""
    curves: list[AccuracyCurve] = []
    notices: list[str] = []
    topics = sorted(topic for topic in samples if wanted.get(topic))
    for number, topic in enumerate(topics):
        report(number / len(topics))
        found = [_curve(samples[topic], one, end_ns) for one in wanted[topic]]
        curves += (one for one in found if one.motion.max_per_s)
        for one in found:
            unreadable = len(samples[topic].track) - one.messages
            # A property that no message says is not one of the topic.
            if unreadable and one.messages:
                left_out = counted(unreadable, "message")
                what = f"{topic} {one.property_name}"
                notices.append(f"{what}: {left_out} without a value, which no bound's figures hold")
    return tuple(curves), tuple(notices)


def _curve(samples: TopicSamples, wanted: WantedProperty, end_ns: int) -> AccuracyCurve:
    """Send a topic within each bound, then at the rates of as many messages."""
    kind, gauges = samples.kind, samples.track.gauges([wanted.name])

    def readable() -> Iterator[Message]:
        picture = Estimate(gauges, reckons=False)
        return (one for one in samples.track.messages([wanted.name]) if picture.says_all(one.readings))

    def sent(strategies: Iterable[Strategy]) -> dict[Strategy, PacedPicture]:
        arms = {one: Arm(Estimate(gauges, reckons=one.reckons), wanted.name, kind, one) for one in strategies}
        for message in readable():
            for arm in arms.values():
                arm.send(message)
        return {strategy: arm.finish(end_ns) for strategy, arm in arms.items()}

    meter, stamps_ns, frames = MotionMeter(gauges[0].distances[wanted.name]), [], []
    for message in readable():
        stamps_ns.append(message.stamp_ns)
        frames.append(message.frames)
        meter.add(message.readings[0])
    # Fields that are read by decoding stay as they are, also for who reckons.
    receivers = (False,) if needs_decoded(gauges) else (False, True)
    within = sent(Strategy(reckons=reckons, bound=bound) for reckons in receivers for bound in wanted.bounds)
    rate_of = partial(rate_of_messages, stamps_ns=stamps_ns, end_ns=end_ns, kind=kind, frames=frames)
    at_rates = {
        one: Strategy(reckons=one.reckons, rate_hz=rate_of(picture.messages))
        for one, picture in within.items()
    }
    fixed = sent(at_rates.values())
    costs = {
        (one.reckons, one.bound): BoundCost(
            within=picture, fixed=FixedPicture(hz=at_rates[one].rate_hz, **asdict(fixed[at_rates[one]]))
        )
        for one, picture in within.items()
    }
    return AccuracyCurve(
        topic=samples.channel.topic,
        property_name=wanted.name,
        unit=wanted.unit,
        messages=len(stamps_ns),
        source_hz=mean_hz(len(stamps_ns), stamps_ns[-1] - stamps_ns[0] if stamps_ns else 0),
        motion=meter.motion,
        points=tuple(
            AccuracyPoint(bound=bound, hold=costs[False, bound], reckoned=costs.get((True, bound)))
            for bound in wanted.bounds
        ),
    )


class MotionMeter:
    """A meter of how fast one property changes, each part on its own."""

    def __init__(self, distance: Distance) -> None:
        self._distance = distance
        self._parts: dict[Hashable, _Travel] = {}

    def add(self, reading: Reading | None) -> None:
        """Take what was read of a message of the source."""
        for part in reading or ():
            travel = self._parts.get(part.name)
            if travel is not None:
                travel.go_on(part, self._distance)
            elif len(self._parts) < MAX_PARTS:
                self._parts[part.name] = _Travel(part)

    @property
    def motion(self) -> Motion:
        """Of the part that moved most."""
        most = max(self._parts.values(), key=lambda one: one.way, default=None)
        if most is None or not most.lasted_s:
            return Motion(mean_per_s=0.0, max_per_s=0.0)
        return Motion(mean_per_s=most.way / most.lasted_s, max_per_s=most.max_per_s, part=most.last.name)


class _Travel:
    """The way that a part moved in the time between its first and last message."""

    __slots__ = ("last", "lasted_s", "max_per_s", "way")

    def __init__(self, part: MovingPart) -> None:
        self.last = part
        self.way = self.max_per_s = self.lasted_s = 0.0

    def go_on(self, part: MovingPart, distance: Distance) -> None:
        last, self.last = self.last, part
        elapsed_s = (part.at_ns - last.at_ns) / NS_PER_S
        step = distance.between(part.state, last.state)
        if elapsed_s <= 0 or last.frames != part.frames or not step < math.inf:
            return
        self.way += step
        self.lasted_s += elapsed_s
        self.max_per_s = max(self.max_per_s, step / elapsed_s)
