# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Robots' topics between two messages, by dead reckoning."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from typing import NamedTuple

from smarttestudo.domain.link import Prediction, ReceivedMessage, StreamInfo
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.language.properties import gauges_for, properties_for_bounds
from smarttestudo.link.zenoh.arrivals import LinkEvent, RobotPresence, StreamSaid
from smarttestudo.pacing.reckoning.estimate import Estimate, silent_after_ns
from smarttestudo.pacing.reckoning.gauges import can_be_reckoned

SOURCE_HZ = 10.0
"""The rate of a source while the robot has not told one of ``LEAST_HZ``."""
LEAST_HZ = 0.01
MOST_HZ = 100.0
"""Faster sources are predicted so often."""

SourceHz = Callable[[str, str], float | None]
"""The rate of the source of a robot's topic, by the names of both; ``None`` while it is not known."""


class _Source(NamedTuple):
    """A publisher of a topic, as a run of the robot's end numbers them."""

    boot: str
    publisher: int


@dataclass(slots=True, kw_only=True, eq=False)
class _Arrived:
    """A message that left the robot's loop at ``at_ns``, and when to predict from it next."""

    message: ReceivedMessage
    at_ns: int
    due_ns: int


@dataclass(slots=True)
class _Topic:
    """A topic of a robot; ``predictions`` are those that the robot's end keeps, by publisher.

    Nothing is predicted before ``due_ns``, at no time where there is none.
    """

    type_name: str
    estimate: Estimate
    predictions: dict[_Source, Prediction | None] = field(default_factory=dict)
    due_ns: int | None = None


class Predictor:
    """Reckons ``topics``, by the robots' names, where the robot's end says that it does so too.

    Its estimate is made of the same messages in the same order as the robot's, by the same function, and
    forgets where the robot's does. What cannot be reckoned is held at both ends, which ``warn`` is told once
    a topic. Times are ns of a clock that never jumps.
    """

    def __init__(self, topics: frozenset[str], source_hz: SourceHz, warn: Callable[[str], None]) -> None:
        self._names = topics
        self._source_hz = source_hz
        self._warn = warn
        self._topics: dict[tuple[str, str], _Topic] = {}
        self._streams: dict[tuple[str, str, int], StreamInfo] = {}
        self._absent: set[tuple[str, str]] = set()
        self._said: set[tuple[str, str]] = set()

    def handle(self, event: LinkEvent, now_ns: int) -> None:
        match event:
            case RobotPresence(robot=robot, boot=boot, is_present=True):
                self._absent.discard((robot, boot))
                self._forget_earlier(robot)
                for known in self._topics.values():
                    known.due_ns = 0
            case RobotPresence(robot=robot, boot=boot):
                # It may come back, and go on as before.
                self._absent.add((robot, boot))
            case StreamSaid(robot=robot, boot=boot, number=number, info=info):
                self._follow(robot, boot, number, info)
            case ReceivedMessage(robot=robot, stream=stream):
                topic = self._topics.get((robot, stream.topic))
                if topic is not None:
                    self._show(topic, event, now_ns)

    @property
    def due_ns(self) -> int | None:
        """When ``predicted`` may have something."""
        due_ns = (topic.due_ns for topic in self._topics.values())
        return min((at_ns for at_ns in due_ns if at_ns is not None), default=None)

    def predicted(self, now_ns: int) -> Iterator[ReceivedMessage]:
        """The messages that are due, at the time at which the robot is now."""
        for (robot, name), topic in self._topics.items():
            if topic.due_ns is None or now_ns < topic.due_ns:
                continue
            topic.due_ns = None
            period_ns = self._period_ns(robot, name)
            for arrived, parts in topic.estimate.moving().items():
                assert isinstance(arrived, _Arrived)
                message, elapsed_ns = arrived.message, now_ns - arrived.at_ns
                prediction = topic.predictions.get(_source_of(message))
                if prediction is None or (robot, message.boot) in self._absent:
                    continue
                if elapsed_ns > silent_after_ns(prediction.heartbeat_hz):
                    continue
                if now_ns >= arrived.due_ns:
                    arrived.due_ns = now_ns + period_ns
                    payload = topic.estimate.written(message.payload, parts, elapsed_ns, prediction.within)
                    if payload is not None:
                        yield replace(message, payload=payload, age_ns=0, is_predicted=True)
                topic.due_ns = _earlier(topic.due_ns, arrived.due_ns)

    def _follow(self, robot: str, boot: str, number: int, info: StreamInfo | None) -> None:
        """A robot has a stream, or has it no more: nothing of its publisher is predicted then."""
        key = (robot, boot, number)
        before = self._streams.pop(key, None)
        if before is not None and (info is None or replace(info, prediction=before.prediction) != before):
            closed = self._topics[robot, before.topic]
            closed.predictions.pop(_Source(boot, before.publisher), None)
        if info is None or info.topic not in self._names:
            return
        properties = [spec.name for spec in properties_for_bounds().get(info.type_name, ())]
        if not properties:
            return
        topic = self._topics.get((robot, info.topic))
        if topic is None or topic.type_name != info.type_name:
            estimate = Estimate(gauges_for(info.type_name, properties), reckons=True)
            topic = self._topics[robot, info.topic] = _Topic(info.type_name, estimate)
        self._streams[key] = info
        topic.predictions[_Source(boot, info.publisher)] = info.prediction
        if info.prediction is not None:
            topic.estimate.expect_heartbeat(info.prediction.heartbeat_hz)
            topic.due_ns = 0

    def _forget_earlier(self, robot: str) -> None:
        """A robot is there: the runs of its end that are gone do not come back."""
        for key in [key for key in self._streams if key[:2] in self._absent and key[0] == robot]:
            self._follow(*key, None)
        self._absent = {absent for absent in self._absent if absent[0] != robot}

    def _show(self, topic: _Topic, message: ReceivedMessage, now_ns: int) -> None:
        source = _source_of(message)
        if source not in topic.predictions:
            return
        if message.begins_anew:
            topic.estimate.forget_publisher(source)
        robot, name = message.robot, message.stream.topic
        readings = topic.estimate.read(message.payload, None, now_ns)
        due_ns = now_ns + self._period_ns(robot, name)
        arrived = _Arrived(message=message, at_ns=now_ns - (message.age_ns or 0), due_ns=due_ns)
        topic.estimate.show(readings, source, arrived)
        topic.due_ns = _earlier(topic.due_ns, due_ns)
        if topic.predictions[source] and readings[0] and not can_be_reckoned(readings[0]):
            self._say_held(robot, name)

    def _say_held(self, robot: str, topic: str) -> None:
        if (robot, topic) not in self._said:
            self._said.add((robot, topic))
            self._warn(
                f"{topic} of {robot} is not predicted: its messages do not say when the robot is there, as "
                "their stamp is 0; the last one is shown, and more are sent; have its node set the stamp"
            )

    def _period_ns(self, robot: str, topic: str) -> int:
        declared_hz = self._source_hz(robot, topic)
        # A stranger's number may be NaN, which is not at least anything.
        source_hz = declared_hz if declared_hz is not None and declared_hz >= LEAST_HZ else SOURCE_HZ
        return round(NS_PER_S / min(source_hz, MOST_HZ))


def _earlier(due_ns: int | None, other_ns: int) -> int:
    return other_ns if due_ns is None else min(due_ns, other_ns)


def _source_of(message: ReceivedMessage) -> _Source:
    return _Source(message.boot, message.stream.publisher)
