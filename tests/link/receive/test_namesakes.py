# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Several robots of one name: which of them has a topic, and that it is there once the others are gone."""

from __future__ import annotations

import itertools
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from smarttestudo.domain.link import ReceivedMessage, StreamInfo
from smarttestudo.domain.robot import Qos
from smarttestudo.link.receive.reception import Reception
from smarttestudo.link.zenoh.arrivals import RobotPresence, StreamSaid

SCAN = StreamInfo(
    topic="/scan",
    type_name="sensor_msgs/msg/LaserScan",
    qos=Qos(reliable=True, transient_local=False, depth=5),
    definition="float32[] ranges",
)
LATCHED = replace(SCAN, topic="/map", qos=Qos(reliable=True, transient_local=True, depth=1))
OTHERS = {
    "type": replace(SCAN, type_name="sensor_msgs/msg/Image"),
    "reliability": replace(SCAN, qos=replace(SCAN.qos, reliable=False)),
    "durability": replace(SCAN, qos=replace(SCAN.qos, transient_local=True)),
    "definition": replace(SCAN, definition="float64[] ranges"),
}
FIRST, SECOND = "first", "second"


class Graph:
    """A sink that takes only messages of streams that are open as they are."""

    def __init__(self) -> None:
        self.opened: dict[tuple[str, int], StreamInfo] = {}
        self.taken: list[ReceivedMessage] = []
        self.closed = 0

    def open(self, robot: str, stream: StreamInfo) -> None:
        others = [
            one
            for (topic, publisher), one in self.opened.items()
            if topic == stream.topic and publisher != stream.publisher
        ]
        assert {kind(one) for one in others} <= {kind(stream)}, "the topic is there with another type"
        self.opened[stream.topic, stream.publisher] = stream

    def write(self, message: ReceivedMessage) -> None:
        opened = self.opened[message.stream.topic, message.stream.publisher]
        assert kind(opened) == kind(message.stream), "a message goes out as another type"
        self.taken.append(message)

    def forget(self, robot: str, stream: StreamInfo) -> None:
        del self.opened[stream.topic, stream.publisher]
        self.closed += 1

    def close(self) -> None: ...


def kind(stream: StreamInfo) -> tuple[str, bool, bool, str]:
    return stream.type_name, stream.qos.reliable, stream.qos.transient_local, stream.definition


class Robots:
    """Runs named alike; what each has is said again where it comes back."""

    def __init__(self) -> None:
        self.graph = Graph()
        self.said: list[str] = []
        self.reception = Reception([self.graph], warn=self.said.append)
        self.streams: dict[str, dict[int, StreamInfo]] = {}
        self.present: dict[str, None] = {}
        self.number = 0

    def comes(self, boot: str) -> None:
        self.present[boot] = None
        self.reception.handle(RobotPresence(robot="ada", boot=boot, is_present=True), 0)
        for number, info in self.streams.setdefault(boot, {}).items():
            self.says(boot, number, info)

    def leaves(self, boot: str) -> None:
        self.present.pop(boot, None)
        self.reception.handle(RobotPresence(robot="ada", boot=boot, is_present=False), 0)

    def says(self, boot: str, number: int, info: StreamInfo | None) -> None:
        if info is None:
            self.streams[boot].pop(number, None)
        else:
            self.streams[boot][number] = info
        self.reception.handle(StreamSaid(robot="ada", boot=boot, number=number, info=info), 0)

    def sends(self, boot: str, number: int) -> ReceivedMessage:
        self.number += 1
        message = ReceivedMessage(
            robot="ada",
            stream=self.streams[boot][number],
            payload=str(self.number).encode(),
            offered_ns=1,
            age_ns=0,
            boot=boot,
        )
        self.reception.handle(message, 0)
        return message

    def is_taken(self, boot: str, number: int) -> bool:
        message = self.sends(boot, number)
        return self.graph.taken[-1:] == [message]


@pytest.mark.parametrize("publishers", list(itertools.permutations(range(1, 5), 2)))
@pytest.mark.parametrize("what", OTHERS)
def test_the_other_type_is_opened_once_the_first_is_gone_whatever_publishers_are_called(
    what: str, publishers: tuple[int, int]
) -> None:
    robots = Robots()
    robots.comes(FIRST)
    robots.says(FIRST, 1, replace(SCAN, publisher=publishers[0]))
    robots.comes(SECOND)
    robots.says(SECOND, 1, replace(OTHERS[what], publisher=publishers[1]))
    said = list(robots.said)
    robots.leaves(FIRST)
    assert robots.said == said
    assert robots.is_taken(SECOND, 1)


@pytest.mark.parametrize("what", OTHERS)
def test_the_second_one_is_refused_and_said_once_and_leaves_no_trace(what: str) -> None:
    robots = Robots()
    robots.comes(FIRST)
    robots.says(FIRST, 1, SCAN)
    robots.comes(SECOND)
    for _ in range(3):
        robots.says(SECOND, 1, OTHERS[what])
        assert not robots.is_taken(SECOND, 1)
        assert robots.is_taken(FIRST, 1)
    assert robots.reception.robots["ada"].topics["/scan"].problem is not None
    robots.leaves(SECOND)
    assert robots.is_taken(FIRST, 1)
    assert robots.graph.closed == 0
    assert robots.reception.robots["ada"].topics["/scan"].problem is None
    (line,) = robots.said
    assert "ada: a second robot of this name sends /scan " in line
    assert {"type": "as sensor_msgs/msg/Image, not sensor_msgs/msg/LaserScan"}.get(
        what, "with another"
    ) in line


@pytest.mark.parametrize("what", OTHERS)
def test_the_second_one_has_the_topic_as_soon_as_the_first_one_is_gone(what: str) -> None:
    robots = Robots()
    robots.comes(FIRST)
    robots.says(FIRST, 1, OTHERS[what])
    robots.comes(SECOND)
    robots.says(SECOND, 1, SCAN)
    assert not robots.is_taken(SECOND, 1)
    robots.leaves(FIRST)
    assert robots.is_taken(SECOND, 1)
    assert robots.graph.opened["/scan", 0] == SCAN


def test_a_first_one_that_is_back_from_an_outage_has_its_topics_again() -> None:
    robots = Robots()
    robots.comes(FIRST)
    robots.says(FIRST, 1, SCAN)
    robots.comes(SECOND)
    robots.says(SECOND, 1, OTHERS["type"])
    robots.leaves(FIRST)
    assert robots.is_taken(SECOND, 1)
    robots.comes(FIRST)
    assert robots.is_taken(FIRST, 1)
    assert not robots.is_taken(SECOND, 1)


def test_a_first_one_that_opens_its_topic_anew_keeps_it() -> None:
    robots = Robots()
    robots.comes(FIRST)
    robots.says(FIRST, 1, SCAN)
    robots.comes(SECOND)
    robots.says(SECOND, 1, OTHERS["type"])
    robots.says(FIRST, 1, None)
    robots.says(FIRST, 2, OTHERS["reliability"])
    assert robots.is_taken(FIRST, 2)
    assert not robots.is_taken(SECOND, 1)


def test_what_the_second_one_latched_meanwhile_is_there_once_it_has_the_topic() -> None:
    robots = Robots()
    robots.comes(FIRST)
    robots.says(FIRST, 1, replace(OTHERS["type"], topic="/map"))
    robots.comes(SECOND)
    robots.says(SECOND, 1, LATCHED)
    for _ in range(2):
        last = robots.sends(SECOND, 1)
    robots.leaves(FIRST)
    assert robots.graph.taken == [last]


def test_two_that_are_alike_are_received_both() -> None:
    robots = Robots()
    for boot in (FIRST, SECOND):
        robots.comes(boot)
        robots.says(boot, 1, SCAN)
    for boot in (FIRST, SECOND):
        assert robots.is_taken(boot, 1)
    robots.leaves(FIRST)
    assert robots.is_taken(SECOND, 1)
    assert (robots.graph.closed, robots.said) == (0, [])


BOOTS = ("a", "b", "c")
STREAMS = [
    replace(info, topic=topic, publisher=publisher)
    for info in (SCAN, *OTHERS.values())
    for topic in ("/scan", "/map")
    for publisher in (0, 1)
]


def act(robots: Robots, data: st.DataObject) -> None:
    """Something that one of the runs does."""
    boot, number = data.draw(st.sampled_from(BOOTS)), data.draw(st.integers(1, 3))
    if boot not in robots.present:
        robots.comes(boot)
    match data.draw(st.sampled_from(["leave", "say", "end", "send"])):
        case "leave":
            robots.leaves(boot)
        case "say":
            info = data.draw(st.sampled_from(STREAMS))
            for other, known in [*robots.streams[boot].items()]:
                # A run has one type of a topic at a time, and each publisher once.
                if known.topic == info.topic and (
                    kind(known) != kind(info) or known.publisher == info.publisher
                ):
                    robots.says(boot, other, None)
            robots.says(boot, number, info)
        case "end":
            robots.says(boot, number, None)
        case "send" if number in robots.streams[boot]:
            robots.sends(boot, number)


@given(st.data())
def test_messages_go_out_as_what_they_are_and_the_first_one_there_has_all_its_topics(
    data: st.DataObject,
) -> None:
    robots = Robots()
    for _ in range(data.draw(st.integers(1, 25))):
        act(robots, data)
        there = [one for one in robots.streams if one in robots.present]
        for number, info in robots.streams[there[0]].items() if there else ():
            assert kind(robots.graph.opened[info.topic, info.publisher]) == kind(info)
            assert robots.is_taken(there[0], number)
        if len(there) == 1:
            own = {(info.topic, info.publisher) for info in robots.streams[there[0]].values()}
            assert robots.graph.opened.keys() == own
