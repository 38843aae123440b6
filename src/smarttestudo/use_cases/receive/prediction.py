# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What robots' topics are between two messages, by dead reckoning."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator
from dataclasses import dataclass, field, replace

from smarttestudo.adirf.properties import gauges_for, properties_for_bounds
from smarttestudo.domain.link import Prediction, ReceivedMessage, StreamInfo
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.reckoning.picture import Picture

SOURCE_HZ = 10.0
"""What counts for a source's rate while the robot has not told it."""
MOST_HZ = 100.0
"""Faster sources are predicted so often."""
MISSED_HEARTBEATS = 2
"""After so many there is nothing to predict from: the source, or the link, is silent."""
MOST_TEMPLATES = 64

SourceHz = Callable[[str, str], float | None]
"""The rate of the source of a robot's topic, by the names of both; ``None`` while it is not known."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Template:
    """A message that arrived; the robot is where it says at ``stamp_ns``, which was ``age_ns`` before."""

    message: ReceivedMessage
    stamp_ns: int
    arrived_ns: int


@dataclass(slots=True)
class _Stream:
    """``templates`` has the last message of each set of parts."""

    picture: Picture
    prediction: Prediction | None = None
    templates: dict[Hashable, _Template] = field(default_factory=dict)
    due_ns: int = 0


class Predictor:
    """Reckons ``topics``, by the robots' names, where the robot's end says that it does so too.

    Its picture is made of the same messages in the same order as the robot's, by the same function, and
    forgets where the robot's does. Times are ns of a clock that never jumps.
    """

    def __init__(self, topics: frozenset[str], source_hz: SourceHz) -> None:
        self._topics = topics
        self._source_hz = source_hz
        self._streams: dict[tuple[str, str, int], _Stream] = {}

    def open(self, robot: str, stream: StreamInfo) -> None:
        """A robot has this stream."""
        if stream.topic not in self._topics:
            return
        properties = [spec.name for spec in properties_for_bounds().get(stream.type_name, ())]
        if not properties:
            return
        key = (robot, stream.topic, stream.publisher)
        known = self._streams.get(key)
        if known is None:
            picture = Picture(gauges_for(stream.type_name, properties), reckons=True)
            known = self._streams[key] = _Stream(picture)
        known.prediction = stream.prediction

    def take(self, message: ReceivedMessage, now_ns: int) -> None:
        """A message arrived."""
        known = self._streams.get((message.robot, message.stream.topic, message.stream.publisher))
        if known is None:
            return
        if message.begins_anew:
            known.picture.forget()
            known.templates.clear()
        # Without a stamp of its own, a message does not say when the robot is there.
        readings = known.picture.read(message.payload, None, 0)
        known.picture.show(readings, None)
        parts = readings[0] or ()
        names = tuple(part.name for part in parts)
        stamps_ns = [part.at_ns for part in parts]
        known.templates.pop(names, None)
        if stamps_ns and min(stamps_ns) > 0 and len(known.templates) < MOST_TEMPLATES:
            arrived_ns = now_ns - (message.age_ns or 0)
            template = _Template(message=message, stamp_ns=max(stamps_ns), arrived_ns=arrived_ns)
            known.templates[names] = template
        known.due_ns = now_ns + self._period_ns(message.robot, message.stream.topic)

    def leave(self, robot: str) -> None:
        """A robot is gone: nothing of it is predicted until something of it comes."""
        for (name, _, _), stream in self._streams.items():
            if name == robot:
                stream.templates.clear()

    @property
    def due_ns(self) -> int | None:
        """When ``predicted`` may have something."""
        return min((one.due_ns for one in self._streams.values() if one.prediction), default=None)

    def predicted(self, now_ns: int) -> Iterator[ReceivedMessage]:
        """What is due, at the time at which the robot is now."""
        for (robot, topic, _), stream in self._streams.items():
            prediction = stream.prediction
            if prediction is None or now_ns < stream.due_ns:
                continue
            stream.due_ns = now_ns + self._period_ns(robot, topic)
            silent_ns = MISSED_HEARTBEATS * NS_PER_S / prediction.heartbeat_hz
            for template in stream.templates.values():
                elapsed_ns = now_ns - template.arrived_ns
                if elapsed_ns > silent_ns:
                    continue
                at_ns = template.stamp_ns + elapsed_ns
                message = template.message
                payload = stream.picture.reckoned(message.payload, None, at_ns, prediction.within)
                if payload is not None:
                    yield replace(message, payload=payload, age_ns=0, is_predicted=True)

    def _period_ns(self, robot: str, topic: str) -> int:
        return round(NS_PER_S / min(self._source_hz(robot, topic) or SOURCE_HZ, MOST_HZ))
