# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What arrives over a link, on a real ROS graph, and what is said where it cannot be there."""

from __future__ import annotations

import time
from collections.abc import Iterator

import pytest

from robot.small_graph import TEXT, SmallGraph
from ros.ros_processes import LINE_TIMEOUT_S, SmallRobot
from smarttestudo.domain.errors import UsageError
from smarttestudo.domain.link import ReceivedMessage, StreamInfo
from smarttestudo.domain.robot import DataPathKind, Qos, Robot
from smarttestudo.robot.ros import open_robot
from smarttestudo.robot.ros.graph_sink import MAX_DEPTH, GraphSink

pytestmark = pytest.mark.contract

EMPTY = "std_msgs/msg/Empty"
BEST_EFFORT = Qos(reliable=False, transient_local=False, depth=5)
LATCHED = Qos(reliable=True, transient_local=True, depth=1)


@pytest.fixture(params=[DataPathKind.RCL, DataPathKind.RCLPY], ids=lambda kind: kind.value)
def node(request: pytest.FixtureRequest, in_domain: None) -> Iterator[Robot]:
    with open_robot(data_path=request.param) as opened:
        yield opened


def text(content: str) -> bytes:
    """A std_msgs/String as CDR."""
    data = content.encode() + b"\x00"
    return b"\x00\x01\x00\x00" + len(data).to_bytes(4, "little") + data


def stream(topic: str, type_name: str = TEXT, qos: Qos = BEST_EFFORT, publisher: int = 0) -> StreamInfo:
    return StreamInfo(topic=topic, type_name=type_name, qos=qos, publisher=publisher)


def take(sink: GraphSink, of: StreamInfo, payload: bytes, robot: str = "ada") -> None:
    sink.write(ReceivedMessage(robot=robot, stream=of, payload=payload, offered_ns=1, age_ns=None))


def types_and_qos(node: Robot, topic: str, publishers: int) -> set[tuple[str, bool, bool]]:
    """Of all publishers of the topic, once there are so many of them."""
    end_s = time.monotonic() + LINE_TIMEOUT_S
    while len(found := node.publishers(topic)) != publishers:
        assert time.monotonic() < end_s, f"{topic} has {len(found)} publishers"
        node.wait(None, 0.1)
    return {(one.type_name, one.reliable, one.transient_local) for one in found}


def test_a_late_subscriber_gets_what_each_publisher_of_the_robot_latched(
    node: Robot, robot: SmallRobot
) -> None:
    sink = GraphSink(node.data_path, pytest.fail)
    for publisher, names in enumerate((["hall"], ["old yard", "yard"])):
        of = stream("/names", qos=LATCHED, publisher=publisher)
        sink.open("ada", of)
        for name in names:
            take(sink, of, text(name))
        sink.open("ada", of)
    operator = robot.operator(names={"type": TEXT, "topic": "/names", "transient_local": True, "messages": 2})
    operator.line_with("heard")
    assert {value for _, value, _ in operator.result()["names"]} == {"hall", "yard"}
    sink.close()


def test_streams_have_the_types_and_qos_of_the_robot_and_follow_when_they_change(node: Robot) -> None:
    sink = GraphSink(node.data_path, pytest.fail, pattern="/{robot}{topic}")
    sink.open("ada", stream("/latched", qos=LATCHED))
    sink.open("ada", stream("/changing"))
    assert types_and_qos(node, "/ada/latched", 1) == {(TEXT, True, True)}
    assert types_and_qos(node, "/ada/changing", 1) == {(TEXT, False, False)}
    sink.open("ada", stream("/changing", EMPTY, LATCHED))
    take(sink, stream("/changing", EMPTY, LATCHED), b"\x00\x01\x00\x00\x00")
    assert types_and_qos(node, "/ada/changing", 1) == {(EMPTY, True, True)}
    sink.close()
    assert types_and_qos(node, "/ada/changing", 0) == set()


def test_a_type_that_is_not_installed_costs_its_stream_only_and_is_said_once(node: Robot) -> None:
    said: list[str] = []
    sink = GraphSink(node.data_path, said.append)
    strange = stream("/strange", "acme_msgs/msg/Odd")
    for publisher in range(2):
        sink.open("ada", stream("/strange", "acme_msgs/msg/Odd", publisher=publisher))
        take(sink, strange, b"\x00\x01\x00\x00\x00")
    sink.open("ada", stream("/known"))
    take(sink, stream("/known"), text("x"))
    types_and_qos(node, "/known", 1)
    sink.close()
    (line,) = said
    assert line == (
        "/strange: error: the message type acme_msgs/msg/Odd is not installed; "
        "install the ROS package acme_msgs, or source the workspace that holds it"
    )


def test_two_robots_with_the_same_names_are_told_how_to_tell_them_apart() -> None:
    graph, said = SmallGraph(), list[str]()
    sink = GraphSink(graph, said.append)
    for robot in ("ada", "bob", "bob"):
        for topic in ("/odom", "/scan"):
            sink.open(robot, stream(topic))
            take(sink, stream(topic), text(robot), robot)
    assert said == [
        "the topics of ada and bob have the same names here; "
        "tell them apart with --output-topic '/{robot}{topic}'"
    ]
    assert len(graph.published) == 6


@pytest.mark.parametrize("pattern", ["/all", "{topic", "/{robot}/{other}{topic}", "relative{topic}"])
def test_a_pattern_that_makes_no_names_is_refused_before_anything_arrives(pattern: str) -> None:
    with pytest.raises(UsageError, match="--output-topic"):
        GraphSink(SmallGraph(), pytest.fail, pattern=pattern)


def test_a_robot_whose_name_makes_no_topic_is_named_and_costs_no_other() -> None:
    graph, said = SmallGraph(), list[str]()
    sink = GraphSink(graph, said.append, pattern="/{robot}{topic}")
    for robot in ("robot 1", "ada"):
        sink.open(robot, stream("/odom"))
        take(sink, stream("/odom"), text(robot), robot)
    assert graph.published == [("/ada/odom", text("ada"))]
    assert len(said) == 1
    assert "'/robot 1/odom' is not a valid ROS 2 topic name" in said[0]


@pytest.mark.parametrize(("announced", "depth"), [(-1, 1), (0, 1), (7, 7), (10**30, MAX_DEPTH)])
def test_whatever_depth_a_robot_announces_memory_is_bounded(announced: int, depth: int) -> None:
    graph = SmallGraph()
    sink = GraphSink(graph, pytest.fail)
    sink.open("ada", stream("/odom", qos=Qos(reliable=True, transient_local=True, depth=announced)))
    assert [publisher.qos.depth for publisher in graph.advertised] == [depth]


def test_what_is_predicted_comes_from_a_publisher_of_its_own() -> None:
    graph, said = SmallGraph(), list[str]()
    sink = GraphSink(graph, said.append)
    notes = stream("/notes")
    sink.open("ada", notes)
    for content, is_predicted in (("arrived", False), ("made here", True), ("arrived too", False)):
        message = ReceivedMessage(
            robot="ada",
            stream=notes,
            payload=text(content),
            offered_ns=1,
            age_ns=None,
            is_predicted=is_predicted,
        )
        sink.write(message)
    assert [list(one.kept) for one in graph.advertised] == [
        [text("arrived"), text("arrived too")],
        [text("made here")],
    ]
    sink.close()
    assert (graph.advertised, said) == ([], [])
