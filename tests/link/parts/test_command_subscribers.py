# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What of an operator's messages is published among the robot's own nodes, and what is said of the rest."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import pytest

from robot.status.virtual_robot import VirtualRobot
from smarttestudo.domain.errors import RosError
from smarttestudo.domain.link import CommandTopic
from smarttestudo.domain.robot import Endpoint, Payload, Publisher, Qos
from smarttestudo.link.parts.command_subscribers import QOS, SAY_AFTER_NS, CommandSubscribers

JOY = "sensor_msgs/msg/Joy"
TWIST = "geometry_msgs/msg/Twist"


class Opened:
    def __init__(self, topic: str, type_name: str, qos: Qos) -> None:
        self.made_of = (topic, type_name, qos)
        self.is_closed = False

    def publish(self, payload: Payload) -> None: ...

    def close(self) -> None:
        self.is_closed = True


@dataclass(kw_only=True)
class DrivenRobot(VirtualRobot):
    """Its own nodes subscribe to ``/joy`` as ``listens``, by node."""

    listens: dict[str, str] = field(default_factory=dict)
    opened: list[Opened] = field(default_factory=list)
    refuses: bool = False

    def own_subscribers(self, topic: str) -> Sequence[Endpoint]:
        return [
            Endpoint(node=node, type_name=type_name, reliable=True, transient_local=False)
            for node, type_name in self.listens.items()
        ]

    def own_publisher(self, topic: str, type_name: str, qos: Qos) -> Publisher:
        if self.refuses:
            raise RosError("it has another type already", place=topic)
        self.opened.append(Opened(topic, type_name, qos))
        return self.opened[-1]


class Commands:
    """An ``IncomingCommands`` that keeps what it is told."""

    def __init__(self) -> None:
        self.topics = [CommandTopic(topic="/joy")]
        self.has_operator = True
        self.names: list[tuple[str, ...]] = [("/joy",)]
        self.followed: list[tuple[str, str | None, Publisher | None, str | None]] = []

    def sent_names(self) -> list[tuple[str, ...]]:
        return self.names

    def follow(
        self, topic: str, type_name: str | None, publisher: Publisher | None, problem: str | None = None
    ) -> None:
        self.followed.append((topic, type_name, publisher, problem))


@pytest.fixture
def robot() -> DrivenRobot:
    return DrivenRobot()


@pytest.fixture
def commands() -> Commands:
    return Commands()


def look(
    robot: DrivenRobot,
    commands: Commands,
    acceptance: CommandSubscribers | None = None,
    *,
    relayed: Sequence[str] = (),
    is_connected: bool = True,
) -> CommandSubscribers:
    acceptance = acceptance or CommandSubscribers(robot, commands)
    acceptance.poll_graph(relayed, is_connected=is_connected)
    return acceptance


def test_a_topic_has_the_type_that_the_robot_s_nodes_subscribe_with_while_one_does(
    robot: DrivenRobot, commands: Commands
) -> None:
    acceptance = look(robot, commands)
    assert commands.followed == []
    robot.listens = {"/driver": JOY, "/logger": JOY, robot.name: TWIST}
    for _ in range(2):
        look(robot, commands, acceptance)
    [first] = robot.opened
    assert first.made_of == ("/joy", JOY, QOS)
    assert (QOS.reliable, QOS.transient_local, QOS.depth) == (True, False, 1)
    robot.listens = {"/driver": TWIST}
    look(robot, commands, acceptance)
    robot.listens = {}
    look(robot, commands, acceptance)
    second = robot.opened[1]
    assert commands.followed == [
        ("/joy", JOY, first, None),
        ("/joy", TWIST, second, None),
        ("/joy", None, None, None),
    ]
    assert first.is_closed
    assert second.is_closed
    assert robot.log_lines == []


@pytest.mark.parametrize(
    ("listens", "relayed", "problem"),
    [
        ({"/a": TWIST, "/b": JOY}, [], f"nodes subscribe to it as {TWIST} and as {JOY}"),
        ({"/a": JOY}, ["/joy"], "it is relayed to operators under the same name, so it would come back"),
        ({"/a": "x/msg/Y"}, [], "its type x/msg/Y is not installed where 'testudo run' runs"),
    ],
)
def test_what_cannot_be_accepted_is_told_to_the_operator_and_said_once(
    robot: DrivenRobot, commands: Commands, listens: dict[str, str], relayed: list[str], problem: str
) -> None:
    robot.missing_types = frozenset({"x/msg/Y"})
    robot.listens = listens
    acceptance = look(robot, commands, relayed=relayed)
    look(robot, commands, acceptance, relayed=relayed)
    assert commands.followed == [("/joy", None, None, problem)]
    assert robot.log_lines == [f"/joy is not accepted from operators: {problem}"]
    assert robot.opened == []


def test_a_publisher_that_cannot_be_had_is_a_problem_of_its_topic(
    robot: DrivenRobot, commands: Commands
) -> None:
    robot.listens, robot.refuses = {"/a": JOY}, True
    look(robot, commands)
    assert commands.followed == [("/joy", None, None, "/joy: error: it has another type already")]


def test_at_the_end_nothing_is_published_any_more(robot: DrivenRobot, commands: Commands) -> None:
    robot.listens = {"/a": JOY}
    look(robot, commands).close()
    assert commands.followed[-1] == ("/joy", None, None, None)
    assert robot.opened[0].is_closed


def test_what_is_named_at_one_end_only_is_said_once(robot: DrivenRobot, commands: Commands) -> None:
    commands.names, commands.has_operator = [], False
    acceptance = look(robot, commands, is_connected=False)
    robot.elapsed_ns += SAY_AFTER_NS
    look(robot, commands, acceptance)
    assert robot.log_lines == []
    for _ in range(2):
        robot.elapsed_ns += SAY_AFTER_NS
        look(robot, commands, acceptance)
    commands.names = [("/joy", "/goal_pose")]
    look(robot, commands, acceptance)
    assert robot.log_lines == [
        "/joy is accepted, but no operator sends it: name it in 'testudo receive --send'",
        "An operator sends /goal_pose, which is not accepted: name it in 'testudo run --accept'",
    ]


def test_that_all_is_too_old_is_said_with_its_age(robot: DrivenRobot, commands: Commands) -> None:
    acceptance = look(robot, commands)
    for too_old in (1, 2):
        commands.topics = [replace(commands.topics[0], too_old=too_old, age_ms=702.0)]
        look(robot, commands, acceptance)
    assert robot.log_lines == [
        "What an operator sends on /joy arrives 702 ms old; nothing older than 500 ms is delivered"
    ]
