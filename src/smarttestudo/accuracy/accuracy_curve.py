# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The messages that an accuracy needs, under bounds and at fixed rates."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

from smarttestudo.accuracy.arms import Arm, PacedPicture, Strategy
from smarttestudo.accuracy.fixed_rates import rate_of_messages
from smarttestudo.accuracy.json_object import JsonObject
from smarttestudo.accuracy.recorded_samples import TopicReading, read_samples
from smarttestudo.accuracy.samples import TopicSamples
from smarttestudo.accuracy.track import Message
from smarttestudo.bags.reader import open_recording
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.rate_meter import mean_hz
from smarttestudo.domain.recording import Channel
from smarttestudo.domain.units import NS_PER_S, counted
from smarttestudo.language.properties import needs_decoded, properties_for_bounds
from smarttestudo.pacing.reckoning.gauges import Distance, MovingPart, Reading
from smarttestudo.pacing.reckoning.picture import MAX_PARTS, Picture

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
class BoundCost(JsonObject):
    """The cost and effect of a bound, and beside it the fixed rate of as many messages.

    ``fixed_hz`` is infinite where every message passes.
    """

    within: PacedPicture
    fixed: PacedPicture
    fixed_hz: float

    def to_json(self) -> dict[str, object]:
        """The entry in ``--json``; a rate that is infinite is null, as everywhere."""
        fixed_hz = None if math.isinf(self.fixed_hz) else self.fixed_hz
        return {**self.within.to_json(), "fixed": {"hz": fixed_hz, **self.fixed.to_json()}}


@dataclass(frozen=True, slots=True, kw_only=True)
class AccuracyPoint(JsonObject):
    """One bound, with a receiver that holds and with one that reckons, if what it shows can be reckoned."""

    bound: float
    hold: BoundCost
    reckoned: BoundCost | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Motion(JsonObject):
    """Speed of a property from message to message, of the part that moves most: |x′| per s.

    ``part`` is a child frame or a joint, or empty.
    """

    mean_per_s: float
    max_per_s: float
    part: str = ""

    @property
    def share(self) -> float | None:
        """Mean over maximum: what share of a fixed rate's messages a bound needs at best with hold."""
        return self.mean_per_s / self.max_per_s if self.max_per_s else None

    def to_json(self) -> dict[str, object]:
        """The entry in ``--json``."""
        return {
            "mean_per_s": self.mean_per_s,
            "max_per_s": self.max_per_s,
            "mean_over_max": self.share,
            "part": self.part,
        }


@dataclass(frozen=True, slots=True, kw_only=True)
class AccuracyCurve(JsonObject):
    """A property of a topic at some bounds, beside the ``messages`` of its source and their mean rate.

    ``source_hz`` is ``None`` where all of them have one stamp.
    """

    topic: str
    property_name: str
    unit: str
    messages: int
    source_hz: float | None
    motion: Motion
    points: tuple[AccuracyPoint, ...]

    def to_json(self) -> dict[str, object]:
        """The entry in ``--json``."""
        return {
            "topic": self.topic,
            "property": self.property_name,
            "unit": self.unit,
            "messages": self.messages,
            **self.motion.to_json(),
            "points": [point.to_json() for point in self.points],
        }


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
        source = _Source(samples[topic], [one.name for one in wanted[topic]])
        properties = [_Property(one, source) for one in wanted[topic]]
        for message in source.messages():
            for one in properties:
                one.measure_motion(message)
                one.send(message)
        for one in properties:
            one.turn_to_fixed_rates(end_ns)
        for message in source.messages():
            for one in properties:
                one.send(message)
        curves += (curve for one in properties if (curve := one.curve(end_ns)).motion.max_per_s)
        unreadable = len(samples[topic].track) - len(source.stamps_ns)
        if unreadable:
            unread = counted(unreadable, "message")
            notices.append(f"{topic}: {unread} could not be read and stand in no bound's figures")
    return tuple(curves), tuple(notices)


class _Source:
    """The messages of a topic that can be read, and their stamps and frames once they were."""

    def __init__(self, samples: TopicSamples, names: Collection[str]) -> None:
        self.topic, self.kind, self.track = samples.channel.topic, samples.kind, samples.track
        self.stamps_ns: list[int] = []
        self.frames: list[tuple[str, ...]] = []
        self._names = names

    def place(self, name: str) -> int:
        """Where in the readings of a message that of a property stands."""
        gauges = self.track.gauges(self._names)
        return next(number for number, gauge in enumerate(gauges) if name in gauge.distances)

    def messages(self) -> Iterator[Message]:
        """Read them, in one pass."""
        self.stamps_ns, self.frames = [], []
        for message in self.track.messages(self._names):
            if None not in message.readings:
                self.stamps_ns.append(message.stamp_ns)
                self.frames.append(message.frames)
                yield message


class _Property:
    """One property of a topic, sent by several strategies at once: within bounds, then at fixed rates."""

    def __init__(self, wanted: WantedProperty, source: _Source) -> None:
        self._wanted, self._source = wanted, source
        self._place = source.place(wanted.name)
        self._gauges = source.track.gauges([wanted.name])
        self.meter = MotionMeter(self._gauges[0].distances[wanted.name])
        # Fields that are read by decoding stay as they are, also for who reckons.
        self._can_reckon = not needs_decoded(self._gauges)
        receivers = (False, True) if self._can_reckon else (False,)
        self._arms = self._arms_of(
            Strategy(reckons=reckons, bound=bound) for reckons in receivers for bound in wanted.bounds
        )
        self._within: dict[Strategy, PacedPicture] = {}
        self._at_rate: dict[Strategy, Strategy] = {}

    def measure_motion(self, message: Message) -> None:
        """Take note of how the property changed."""
        self.meter.add(message.readings[self._place])

    def send(self, message: Message) -> None:
        """Send a message of the source by every strategy."""
        own = message._replace(readings=(message.readings[self._place],))
        for arm in self._arms.values():
            arm.send(own)

    def turn_to_fixed_rates(self, end_ns: int) -> None:
        """End with the bounds, and turn to the rates of as many messages."""
        source = self._source
        self._within = {strategy: arm.finish(end_ns) for strategy, arm in self._arms.items()}
        self._at_rate = {
            strategy: Strategy(
                reckons=strategy.reckons,
                rate_hz=rate_of_messages(
                    within.messages, source.stamps_ns, end_ns=end_ns, kind=source.kind, frames=source.frames
                ),
            )
            for strategy, within in self._within.items()
        }
        self._arms = self._arms_of(self._at_rate.values())

    def curve(self, end_ns: int) -> AccuracyCurve:
        """The costs of the bounds, once the source was sent at fixed rates, too."""
        fixed = {strategy: arm.finish(end_ns) for strategy, arm in self._arms.items()}

        def cost(bound: float, *, reckons: bool) -> BoundCost:
            strategy = Strategy(reckons=reckons, bound=bound)
            at_rate = self._at_rate[strategy]
            return BoundCost(within=self._within[strategy], fixed=fixed[at_rate], fixed_hz=at_rate.rate_hz)

        wanted, stamps_ns = self._wanted, self._source.stamps_ns
        return AccuracyCurve(
            topic=self._source.topic,
            property_name=wanted.name,
            unit=wanted.unit,
            messages=len(stamps_ns),
            source_hz=mean_hz(len(stamps_ns), stamps_ns[-1] - stamps_ns[0] if stamps_ns else 0),
            motion=self.meter.motion,
            points=tuple(
                AccuracyPoint(
                    bound=bound,
                    hold=cost(bound, reckons=False),
                    reckoned=cost(bound, reckons=True) if self._can_reckon else None,
                )
                for bound in wanted.bounds
            ),
        )

    def _arms_of(self, strategies: Iterable[Strategy]) -> dict[Strategy, Arm]:
        name, kind = self._wanted.name, self._source.kind
        return {
            strategy: Arm(Picture(self._gauges, reckons=strategy.reckons), name, kind, strategy)
            for strategy in strategies
        }


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
        step = distance(part.state, last.state)
        if elapsed_s <= 0 or last.frames != part.frames or not step < math.inf:
            return
        self.way += step
        self.lasted_s += elapsed_s
        self.max_per_s = max(self.max_per_s, step / elapsed_s)
