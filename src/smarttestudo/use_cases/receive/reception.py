# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What arrives of robots, put where it is wanted, and how it arrived."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from smarttestudo.adapters.zenoh.arrivals import LinkEvent, RobotPresence, StreamSaid
from smarttestudo.domain.link import ReceivedMessage, Sink, StreamInfo
from smarttestudo.domain.rate_meter import Flow, FlowMeter
from smarttestudo.domain.units import NS_PER_MS


@dataclass(slots=True)
class ReceivedTopic:
    """How one topic of a robot arrives: ``age_ms`` is that of its last message, as far as it is known."""

    type_name: str
    flow: Flow
    meter: FlowMeter
    age_ms: float | None = None


@dataclass(slots=True)
class ReceivedRobot:
    """What is known of a robot; ``boots`` are the runs of its end that are connected now."""

    boots: set[str] = field(default_factory=set)
    topics: dict[str, ReceivedTopic] = field(default_factory=dict)


class Reception:
    """Takes the events of the operator's end, in order, and gives what they bring to ``sinks``.

    Times are ns of a clock that never jumps.
    """

    def __init__(self, sinks: Sequence[Sink]) -> None:
        self.robots: dict[str, ReceivedRobot] = {}
        self._sinks = sinks

    def take(self, event: LinkEvent, now_ns: int) -> None:
        """Something arrived."""
        robot = event.robot
        known = self.robots.setdefault(robot, ReceivedRobot())
        match event:
            case RobotPresence(boot=boot, is_present=True):
                known.boots.add(boot)
            case RobotPresence(boot=boot):
                known.boots.discard(boot)
            case StreamSaid(info=StreamInfo() as stream):
                _topic(known, stream).type_name = stream.type_name
                for sink in self._sinks:
                    sink.open(robot, stream)
            case ReceivedMessage(stream=stream, age_ns=age_ns):
                topic = _topic(known, stream)
                topic.age_ms = None if age_ns is None else age_ns / NS_PER_MS
                topic.flow.record(now_ns, len(event.payload))
                for sink in self._sinks:
                    sink.take(event)

    def look(self, now_ns: int) -> None:
        """Measure the rates anew; to be called about once a second."""
        for robot in self.robots.values():
            for topic in robot.topics.values():
                topic.meter.look(now_ns)


def _topic(robot: ReceivedRobot, stream: StreamInfo) -> ReceivedTopic:
    topic = robot.topics.get(stream.topic)
    if topic is None:
        flow = Flow()
        topic = robot.topics[stream.topic] = ReceivedTopic(stream.type_name, flow, FlowMeter(flow))
    return topic
