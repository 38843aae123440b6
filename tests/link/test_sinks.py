# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What every place that takes what arrives over a link promises."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Protocol

import pytest

from bags.bag_factory import CUSTOM_DEFINITION, CUSTOM_TYPE, START_NS, cdr, message_of, odometry
from link.foxglove.foxglove_client import foxglove_client
from robot.small_graph import SmallGraph
from smarttestudo.bags.reader import open_recording
from smarttestudo.bags.recording_sink import RecordingSink
from smarttestudo.domain import link
from smarttestudo.domain.link import ReceivedMessage, StreamInfo
from smarttestudo.domain.robot import Qos
from smarttestudo.link.foxglove import open_foxglove_sink
from smarttestudo.robot.ros.graph_sink import GraphSink

LATCHED = Qos(reliable=True, transient_local=True, depth=50)
ODOM = StreamInfo(topic="/odom", type_name="nav_msgs/msg/Odometry", qos=LATCHED)
GRIPPER = StreamInfo(topic="/gripper", type_name=CUSTOM_TYPE, qos=LATCHED, definition=CUSTOM_DEFINITION)
CHANGED = StreamInfo(topic="/odom", type_name=CUSTOM_TYPE, qos=LATCHED, definition=CUSTOM_DEFINITION)
UNKNOWN = "acme_msgs/msg/Odd"
HELD = cdr(CUSTOM_TYPE, message_of(CUSTOM_TYPE, opening=0.5, holds=True))
NO_DEFINITIONS = ["", "nothing ((", "float64", f"{'=' * 80}\nIDL: x\nmodule {{", "acme_msgs/Odd odd\n", "\0"]

Sent = tuple[str, str, bytes]
"""Topic, type and payload."""


class Place(Protocol):
    """A sink, and what others see of it."""

    @property
    def sink(self) -> link.Sink: ...

    def put_out(self, topics: set[str], count: int) -> list[Sent]:
        """So many messages of these topics, of which there are no more."""


class Graph:
    def __init__(self, _folder: Path, warn: Callable[[str], None]) -> None:
        self.graph = SmallGraph()
        self.graph.installed = {ODOM.type_name, CUSTOM_TYPE}
        self.sink = GraphSink(self.graph, warn)

    def put_out(self, topics: set[str], count: int) -> list[Sent]:
        types = {publisher.topic: publisher.type_name for publisher in self.graph.advertised}
        return [(topic, types[topic], payload) for topic, payload in self.graph.published if topic in topics]


class Recording:
    def __init__(self, folder: Path, warn: Callable[[str], None]) -> None:
        self.folder = folder / "drive"
        self.sink = RecordingSink(self.folder, warn, itertools.count(START_NS).__next__)

    def put_out(self, topics: set[str], count: int) -> list[Sent]:
        self.sink.close()
        with open_recording(self.folder / "ada") as recording:
            sent = [(one.topic, one.type_name, payload) for one, _, payload in recording.messages()]
        return [one for one in sent if one[0] in topics]


class Foxglove:
    def __init__(self, _folder: Path, warn: Callable[[str], None]) -> None:
        self.sink = open_foxglove_sink(0, warn, itertools.count(START_NS).__next__)

    def put_out(self, topics: set[str], count: int) -> list[Sent]:
        """What a client gets that comes now: all topics here are latched."""
        with foxglove_client(self.sink.port) as client:
            while not topics <= client.channels.keys():
                client.receive()
            for topic in topics:
                client.subscribe(topic)
            types = {topic: channel["schemaName"] for topic, channel in client.channels.items()}
            return [(topic, types[topic], payload) for topic, _, payload in client.await_messages(count)]


@pytest.fixture
def said() -> list[str]:
    return []


@pytest.fixture(params=[Graph, Recording, Foxglove])
def place(request: pytest.FixtureRequest, tmp_path: Path, said: list[str]) -> Iterator[Place]:
    opened: Place = request.param(tmp_path, said.append)
    yield opened
    opened.sink.close()


def take(place: Place, *messages: tuple[StreamInfo, bytes]) -> None:
    for stream, payload in messages:
        place.sink.write(
            ReceivedMessage(robot="ada", stream=stream, payload=payload, offered_ns=1, age_ns=None)
        )


def test_every_message_is_put_out_with_its_topic_type_and_bytes_in_order(
    place: Place, said: list[str]
) -> None:
    messages = [(ODOM, odometry(float(x), 0.0)) for x in range(20)] + [(GRIPPER, HELD)]
    for stream in (ODOM, GRIPPER):
        place.sink.open("ada", stream)
    take(place, *messages)
    put_out = place.put_out({"/odom", "/gripper"}, len(messages))
    for of in (ODOM, GRIPPER):
        expected = [(of.topic, of.type_name, payload) for stream, payload in messages if stream is of]
        assert [one for one in put_out if one[0] == of.topic] == expected
    assert said == []


def test_a_stream_that_is_announced_again_goes_on(place: Place, said: list[str]) -> None:
    for x in (1.0, 2.0):
        place.sink.open("ada", ODOM)
        take(place, (ODOM, odometry(x, 0.0)))
    put_out = place.put_out({"/odom"}, 2)
    assert [payload for _, _, payload in put_out] == [odometry(1.0, 0.0), odometry(2.0, 0.0)]
    assert said == []


def test_after_another_type_was_announced_messages_have_that_one(place: Place, said: list[str]) -> None:
    place.sink.open("ada", ODOM)
    take(place, (ODOM, odometry(1.0, 0.0)))
    place.sink.open("ada", CHANGED)
    take(place, (CHANGED, HELD))
    assert place.put_out({"/odom"}, 1)[-1] == ("/odom", CUSTOM_TYPE, HELD)
    assert said == []


@pytest.mark.parametrize("definition", NO_DEFINITIONS)
def test_a_type_that_nobody_can_read_costs_no_other_topic_and_is_said_at_most_once(
    place: Place, said: list[str], definition: str
) -> None:
    odd = StreamInfo(topic="/odd", type_name=UNKNOWN, qos=LATCHED, definition=definition)
    for stream in (odd, ODOM, odd):
        place.sink.open("ada", stream)
    take(place, (odd, b"\x00\x01\x00\x00\x07"), (ODOM, odometry(1.0, 0.0)), (odd, b""))
    assert place.put_out({"/odom"}, 1) == [("/odom", ODOM.type_name, odometry(1.0, 0.0))]
    assert len(said) <= 1
    assert all(UNKNOWN in line and "/odd" in line for line in said)


def test_a_message_of_a_stream_that_was_never_announced_is_left_out(place: Place) -> None:
    place.sink.open("ada", ODOM)
    take(place, (GRIPPER, HELD), (ODOM, odometry(1.0, 0.0)))
    assert place.put_out({"/odom"}, 1) == [("/odom", ODOM.type_name, odometry(1.0, 0.0))]


def test_a_stream_that_is_forgotten_takes_nothing_of_the_others_with_it_and_may_come_again(
    place: Place, said: list[str]
) -> None:
    place.sink.forget("ada", ODOM)
    for stream in (ODOM, GRIPPER, CHANGED):
        place.sink.open("ada", stream)
    take(place, (CHANGED, HELD), (GRIPPER, HELD))
    place.sink.forget("ada", CHANGED)
    place.sink.open("ada", CHANGED)
    take(place, (CHANGED, HELD[:-1]))
    put_out = place.put_out({"/odom", "/gripper"}, 2)
    assert [one for one in put_out if one[0] == "/gripper"] == [("/gripper", CUSTOM_TYPE, HELD)]
    assert [one for one in put_out if one[0] == "/odom"][-1] == ("/odom", CUSTOM_TYPE, HELD[:-1])
    assert said == []


def test_what_a_stream_latched_is_given_to_nobody_once_it_is_forgotten(tmp_path: Path) -> None:
    graph, foxglove = Graph(tmp_path, pytest.fail), Foxglove(tmp_path, pytest.fail)
    again = replace(GRIPPER, publisher=1)
    for place in (graph, foxglove):
        for stream, payload in ((GRIPPER, HELD), (again, HELD[:-1])):
            place.sink.open("ada", stream)
            take(place, (stream, payload))
        place.sink.forget("ada", GRIPPER)
    assert graph.graph.for_late_subscribers("/gripper") == [HELD[:-1]]
    take(graph, (GRIPPER, HELD))
    assert len(graph.graph.published) == 2
    assert foxglove.put_out({"/gripper"}, 1) == [("/gripper", CUSTOM_TYPE, HELD[:-1])]
    foxglove.sink.close()


def test_nothing_goes_wrong_after_the_end(place: Place, said: list[str]) -> None:
    place.sink.open("ada", ODOM)
    for _ in range(2):
        place.sink.close()
    take(place, (ODOM, odometry(1.0, 0.0)))
    assert said == []
