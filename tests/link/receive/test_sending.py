# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What is sent to which robot, what is said of the rest, and what is shown of it."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import replace
from typing import TYPE_CHECKING, cast

import pytest

from link.zenoh.ends import ODOM
from robot.status.virtual_robot import Source, VirtualRobot
from smarttestudo.cli.receive import reception_lines
from smarttestudo.cli.top_table import Style
from smarttestudo.domain.link import CommandTopic, SentCounts
from smarttestudo.domain.names import output_name
from smarttestudo.link.protocol.commands import CommandedRobot
from smarttestudo.link.protocol.keys import Boot
from smarttestudo.link.receive.reception import Reception
from smarttestudo.link.receive.sending import SAY_AFTER_NS, SETTLE_NS, STALL_NS, Sending, StallGuard

JOY = "sensor_msgs/msg/Joy"
if TYPE_CHECKING:
    from smarttestudo.link.zenoh.commands import CommandOutbox

MS = 1_000_000
ADA, BOB = Boot("ada", "0" * 16), Boot("bob", "1" * 16)
LATER_NS = SAY_AFTER_NS + 1


class Robots:
    """A ``CommandOutbox`` that keeps what it is given."""

    def __init__(self, *boots: Boot, type_name: str | None = JOY, problem: str | None = None) -> None:
        self.names: tuple[str, ...] = ("/joy",)
        self.sent: list[tuple[Boot, str, bytes]] = []
        told = CommandTopic(topic="/joy", type_name=type_name, problem=problem)
        self.known = dict.fromkeys(boots, told)

    def robots(self) -> list[CommandedRobot]:
        return [
            CommandedRobot(
                boot=boot, topics={told.topic: told}, counts={"/joy": SentCounts(sent=7)}, round_trip_ms=640.0
            )
            for boot, told in self.known.items()
        ]

    def send(self, boot: Boot, topic: str, publisher: Hashable, payload: bytes) -> bool:
        self.sent.append((boot, topic, payload))
        return len(payload) <= 64_000

    def pump(self) -> None: ...


class Operator:
    """A ``Sending`` beside nodes that publish."""

    def __init__(self, robots: Robots, *sources: str, pattern: str = "{topic}", type_name: str = JOY) -> None:
        self.now_ns = 0
        self.said: list[str] = []
        self.robots = robots
        self.graph = VirtualRobot(sources={topic: Source(type_name=type_name) for topic in sources})
        self.sending = Sending(
            self.graph,
            cast("CommandOutbox", robots),
            self.said.append,
            pattern=pattern,
            own_nodes=lambda: {"/testudo_receive_1"},
            clock=lambda: self.now_ns,
        )

    def look(self, after_ns: int = 0) -> None:
        self.now_ns += after_ns
        self.sending.poll(self.now_ns)

    def hears(self, topic: str, payload: bytes) -> None:
        self.graph.receivers[topic](payload, b"")


def test_a_robot_is_sent_what_has_its_name_here() -> None:
    operator = Operator(Robots(ADA, BOB), "/ada/joy", "/bob/joy", "/joy", pattern="/{robot}{topic}")
    operator.look()
    operator.hears("/ada/joy", b"a")
    operator.hears("/bob/joy", b"b")
    assert operator.robots.sent == [(ADA, "/joy", b"a"), (BOB, "/joy", b"b")]
    assert operator.graph.receivers.keys() == {"/ada/joy", "/bob/joy"}
    operator.look(LATER_NS)
    assert operator.said == []


@pytest.mark.parametrize(
    ("robots", "type_name", "sentence"),
    [
        (
            Robots(ADA, BOB),
            JOY,
            "2 robots accept it, and nothing tells which is meant: "
            "tell them apart with --output-topic '/{robot}{topic}'",
        ),
        (Robots(ADA), "std_msgs/msg/String", f"it is std_msgs/msg/String here and {JOY} at ada"),
        (Robots(ADA, type_name=None, problem="it is odd"), JOY, "at ada, it is odd"),
    ],
)
def test_what_cannot_be_sent_is_said_once_when_it_lasts(
    robots: Robots, type_name: str, sentence: str
) -> None:
    operator = Operator(robots, "/joy", type_name=type_name)
    operator.look()
    assert operator.said == []
    for _ in range(3):
        operator.look(LATER_NS)
    assert operator.said == [f"/joy is not sent to {boot.robot}: {sentence}" for boot in robots.known]
    assert operator.graph.receivers == {}
    assert [route.problem for route in operator.sending.routes] == [sentence] * len(robots.known)


@pytest.mark.parametrize("pattern", ["{topic}", "/{robot}{topic}"])
def test_to_two_robots_of_one_name_nothing_is_sent_and_they_are_to_be_renamed(pattern: str) -> None:
    robots = Robots(ADA, Boot("ada", "2" * 16))
    name = output_name("/joy", pattern, "ada")
    operator = Operator(robots, name, pattern=pattern)
    operator.look()
    operator.look(LATER_NS)
    assert operator.said == [
        f"{name} is not sent to ada: 2 robots accept it, and nothing tells which is meant: "
        "give each a name of its own with --robot of 'testudo run'"
    ]
    assert operator.graph.receivers == {}


def test_what_comes_from_a_robot_or_from_smarttestudo_is_not_sent() -> None:
    relayed = Operator(Robots(ADA), "/joy")
    relayed.look()
    relayed.sending.open("bob", replace(ODOM, topic="/joy"))
    relayed.look(LATER_NS)
    relayed.hears("/joy", b"of bob")
    assert relayed.robots.sent == []
    relayed.sending.open("eve", replace(ODOM, topic="/joy"))
    relayed.sending.forget("bob", replace(ODOM, topic="/joy"))
    relayed.look(LATER_NS)
    assert "it would go round" in str(relayed.sending.routes[0].problem)
    relayed.sending.forget("eve", replace(ODOM, topic="/joy"))
    relayed.look(LATER_NS)
    assert relayed.sending.routes[0].problem is None
    own = Operator(Robots(ADA), "/joy")
    own.graph.sources["/joy"].nodes = ("/joystick", "/testudo_receive_1")
    own.look()
    assert own.graph.receivers == {}
    assert "it would go round" in str(own.sending.routes[0].problem)


def test_without_a_publisher_or_a_subscriber_nothing_is_wrong() -> None:
    for operator in (Operator(Robots(ADA)), Operator(Robots(ADA, type_name=None), "/joy")):
        operator.look()
        operator.look(LATER_NS)
        assert operator.said == []
        assert [route.is_quiet for route in operator.sending.routes] == [True]


def test_what_is_named_at_one_end_only_is_said() -> None:
    robots = Robots(ADA)
    robots.known[ADA] = replace(robots.known[ADA], topic="/goal_pose")
    operator = Operator(robots)
    operator.sending.open("eve", ODOM)
    operator.look()
    operator.look(LATER_NS)
    assert sorted(operator.said) == [
        "ada accepts /goal_pose, which is not sent: name it in 'testudo receive --send'",
        "ada does not accept /joy: name it there in 'testudo run --accept'",
        "eve accepts nothing: name /joy there in 'testudo run --accept'",
    ]


def test_that_all_is_too_old_is_said_with_the_numbers_and_again_after_it_was_better() -> None:
    robots = Robots(ADA)
    operator = Operator(robots, "/joy")
    operator.look()
    for too_old, delivered in ((1, 0), (2, 0), (2, 1), (3, 1)):
        told = replace(robots.known[ADA], too_old=too_old, delivered=delivered, age_ms=612.3)
        robots.known[ADA] = told
        operator.look()
    assert (
        operator.said
        == [
            "What is sent to ada on /joy arrives 612 ms old; nothing older than 500 ms is delivered; "
            "the round trip takes 640 ms"
        ]
        * 2
    )


def test_a_message_that_is_too_large_is_said_once() -> None:
    operator = Operator(Robots(ADA), "/joy")
    operator.look()
    for _ in range(2):
        operator.hears("/joy", bytes(64_001))
    assert operator.said == ["/joy: a message of 64001 bytes is too large to be sent; the largest has 64000"]


def test_what_is_heard_after_this_process_stood_still_is_dropped_for_a_while() -> None:
    operator = Operator(Robots(ADA), "/joy")
    operator.look()
    operator.now_ns += STALL_NS + 1
    operator.hears("/joy", b"old")
    for _ in range(SETTLE_NS // (100 * MS) - 1):
        operator.now_ns += 100 * MS
        operator.hears("/joy", b"perhaps")
    operator.now_ns += 100 * MS
    operator.hears("/joy", b"new")
    assert operator.robots.sent == [(ADA, "/joy", b"new")]
    operator.look()
    assert [route.suspect for route in operator.sending.routes] == [SETTLE_NS // (100 * MS)]


def test_a_guard_that_is_asked_in_time_has_nothing_against_it() -> None:
    guard = StallGuard(0)
    assert all(guard.polled(number * STALL_NS) for number in range(10))


def test_the_screen_shows_what_is_sent_and_what_the_robot_told_of_it() -> None:
    robots = Robots(ADA)
    robots.known[ADA] = replace(robots.known[ADA], delivered=6, too_old=1, age_ms=44.0)
    operator = Operator(robots, "/joy")
    operator.look()
    lines = reception_lines(Reception([]), 110, operator.sending.routes)
    assert lines[-1].text.split() == ["/joy", "ada", "7", "0", "6", "1", "44"]
    robots.known[ADA] = replace(robots.known[ADA], type_name=None, problem="it is odd")
    operator.look()
    line = reception_lines(Reception([]), 110, operator.sending.routes)[-1]
    assert (line.style, line.text.endswith("at ada, it is odd")) == (Style.WARN, True)
