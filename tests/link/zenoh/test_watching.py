# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Robots that are watched and asked over a link, and strangers on their keys."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from link.zenoh.ends import (
    Reader,
    free_endpoint,
    messages,
    operator_end,
    quick_watch,
    refuse_warning,
    robot_end,
    until,
)
from robot.status.statuses import STATUS
from smarttestudo.cli.robots import wait_for_all
from smarttestudo.domain.errors import TestudoError
from smarttestudo.domain.parameter import GetParameters, GetTopics, SetParameters
from smarttestudo.domain.record import to_json
from smarttestudo.link.zenoh import open_link_robots, open_robot_end
from smarttestudo.link.zenoh.link_robots import LinkRobots
from smarttestudo.link.zenoh.robot_end import RobotEnd
from smarttestudo.link.zenoh.security import LinkOptions

__all__ = ["quick_watch"]
pytestmark = pytest.mark.full
ID = "r1:/smarttestudo"
NAMES = ("rules_hash",)


class Robot:
    """A robot that tells a status and answers what it is asked, whenever it is stepped."""

    def __init__(self, end: RobotEnd, node: str = STATUS.node) -> None:
        self.end = end
        self.node = node
        self.steps = 0
        self.set: list[object] = []

    def step(self) -> None:
        """Tell another status, and answer a question."""
        self.steps += 1
        self.end.tell(
            to_json(replace(STATUS, node=self.node, robot=self.end.robot, uptime_s=float(self.steps)))
        )
        self.answer()

    def answer(self) -> None:
        """Answer a question, if there is one."""
        asked = self.end.take_question()
        if asked is None:
            return
        match asked.question:
            case GetParameters(names=names):
                asked.answer({name: f"value of {name}" if name in NAMES else None for name in names})
            case SetParameters(values=values):
                self.set.append(dict(values))
                asked.answer({name: "no" for name in values if name == "refused"})
            case GetTopics():
                asked.answer({"/imu": "sensor_msgs/msg/Imu"})


@contextmanager
def watching(endpoint: str, config: Path | None = None) -> Iterator[LinkRobots]:
    options = LinkOptions(connect=(endpoint,), config_file=config)
    with open_link_robots(options, refuse_warning) as robots:
        yield robots


@contextmanager
def listening_robot(endpoint: str, name: str = "r1") -> Iterator[Robot]:
    with open_robot_end(name, LinkOptions(listen=(endpoint,)), refuse_warning) as end:
        yield Robot(end)


def step(robots: LinkRobots, *robot: Robot) -> None:
    for one in robot:
        one.step()
    robots.wait(0.02)


def answered(robots: LinkRobots, robot: Robot | None, ask: Callable[[Callable[[Any], None]], None]) -> Any:
    """What ``ask`` is answered."""
    said: list[Any] = []
    ask(said.append)
    until(lambda: bool(said), lambda: step(robots, *([] if robot is None else [robot])))
    return said[0]


def heard_by(robots: LinkRobots, robot: Robot) -> None:
    until(lambda: ID in robots.heard and robots.heard[ID].is_present, lambda: step(robots, robot))


def all_heard_by(robots: LinkRobots, robot: Robot) -> None:
    until(lambda: robots.has_heard_all, lambda: step(robots, robot))


@pytest.mark.contract
def test_several_watchers_hear_a_robot_through_an_operator_who_hears_it_too() -> None:
    endpoint = free_endpoint()
    with (
        operator_end(endpoint) as operator,
        robot_end(endpoint) as end,
        watching(endpoint) as first,
        watching(endpoint) as second,
    ):
        robot, reader = Robot(end), Reader(operator)
        for robots in (first, second):
            heard_by(robots, robot)
            all_heard_by(robots, robot)
            assert robots.heard[ID].status.topics.keys() == STATUS.topics.keys()
            assert robots.heard[ID].status.blocks == STATUS.blocks
            assert robots.heard[ID].is_present
        until(lambda: bool(messages(reader.read())), robot.step)
        message = messages(reader.events)[0]
        assert (message.stream.topic, message.stream.type_name) == ("/testudo/status", "std_msgs/msg/String")
        assert message.stream.qos.transient_local
        assert end.is_watched
        until(lambda: first.heard[ID].status.uptime_s > 5, lambda: step(first, robot))
        assert first.heard[ID].size_bytes < 500


@pytest.mark.contract
def test_a_robot_answers_what_it_is_asked() -> None:
    endpoint = free_endpoint()
    with listening_robot(endpoint) as robot, watching(endpoint) as robots:
        heard_by(robots, robot)
        values = answered(robots, robot, partial(robots.get, ID, [*NAMES, "other"]))
        assert values == {"rules_hash": "value of rules_hash", "other": None}
        changes: dict[str, Any] = {"rules_text": "é" * 200_000, "refused": 5, "list": ("a", "b")}
        assert answered(robots, robot, partial(robots.set, ID, changes)) == {"refused": "no"}
        assert robot.set == [changes]
        for name in (ID, None):
            topics = answered(robots, robot, partial(robots.topics, name))
            assert topics == {"/imu": "sensor_msgs/msg/Imu"}


@pytest.mark.usefixtures("quick_watch")
def test_watchers_that_nobody_answers_say_why_and_connect_once_somebody_does() -> None:
    endpoint = free_endpoint()
    with watching(endpoint) as robots:
        until(lambda: "Connection refused" in (robots.problem or ""), lambda: step(robots))
        with pytest.raises(TestudoError, match=r"no status was received within 0.1 s \(.*refused"):
            wait_for_all(robots, lambda: False, 0.1)
        for _ in range(2):
            with listening_robot(endpoint) as robot:
                heard_by(robots, robot)
                until(lambda: robots.problem is None, lambda: step(robots))
            until(lambda: "refused" in (robots.problem or ""), lambda: step(robots))


def test_watchers_hear_and_ask_the_robots_of_all_places_each_once_and_join_none_of_them() -> None:
    first, second, third = (free_endpoint() for _ in range(3))
    with (
        listening_robot(first, "ada") as ada,
        operator_end(second) as operator,
        robot_end(second, "bob") as end,
        open_robot_end("bea", LinkOptions(listen=(third,)), refuse_warning) as bea,
    ):
        bob = Robot(end)
        options = LinkOptions(connect=(first, second, second, third))
        with open_link_robots(options, refuse_warning) as robots:
            until(lambda: len(robots.heard) == 3, lambda: step(robots, ada, bob, Robot(bea)))
            assert {*robots.heard} == {f"{name}:/smarttestudo" for name in ("ada", "bob", "bea")}
            assert robots.problem is None
            for name, robot in (("ada", ada), ("bob", bob)):
                answered(robots, robot, partial(robots.set, f"{name}:/smarttestudo", {"status_hz": 5}))
                assert robot.set == [{"status_hz": 5}]
            assert [boot.robot for boot in operator.counts()] == ["bob"]
