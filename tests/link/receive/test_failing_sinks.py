# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Whatever a place fails of for a topic costs that topic there, is said once, shown, and is tried again."""

from __future__ import annotations

from dataclasses import replace

import pytest

from link.zenoh.ends import ODOM
from robot.small_graph import TEXT
from robot.test_failing_topics import ERRORS, FailingGraph
from smarttestudo.cli.receive import reception_lines
from smarttestudo.domain.errors import RosError
from smarttestudo.domain.link import ReceivedMessage, StreamInfo
from smarttestudo.domain.robot import Qos
from smarttestudo.link.receive.prediction import Predictor
from smarttestudo.link.receive.reception import Reception
from smarttestudo.link.zenoh.arrivals import LinkEvent, RobotPresence, StreamSaid
from smarttestudo.robot.ros.graph_sink import GraphSink

QOS = Qos(reliable=True, transient_local=False, depth=5)
BAD = StreamInfo(topic="/bad", type_name=TEXT, qos=QOS)
GOOD = replace(BAD, topic="/good")


class Place:
    """A sink of which one call fails of one topic."""

    def __init__(self, call: str, error: Exception) -> None:
        self.call = call
        self.error = error
        self.taken: list[str] = []

    def does(self, call: str, topic: str) -> None:
        if (call, topic) == (self.call, BAD.topic):
            raise self.error

    def open(self, robot: str, stream: StreamInfo) -> None:
        self.does("open", stream.topic)

    def write(self, message: ReceivedMessage) -> str | None:
        self.does("write", message.stream.topic)
        self.taken.append(message.stream.topic)
        return str(self.error) if (self.call, message.stream.topic) == ("open", BAD.topic) else None

    def forget(self, robot: str, stream: StreamInfo) -> None:
        self.does("forget", stream.topic)

    def close(self) -> None: ...


def message(stream: StreamInfo) -> ReceivedMessage:
    return ReceivedMessage(robot="ada", stream=stream, payload=b"x", offered_ns=1, age_ns=0, boot="0")


def says(info: StreamInfo | None, number: int) -> StreamSaid:
    return StreamSaid(robot="ada", boot="0", number=number, info=info)


def send(reception: Reception) -> None:
    for stream in (BAD, GOOD):
        reception.handle(message(stream), 0)


def appear(reception: Reception, qos: Qos = QOS) -> None:
    reception.handle(RobotPresence(robot="ada", boot="0", is_present=True), 0)
    for number, stream in enumerate((BAD, GOOD)):
        reception.handle(says(replace(stream, qos=qos), number), 0)


def disappear(reception: Reception) -> None:
    for number in range(2):
        reception.handle(says(None, number), 0)


@pytest.mark.parametrize("call", ["open", "write", "forget"])
@pytest.mark.parametrize("error", ERRORS, ids=repr)
def test_a_sink_that_fails_of_a_topic_costs_it_there_alone(call: str, error: Exception) -> None:
    failing, other, said = Place(call, error), Place("", error), list[str]()
    reception = Reception([failing, other], warn=said.append)
    for _ in range(3):
        appear(reception)
        send(reception)
        disappear(reception)
    assert failing.taken.count("/good") == 3
    assert other.taken == ["/bad", "/good"] * 3
    (line,) = said
    assert "/bad" in line


@pytest.mark.parametrize("call", ["open", "write"])
def test_what_fails_is_the_topic_s_state_until_it_works(call: str) -> None:
    failing = Place(call, RosError("it cannot be", place="/bad"))
    reception = Reception([failing])
    appear(reception)
    send(reception)
    lines = {line.text.split()[0]: line.text for line in reception_lines(reception) if line.text}
    assert lines["/bad"].rstrip().endswith("it cannot be")
    assert lines["/good"].rstrip().endswith(TEXT)
    failing.call = ""
    appear(reception)
    send(reception)
    assert all("it cannot be" not in line.text for line in reception_lines(reception))


@pytest.mark.parametrize("call", ["advertise", "publish", "close publisher"])
@pytest.mark.parametrize("error", ERRORS, ids=repr)
def test_what_the_middleware_refuses_of_a_topic_is_said_once_and_tried_again(
    call: str, error: Exception
) -> None:
    graph, said = FailingGraph(), list[str]()
    reception = Reception([GraphSink(graph, said.append)], warn=said.append)
    appear(reception)
    graph.call, graph.error = call, error
    other = replace(QOS, reliable=False)
    for qos in (other, QOS, other):
        appear(reception, qos)
        send(reception)
    assert [topic for topic, _ in graph.published if topic == "/good"] == ["/good"] * 3
    (line,) = said
    assert "/bad" in line
    if call != "close publisher":
        assert reception.robots["ada"].topics["/bad"].problem is not None
    graph.call = ""
    appear(reception, QOS)
    send(reception)
    assert [topic for topic, _ in graph.published[-2:]] == ["/bad", "/good"]
    assert reception.robots["ada"].topics["/bad"].problem is None


def test_a_name_that_another_type_had_is_taken_when_that_is_gone() -> None:
    class OneType(FailingGraph):
        """As Fast DDS, which has one type of a topic in a process."""

        def does(self, call: str, topic: str) -> None:
            if call == "advertise" and len({one.type_name for one in self.advertised}) > 0:
                raise RosError("it has another type", place=topic)

    graph, said = OneType(), list[str]()
    sink = GraphSink(graph, said.append)
    sink.open("ada", BAD)
    sink.open("bob", BAD)
    sink.forget("ada", BAD)
    sink.write(replace(message(BAD), robot="bob"))
    assert graph.published == [("/bad", b"x")]


@pytest.mark.parametrize(
    ("letters", "pattern"), [(248, "{topic}"), (245, "/{robot}{topic}"), (247, "/{robot}{topic}")]
)
def test_a_name_that_is_longer_than_ros_takes_costs_that_topic(letters: int, pattern: str) -> None:
    graph, said = FailingGraph(), list[str]()
    reception = Reception([GraphSink(graph, said.append, pattern=pattern)], warn=said.append)
    long = replace(GOOD, topic="/" + "a" * (letters - 1))
    appear(reception)
    for _ in range(2):
        reception.handle(says(long, 5), 0)
        reception.handle(message(long), 0)
        send(reception)
    assert len(graph.published) == 4
    (line,) = said
    assert "ROS 2 takes 247" in line
    assert reception.robots["ada"].topics[long.topic].problem is not None


@pytest.mark.parametrize("error", ERRORS, ids=repr)
def test_a_predictor_that_fails_costs_no_message(error: Exception) -> None:
    class Failing(Predictor):
        def handle(self, event: LinkEvent, now_ns: int) -> None:
            raise error

    said: list[str] = []
    place = Place("", error)
    reception = Reception([place], Failing(frozenset(), lambda *_: None, said.append), said.append)
    reception.handle(says(ODOM, 1), 0)
    for _ in range(2):
        reception.handle(message(ODOM), 0)
    assert place.taken == ["/odom"] * 2
    assert len(said) == 1
