# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Robots that are watched and asked over a link in memory, and strangers on their keys."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from functools import partial
from typing import Any

import pytest
import zenoh

from link.zenoh.ends import free_endpoint, operator_end, refuse_warning, robot_end, stranger_at, until
from link.zenoh.memory_zenoh import Network, VirtualTime, network, virtual_time
from link.zenoh.test_watching import (
    ID,
    NAMES,
    Robot,
    all_heard_by,
    answered,
    heard_by,
    listening_robot,
    step,
    watching,
)
from smarttestudo.cli import robots as cli_robots
from smarttestudo.cli.robots import topics_of_robot
from smarttestudo.domain.errors import LinkError, UsageError
from smarttestudo.domain.parameter import SetParameters, SilentNodeError
from smarttestudo.link.protocol.messages import CHANGING_QUESTIONS
from smarttestudo.link.protocol.wire import WIRE_VERSION
from smarttestudo.link.zenoh import open_link_robots, open_robot_end
from smarttestudo.link.zenoh.link_robots import LinkRobots
from smarttestudo.link.zenoh.queries import MAX_WAITING
from smarttestudo.link.zenoh.security import LinkOptions

__all__ = ["network", "virtual_time"]
pytestmark = pytest.mark.usefixtures("network")
VERSION = bytes([WIRE_VERSION])


@pytest.fixture
def settles_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """That no further robot is heard of for half a second is known after two looks."""
    monkeypatch.setattr(cli_robots, "time", VirtualTime(look_s=0.3))


def step_later(time: VirtualTime, robots: LinkRobots, robot: Robot) -> None:
    """A step, long enough after the one before that a full status may soon be asked for again."""
    time.sleep(0.25)
    step(robots, robot)


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


def test_a_place_where_nobody_answers_keeps_no_watcher_waiting_for_the_others() -> None:
    endpoint, nobody = free_endpoint(), free_endpoint()
    options = LinkOptions(connect=(nobody, endpoint))
    with listening_robot(endpoint) as robot, open_link_robots(options, refuse_warning) as robots:
        all_heard_by(robots, robot)
        assert robots.problem is None
        assert [*robots.heard] == [ID]


def test_a_robot_that_is_reached_in_two_ways_is_heard_while_there_is_one(virtual_time: VirtualTime) -> None:
    endpoints = [free_endpoint() for _ in range(2)]
    with ExitStack() as opened:
        options = LinkOptions(connect=tuple(endpoints))
        robot = Robot(
            opened.enter_context(open_robot_end("r1", options, print, clock=virtual_time.monotonic_ns))
        )
        ends = [opened.enter_context(ExitStack()) for _ in endpoints]
        for stack, endpoint in zip(ends, endpoints, strict=True):
            stack.enter_context(operator_end(endpoint))
        robots = opened.enter_context(open_link_robots(options, refuse_warning))
        heard_by(robots, robot)
        until(lambda: robot.steps > 5, lambda: step_later(virtual_time, robots, robot))
        assert [*robots.heard] == [ID]
        ends[0].close()
        steps = robot.steps + 5
        until(
            lambda: robots.heard[ID].status.uptime_s > steps, lambda: step_later(virtual_time, robots, robot)
        )
        assert robots.heard[ID].is_present
        assert answered(robots, robot, partial(robots.get, ID, NAMES)) == {NAMES[0]: f"value of {NAMES[0]}"}


@pytest.mark.usefixtures("settles_at_once")
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


@pytest.mark.usefixtures("settles_at_once")
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


@pytest.mark.usefixtures("settles_at_once")
def test_an_unknown_robot_and_one_that_never_answers_are_silent(
    network: Network, virtual_time: VirtualTime
) -> None:
    at = LinkOptions(listen=(endpoint := free_endpoint(),))
    with (
        open_robot_end("r1", at, refuse_warning, clock=virtual_time.monotonic_ns) as end,
        open_link_robots(
            LinkOptions(connect=(endpoint,)), refuse_warning, steady_s=virtual_time.monotonic
        ) as robots,
    ):
        for name in ("r2:/smarttestudo", ID):
            silent = answered(robots, None, partial(robots.get, name, NAMES))
            assert isinstance(silent, SilentNodeError)
        heard_by(robots, Robot(end))
        said: list[Any] = []
        robots.get(ID, NAMES, said.append)
        for _ in range(5):
            robots.wait(0)
            assert said == []
            virtual_time.sleep(1.0)
            network.pass_time(1.0)
        until(lambda: bool(said), lambda: robots.wait(0.02))
        assert str(said[0]).startswith(f"{ID}: error: the robot did not answer within 5 s; check that")
        # Nobody waits for that answer any more.
        assert end.take_question() is None
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


def test_what_is_malformed_on_a_status_key_costs_what_it_touches(virtual_time: VirtualTime) -> None:
    endpoint = free_endpoint()
    at = LinkOptions(connect=(endpoint,))
    with (
        operator_end(endpoint),
        open_robot_end("r1", at, refuse_warning, clock=virtual_time.monotonic_ns) as end,
        watching(endpoint) as robots,
        stranger_at(endpoint) as stranger,
    ):
        robot = Robot(end)

        def tell() -> None:
            step_later(virtual_time, robots, robot)

        for strange in (b"", VERSION, VERSION + b"\5\5\xff", VERSION + b"\4\1[]", b"\xff" * 500):
            until(lambda: ID in robots.heard, tell)
            for key in (end.boot.status_key, "testudo/r1/0000000000000000/status", "testudo/x y/1/status"):
                stranger.put(key, strange)
            steps = robot.steps
            until(lambda: robots.heard[ID].status.uptime_s > steps + 1, tell)  # noqa: B023


def test_a_question_of_many_keys_at_once_reaches_no_robot() -> None:
    endpoint = free_endpoint()
    with operator_end(endpoint), robot_end(endpoint) as end, stranger_at(endpoint) as stranger:
        payload = CHANGING_QUESTIONS.to_bytes(SetParameters(values={"budget_kb_per_s": 1}))
        until(lambda: [*stranger.get(end.boot.set_key, payload=b"?", timeout=1.0)] != [])
        for selector in ("testudo/**", f"{end.boot.key}/*", "testudo/*/*/set"):
            assert not [reply for reply in stranger.get(selector, payload=payload, timeout=1.0) if reply.ok]
        assert end.take_question() is None


@pytest.mark.parametrize(
    "payload",
    [None, b"", b"\0", VERSION, VERSION + b"\x08", VERSION + b"\x09\1", VERSION + b"\x88x", b"\0" * 1_200],
)
def test_a_question_that_is_none_is_refused_at_once(payload: bytes | None) -> None:
    endpoint = free_endpoint()
    with listening_robot(endpoint) as robot, stranger_at(endpoint) as stranger:
        for key in (robot.end.boot.get_key, robot.end.boot.set_key):
            until(partial(_is_refused, stranger, key, payload))
        assert robot.end.take_question() is None


def _is_refused(session: zenoh.Session, key: str, payload: bytes | None) -> bool:
    return [reply.err is not None for reply in session.get(key, payload=payload, timeout=2.0)] == [True]
