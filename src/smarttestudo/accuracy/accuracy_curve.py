# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How many messages an accuracy needs, under bounds and at fixed rates."""

from __future__ import annotations

import math
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

from smarttestudo.accuracy.error_over_time import ErrorOverTime
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.pacing.bound import HEARTBEAT_HZ, BoundRecord
from smarttestudo.pacing.reckoning.gauges import Distance, Gauge, MovingPart, Reading
from smarttestudo.pacing.reckoning.picture import MAX_PARTS, Picture
from smarttestudo.pacing.sample import Pass, Sample, StreamKind
from smarttestudo.pacing.topic_pacer import Accuracy, TopicPacer

_SMALL_BOUNDS = (0.01, 0.02, 0.05, 0.1, 0.2)
_BOUNDS_BY_UNIT: Mapping[str, tuple[float, ...]] = MappingProxyType(
    {"m": _SMALL_BOUNDS, "rad": _SMALL_BOUNDS, "°": (1.0, 2.0, 5.0, 10.0, 20.0)}
)


def usual_bounds(unit: str, value_range: float | None) -> tuple[float, ...]:
    """1, 2, 5, 10 and 20 cm, hundredths of a rad, degrees, or percent of ``value_range``."""
    if unit in _BOUNDS_BY_UNIT:
        return _BOUNDS_BY_UNIT[unit]
    return tuple(share * value_range for share in _SMALL_BOUNDS) if value_range else ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Paced:
    """A way to send a topic: within ``bound`` of a property, or at a fixed ``rate_hz``.

    With ``reckons`` the receiver shows dead reckoning, else it holds the last message.
    """

    reckons: bool
    bound: float | None = None
    rate_hz: float = math.inf


@dataclass(frozen=True, slots=True, kw_only=True)
class PacedPicture:
    """What passed, and how far the receiver's picture was off after each message of the source.

    ``rmse`` is over time, ``worst`` is the largest error, both without the ``unknown`` messages after which
    nothing was shown.
    """

    messages: int
    rmse: float
    worst: float
    unknown: int

    def to_json(self) -> dict[str, object]:
        """The entry in ``--json``."""
        return {
            "messages": self.messages,
            "rmse": self.rmse,
            "worst": self.worst,
            "unknown": self.unknown,
        }


@dataclass(frozen=True, slots=True, kw_only=True)
class BoundPrice:
    """What a bound costs and gives, and beside it the fixed rate of as many messages.

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
class AccuracyPoint:
    """One bound, with a receiver that holds and with one that reckons, if what it shows can be reckoned."""

    bound: float
    hold: BoundPrice
    reckoned: BoundPrice | None

    def to_json(self) -> dict[str, object]:
        """The entry in ``--json``."""
        reckoned = self.reckoned.to_json() if self.reckoned else None
        return {"bound": self.bound, "hold": self.hold.to_json(), "reckoned": reckoned}


@dataclass(frozen=True, slots=True, kw_only=True)
class Motion:
    """How fast a property changes from message to message, of the part that moves most: |x′| per s.

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
class AccuracyCurve:
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


class AccuracyMeter:
    """Sends one property of a topic in several ways at once, and measures each receiver's picture."""

    def __init__(self, gauges: Sequence[Gauge], name: str, kind: StreamKind, ways: Sequence[Paced]) -> None:
        self._name = name
        self._arms = [_Arm(gauges, name, kind, way) for way in ways]

    def take(self, readings: tuple[Reading | None, ...], frames: tuple[str, ...], now_ns: int) -> None:
        """The source sent a message, which was read."""
        sample = Sample(b"", 0, None, frames, None, readings)
        for arm in self._arms:
            arm.take(sample, now_ns)

    def finish(self, end_ns: int) -> list[PacedPicture]:
        """The recording ends: what was found, in the order of the ways."""
        return [arm.finish(end_ns) for arm in self._arms]


class _Arm:
    """One way to send the topic, with its receiver."""

    __slots__ = ("_error", "_kept", "_messages", "_name", "_pacer", "_picture", "_way")

    def __init__(self, gauges: Sequence[Gauge], name: str, kind: StreamKind, way: Paced) -> None:
        self._name, self._way = name, way
        self._pacer = TopicPacer(kind=kind)
        self._picture = Picture(gauges, reckons=way.reckons)
        self._kept: dict[str, BoundRecord] = {}
        self._messages = 0
        self._error: ErrorOverTime | None = None

    def take(self, sample: Sample, now_ns: int) -> None:
        if self._error is None:
            self._error = ErrorOverTime(now_ns)
            self._start(now_ns)
        self._wake_until(now_ns)
        passes = self._pacer.offer(sample, now_ns)
        self._pass(passes)
        self._error.add(self._error_after(sample, passes), now_ns)

    def _error_after(self, sample: Sample, passes: Sequence[Pass]) -> float:
        """How far off the picture is; a pacer with bounds keeps it itself, and has compared already."""
        if self._way.bound is not None:
            return self._kept[self._name].last
        if any(one.sample is sample for one in passes):
            return 0.0
        return self._picture.errors(sample.readings, sample.publisher)[self._name]

    def finish(self, end_ns: int) -> PacedPicture:
        self._pacer.finish()
        self._wake_until(end_ns)
        error = self._error or ErrorOverTime(end_ns)
        error.pass_time(end_ns)
        return PacedPicture(
            messages=self._messages, rmse=error.rmse, worst=error.worst, unknown=error.unknown
        )

    def _start(self, now_ns: int) -> None:
        way = self._way
        self._pacer.set_rate(way.rate_hz, now_ns)
        if way.bound is not None:
            accuracy = Accuracy(
                picture=self._picture,
                bounds={self._name: way.bound},
                heartbeat_hz=HEARTBEAT_HZ,
                records=self._kept,
            )
            self._pacer.set_accuracy(accuracy, now_ns)

    def _wake_until(self, now_ns: int) -> None:
        for _, passes in self._pacer.wake_until(now_ns):
            self._pass(passes)

    def _pass(self, passes: Sequence[Pass]) -> None:
        self._messages += len(passes)
        if self._way.bound is None:
            for sample, _ in passes:
                self._picture.show(sample.readings, sample.publisher)


class MotionMeter:
    """Measures how fast one property changes, each part on its own."""

    def __init__(self, gauges: Sequence[Gauge], name: str) -> None:
        ((self._index, self._distance),) = [
            (index, gauge.distances[name]) for index, gauge in enumerate(gauges) if name in gauge.distances
        ]
        self._parts: dict[Hashable, _Travel] = {}

    def take(self, readings: tuple[Reading | None, ...]) -> None:
        """The source sent a message, which was read."""
        for part in readings[self._index] or ():
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
    """How far a part moved, along its way, in the time between its first and last message."""

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
