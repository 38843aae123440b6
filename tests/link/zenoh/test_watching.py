# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Robots that are watched and asked over a link, and strangers on their keys."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import pytest
import zenoh

from link.zenoh.ends import (
    Reader,
    free_endpoint,
    messages,
    operator_end,
    refuse_warning,
    robot_end,
    stranger_at,
    until,
)
from robot.status.statuses import STATUS
from smarttestudo.cli.robots import topics_of_robot, wait_for_all
from smarttestudo.domain.errors import LinkError, TestudoError, UsageError
from smarttestudo.domain.parameter import SilentNodeError
from smarttestudo.domain.questions import GetParameters, GetTopics, SetParameters
from smarttestudo.domain.record import to_json
from smarttestudo.link.protocol.messages import CHANGING_QUESTIONS
from smarttestudo.link.zenoh import open_link_robots, open_robot_end
from smarttestudo.link.zenoh.link_robots import LinkRobots
from smarttestudo.link.zenoh.query_server import MAX_WAITING
from smarttestudo.link.zenoh.robot_end import RobotEnd
from smarttestudo.link.zenoh.security import LinkOptions

pytestmark = pytest.mark.process
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


def test_a_robot_that_left_is_said_to_be_gone_and_one_that_is_back_is_heard() -> None:
    endpoint = free_endpoint()
    with operator_end(endpoint), watching(endpoint) as robots:
        for _ in range(2):
            with robot_end(endpoint) as end:
                heard_by(robots, Robot(end))
            until(lambda: not robots.heard[ID].is_present, lambda: step(robots))
        assert [*robots.heard] == [ID]
        robots.forget(ID)
        assert not robots.heard


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


def test_a_place_where_nobody_answers_keeps_no_watcher_waiting_for_the_others() -> None:
    endpoint, nobody = free_endpoint(), free_endpoint()
    options = LinkOptions(connect=(nobody, endpoint))
    with listening_robot(endpoint) as robot, open_link_robots(options, refuse_warning) as robots:
        all_heard_by(robots, robot)
        assert robots.problem is None
        assert [*robots.heard] == [ID]


def test_a_robot_that_is_reached_in_two_ways_is_heard_while_there_is_one() -> None:
    endpoints = [free_endpoint() for _ in range(2)]
    with ExitStack() as opened:
        robot = Robot(
            opened.enter_context(open_robot_end("r1", LinkOptions(connect=tuple(endpoints)), print))
        )
        ends = [opened.enter_context(ExitStack()) for _ in endpoints]
        for stack, endpoint in zip(ends, endpoints, strict=True):
            stack.enter_context(operator_end(endpoint))
        options = LinkOptions(connect=tuple(endpoints))
        robots = opened.enter_context(open_link_robots(options, refuse_warning))
        heard_by(robots, robot)
        until(lambda: robot.steps > 60, lambda: step(robots, robot))
        assert [*robots.heard] == [ID]
        ends[0].close()
        steps = robot.steps + 100
        until(lambda: robots.heard[ID].status.uptime_s > steps, lambda: step(robots, robot))
        assert robots.heard[ID].is_present
        assert answered(robots, robot, partial(robots.get, ID, NAMES)) == {NAMES[0]: f"value of {NAMES[0]}"}


def test_two_robots_of_one_name_are_two() -> None:
    endpoint = free_endpoint()
    with ExitStack() as opened:
        opened.enter_context(operator_end(endpoint, lambda warning: None))
        pair = [Robot(opened.enter_context(robot_end(endpoint))) for _ in range(2)]
        robots = opened.enter_context(watching(endpoint))
        until(lambda: len(robots.heard) == 2, lambda: step(robots, *pair))
        names = {f"r1#{robot.end.boot.number[:4]}:/smarttestudo": robot for robot in pair}
        assert robots.heard.keys() == names.keys()
        for name, robot in names.items():
            answered(robots, robot, partial(robots.set, name, {"budget_kb_per_s": 5}))
        assert [robot.set for robot in pair] == [[{"budget_kb_per_s": 5}]] * 2
        with pytest.raises(UsageError, match="several robots are heard: r1#") as refused:
            topics_of_robot(robots, None, lambda: False)
        assert refused.value.remedy == "name one with --robot"


def test_two_nodes_of_one_name_are_asked_by_their_ids() -> None:
    endpoint, nodes = free_endpoint(), ("/a/smarttestudo", "/b/smarttestudo")
    with ExitStack() as opened:
        opened.enter_context(operator_end(endpoint, lambda warning: None))
        pair = [Robot(opened.enter_context(robot_end(endpoint)), node) for node in nodes]
        robots = opened.enter_context(watching(endpoint))
        until(lambda: len(robots.heard) == 2, lambda: step(robots, *pair))
        with pytest.raises(UsageError, match="are heard: r1:/a/smarttestudo, r1:/b/smarttestudo; name one"):
            topics_of_robot(robots, "r1", lambda: False)
        asked = ThreadPoolExecutor(1).submit(topics_of_robot, robots, "r1:/b/smarttestudo", lambda: False)
        until(asked.done, pair[1].step)
        assert asked.result() == {"/imu": "sensor_msgs/msg/Imu"}


def test_an_unknown_robot_and_one_that_never_answers_are_silent() -> None:
    endpoint = free_endpoint()
    with listening_robot(endpoint) as robot, watching(endpoint) as robots:
        for name in ("r2:/smarttestudo", ID):
            silent = answered(robots, None, partial(robots.get, name, NAMES))
            assert isinstance(silent, SilentNodeError)
        heard_by(robots, robot)
        silent = answered(robots, None, partial(robots.get, ID, NAMES))
        assert str(silent).startswith(f"{ID}: error: the robot did not answer within 5 s; check that")
        # Nobody waits for that answer any more.
        assert robot.end.take_question() is None
        with pytest.raises(UsageError, match="there is no robot 'ada', but r1"):
            topics_of_robot(robots, "ada", lambda: False)


def test_questions_that_are_too_large_or_too_many_are_refused() -> None:
    endpoint = free_endpoint()
    with listening_robot(endpoint) as robot, watching(endpoint) as robots:
        heard_by(robots, robot)
        large = answered(robots, robot, partial(robots.set, ID, {"rules_text": "x" * 2_000_000}))
        assert isinstance(large, LinkError)
        said: list[Any] = []
        for _ in range(MAX_WAITING + 5):
            robots.get(ID, NAMES, said.append)
        until(lambda: len(said) >= 5, lambda: robots.wait(0.02))
        assert {one.cause for one in said} == {"too many questions wait for an answer"}
        for _ in range(MAX_WAITING):
            robot.answer()
        until(lambda: len(said) == MAX_WAITING + 5, lambda: robots.wait(0.02))
        assert [one for one in said if not isinstance(one, LinkError)] == [
            {"rules_hash": "value of rules_hash"}
        ] * MAX_WAITING


@pytest.mark.parametrize("strange", [b"", b"\4", b"\4\5\5\xff", b"\4\4\1[]", b"\xff" * 500])
def test_what_is_malformed_on_a_status_key_costs_what_it_touches(strange: bytes) -> None:
    endpoint = free_endpoint()
    with (
        operator_end(endpoint),
        robot_end(endpoint) as end,
        watching(endpoint) as robots,
        stranger_at(endpoint) as stranger,
    ):
        robot = Robot(end)
        heard_by(robots, robot)
        for key in (end.boot.status_key, "testudo/r1/0000000000000000/status", "testudo/x y/1/status"):
            stranger.put(key, strange)
        steps = robot.steps
        until(lambda: robots.heard[ID].status.uptime_s > steps + 5, lambda: step(robots, robot))


def test_a_question_of_many_keys_at_once_reaches_no_robot() -> None:
    endpoint = free_endpoint()
    with (
        operator_end(endpoint),
        robot_end(endpoint) as end,
        stranger_at(endpoint) as stranger,
    ):
        payload = CHANGING_QUESTIONS.to_bytes(SetParameters(values={"budget_kb_per_s": 1}))
        until(lambda: [*stranger.get(end.boot.set_key, payload=b"?", timeout=1.0)] != [])
        for selector in ("testudo/**", f"{end.boot.key}/*", "testudo/*/*/set"):
            assert not [reply for reply in stranger.get(selector, payload=payload, timeout=1.0) if reply.ok]
        assert end.take_question() is None


@pytest.mark.parametrize(
    "payload", [None, b"", b"\0", b"\4", b"\4\x08", b"\4\x09\1", b"\4\x88x", b"\0" * 1_200]
)
def test_a_question_that_is_none_is_refused_at_once(payload: bytes | None) -> None:
    endpoint = free_endpoint()
    with (
        listening_robot(endpoint) as robot,
        stranger_at(endpoint) as stranger,
    ):
        for key in (robot.end.boot.get_key, robot.end.boot.set_key):
            until(partial(_is_refused, stranger, key, payload))
        assert robot.end.take_question() is None


def _is_refused(session: zenoh.Session, key: str, payload: bytes | None) -> bool:
    return [reply.err is not None for reply in session.get(key, payload=payload, timeout=2.0)] == [True]
