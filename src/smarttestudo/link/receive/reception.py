# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Messages of robots, put where they are wanted, and how they arrived."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import field

from smarttestudo.domain.dataclass import dataclass
from smarttestudo.domain.link import ReceivedMessage, Sink, StreamInfo
from smarttestudo.domain.rate_meter import Flow, FlowMeter
from smarttestudo.domain.units import NS_PER_MS
from smarttestudo.link.receive.prediction import Predictor
from smarttestudo.link.zenoh.arrivals import LinkEvent, RobotPresence, StreamSaid


@dataclass(slots=True)
class ReceivedTopic:
    """How one topic of a robot arrives: ``age_ms`` is that of its last message, as far as it is known.

    ``predicted`` messages were made here; they count as nothing else.
    """

    type_name: str
    flow: Flow
    meter: FlowMeter
    age_ms: float | None = None
    predicted: int = 0


@dataclass(slots=True)
class ReceivedRobot:
    """One robot; ``boots`` are the runs of its end that are connected now.

    ``streams`` are those that it has, by run and number; those of a run that left stay while there is no
    other, as it may come back.
    """

    boots: set[str] = field(default_factory=set)
    streams: dict[tuple[str, int], StreamInfo] = field(default_factory=dict)
    topics: dict[str, ReceivedTopic] = field(default_factory=dict)


class Reception:
    """Takes the events of the operator's end, in order, and gives what they bring to ``sinks``.

    Where there is a ``predictor``, so is what it makes of them. Times are ns of a clock that never jumps.
    """

    def __init__(self, sinks: Sequence[Sink], predictor: Predictor | None = None) -> None:
        self.robots: dict[str, ReceivedRobot] = {}
        self._sinks = sinks
        self._predictor = predictor

    def handle(self, event: LinkEvent, now_ns: int) -> None:
        """Something arrived."""
        robot = event.robot
        known = self.robots.setdefault(robot, ReceivedRobot())
        match event:
            case RobotPresence(boot=boot, is_present=is_present):
                (known.boots.add if is_present else known.boots.discard)(boot)
                self._forget_earlier(robot)
            case StreamSaid(boot=boot, number=number, info=info):
                self._follow(robot, (boot, number), info)
            case ReceivedMessage(stream=stream, age_ns=age_ns):
                topic = _topic(known, stream)
                topic.age_ms = None if age_ns is None else age_ns / NS_PER_MS
                topic.flow.record(now_ns, len(event.payload))
                for sink in self._sinks:
                    sink.write(event)
        if self._predictor is not None:
            self._predictor.handle(event, now_ns)

    def predict(self, now_ns: int) -> int | None:
        """Give ``sinks`` what is predicted and due; when there is more."""
        if self._predictor is None:
            return None
        for message in self._predictor.predicted(now_ns):
            _topic(self.robots[message.robot], message.stream).predicted += 1
            for sink in self._sinks:
                sink.write(message)
        return self._predictor.due_ns

    def _follow(self, robot: str, key: tuple[str, int], info: StreamInfo | None) -> None:
        """A robot has a stream, or has it no more."""
        known = self.robots[robot]
        before = known.streams.pop(key, None)
        if info is not None:
            known.streams[key] = info
        if before is not None and not any(_is_of_publisher(one, before) for one in known.streams.values()):
            for sink in self._sinks:
                sink.forget(robot, before)
        if info is not None:
            _topic(known, info).type_name = info.type_name
            for sink in self._sinks:
                sink.open(robot, info)

    def _forget_earlier(self, robot: str) -> None:
        """Where a run of a robot's end is there, those that are gone do not come back."""
        known = self.robots[robot]
        if known.boots:
            for key in [key for key in known.streams if key[0] not in known.boots]:
                self._follow(robot, key, None)

    def measure(self, now_ns: int) -> None:
        """Measure the rates anew; to be called about once a second."""
        for robot in self.robots.values():
            for topic in robot.topics.values():
                topic.meter.measure(now_ns)


def _is_of_publisher(one: StreamInfo, other: StreamInfo) -> bool:
    """Whether both are the same publisher of the same topic."""
    return (one.topic, one.publisher) == (other.topic, other.publisher)


def _topic(robot: ReceivedRobot, stream: StreamInfo) -> ReceivedTopic:
    topic = robot.topics.get(stream.topic)
    if topic is None:
        flow = Flow()
        topic = robot.topics[stream.topic] = ReceivedTopic(stream.type_name, flow, FlowMeter(flow))
    return topic
