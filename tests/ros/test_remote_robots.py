# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""One contract for robots that are heard and asked: on their ROS graph, and over a link."""

from __future__ import annotations

import hashlib
import json
import signal
import sys
import time
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import pytest

from link.zenoh.ends import refuse_warning
from ros.ros_processes import LINE_TIMEOUT_S, TESTUDO, Process, SmallRobot
from smarttestudo.domain.parameter import SilentNodeError
from smarttestudo.domain.remote_robots import RemoteRobots
from smarttestudo.domain.status import RulesOrigin
from smarttestudo.link.zenoh import open_link_robots
from smarttestudo.link.zenoh.security import LinkOptions
from smarttestudo.robot.ros import open_graph_robots

IMU = "sensor_msgs/msg/Imu"
ID = "tb3:/smarttestudo"
RULES = "begin\n  SetFrequency /imu 10\nend\n"
FASTER = "begin\n  SetFrequency /imu 20\nend\n"
WITHOUT_ROS = f"import sys; sys.modules['rclpy'] = None; {TESTUDO}"


@pytest.fixture
def runtime(robot: SmallRobot, endpoint: str) -> Process:
    runtime = robot.runtime(RULES, "--link-listen", endpoint, "--robot", "tb3")
    runtime.line_with("Relaying")
    robot.source(imu={"type": IMU, "hz": 50})
    return runtime


@pytest.fixture(params=["on the graph", "over the link"])
def robots(
    request: pytest.FixtureRequest,
    runtime: Process,
    domain: int,
    endpoint: str,
    monkeypatch: pytest.MonkeyPatch,
) -> Iterator[RemoteRobots]:
    """The robot, once it was heard and its source is there."""
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    on_graph = request.param == "on the graph"
    options = LinkOptions(connect=(endpoint,))
    opened: Any = open_graph_robots("onlooker") if on_graph else open_link_robots(options, refuse_warning)
    with opened as robots:
        wait(robots, lambda: ID in robots.heard and robots.heard[ID].status.topics["/imu"].publishers > 0)
        # Discovery brings the node's services in an order of its own.
        ask = partial(robots.get, ID, ["rules_hash"])
        wait(robots, lambda: not isinstance(answered(robots, ask), SilentNodeError))
        yield robots


def wait(robots: RemoteRobots, condition: Callable[[], bool]) -> None:
    end_s = time.monotonic() + LINE_TIMEOUT_S
    while not condition():
        assert time.monotonic() < end_s, "it took too long"
        robots.wait(0.05)


def answered(robots: RemoteRobots, ask: Callable[[Callable[[Any], None]], None]) -> Any:
    said: list[Any] = []
    ask(said.append)
    wait(robots, lambda: bool(said))
    return said[0]


def test_a_robot_is_heard_with_its_name(robots: RemoteRobots) -> None:
    assert robots.heard.keys() == {ID}
    wait(robots, lambda: robots.has_heard_all)
    assert (robots.problem, robots.unreadable) == (None, 0)
    heard = robots.heard[ID]
    assert (heard.status.robot, heard.status.node, heard.is_present) == ("tb3", "/smarttestudo", True)
    wait(robots, lambda: robots.heard[ID].status.stamp_ns > heard.status.stamp_ns)


def test_parameters_are_read_and_those_that_it_lacks_are_none(robots: RemoteRobots) -> None:
    values = answered(robots, partial(robots.get, ID, ["rules_hash", "status_hz", "budget_kb_per_s"]))
    sha256 = hashlib.sha256(RULES.encode()).hexdigest()
    assert values == {"rules_hash": sha256, "status_hz": 1.0, "budget_kb_per_s": None}
    assert answered(robots, partial(robots.get, ID, ["no_such_thing"])) == {"no_such_thing": None}
    texts = answered(robots, partial(robots.get, ID, ["rules_in_force"]))["rules_in_force"]
    assert json.loads(texts)["files"][0]["text"] == RULES


def test_what_is_set_counts_and_what_is_refused_is_told_in_the_robot_s_words(robots: RemoteRobots) -> None:
    refused = answered(robots, partial(robots.set, ID, {"status_hz": 21.0}))
    assert "from 1 to 20" in refused["status_hz"]
    read_only = answered(robots, partial(robots.set, ID, {"rules_hash": "", "output_topic": "/x{topic}"}))
    assert read_only.keys() == {"rules_hash", "output_topic"}
    assert answered(robots, partial(robots.set, ID, {"status_hz": 10.0, "budget_kb_per_s": 50.0})) == {}
    wait(robots, lambda: robots.heard[ID].status.status_hz == 10)
    wait(robots, lambda: robots.heard[ID].status.budget_kb_per_s == 50)


@pytest.mark.contract
def test_pushed_rules_are_tried_and_confirmed(robots: RemoteRobots) -> None:
    sha256 = hashlib.sha256(FASTER.encode()).hexdigest()
    # There are ten seconds from here to the confirmation.
    assert answered(robots, partial(robots.set, ID, {"status_hz": 20.0})) == {}
    wait(robots, lambda: robots.heard[ID].status.status_hz == 20)
    assert answered(robots, partial(robots.set, ID, {"rules_text": FASTER})) == {}
    wait(robots, lambda: robots.heard[ID].status.rules.origin is RulesOrigin.WAITING)
    wait(robots, lambda: robots.heard[ID].status.topics["/imu"].target_hz == 20)
    assert answered(robots, partial(robots.set, ID, {"confirm_hash": "ab" * 32})).keys() == {"confirm_hash"}
    assert answered(robots, partial(robots.set, ID, {"confirm_hash": sha256})) == {}
    wait(robots, lambda: robots.heard[ID].status.rules.origin is RulesOrigin.PUSHED)


def test_pushed_rules_that_nobody_confirms_are_rolled_back(robots: RemoteRobots, runtime: Process) -> None:
    assert answered(robots, partial(robots.set, ID, {"rules_text": FASTER})) == {}
    runtime.line_with("pushed rules not confirmed within 10 s")
    wait(robots, lambda: robots.heard[ID].status.rules.origin is RulesOrigin.FILES)
    assert robots.heard[ID].status.topics["/imu"].target_hz == 10


def test_the_topics_are_those_of_the_robot_s_own_nodes(robots: RemoteRobots) -> None:
    # On a graph, discovery finds the publishers of a node after its status may have come.
    wait(robots, lambda: answered(robots, partial(robots.topics, ID)) == {"/imu": IMU})
    assert answered(robots, partial(robots.topics, None)) == {"/imu": IMU}


def test_nobody_answers_for_an_unknown_robot_or_one_that_was_killed(
    robots: RemoteRobots, runtime: Process
) -> None:
    stranger = answered(robots, partial(robots.get, "ada:/stranger", ["rules_hash"]))
    assert isinstance(stranger, SilentNodeError)
    assert stranger.place == "ada:/stranger"
    runtime.signal(signal.SIGKILL)
    runtime.exit_code()
    for ask in (partial(robots.get, ID, ["rules_hash"]), partial(robots.set, ID, {"status_hz": 2.0})):
        assert isinstance(answered(robots, ask), SilentNodeError)


def without_ros(robot: SmallRobot, *arguments: str) -> tuple[int, str]:
    """The exit code and the output of ``testudo`` where rclpy cannot be imported."""
    process = robot.command(sys.executable, "-c", WITHOUT_ROS, *arguments)
    return process.exit_code(), "".join(process.output)


@pytest.mark.contract
def test_without_ros_top_shows_the_robots_behind_an_operator_s_end(robot: SmallRobot, endpoint: str) -> None:
    robot.testudo("receive", "--no-ros", "--record", str(robot.folder / "r"), "--listen", endpoint)
    names = ("ada", "bob")
    for name in names:
        runtime = robot.runtime(
            RULES, "--link", endpoint, "--robot", name, "--ros-args", "-r", f"__ns:=/{name}"
        )
        runtime.line_with("Relaying")
    ids, nodes = {f"{name}:/{name}/smarttestudo" for name in names}, dict[str, Any]()
    end_s = time.monotonic() + LINE_TIMEOUT_S
    # A robot's end may connect to the operator's later than the other one.
    while nodes.keys() != ids:
        assert time.monotonic() < end_s, nodes.keys()
        code, shown = without_ros(robot, "top", "--once", "--json", "--connect", endpoint, "--timeout", "60")
        assert code == 0
        nodes = json.loads(shown)["nodes"]
        assert nodes.keys() <= ids
    assert nodes["ada:/ada/smarttestudo"]["topics"].keys() == {"/imu"}
    code, shown = without_ros(robot, "top", "--once", "--connect", endpoint, "--timeout", "60")
    assert (code, shown.count("/imu ")) == (0, 2)
    rules = robot.folder / "to_check.adirf"
    rules.write_text(RULES)
    code, shown = without_ros(robot, "check", str(rules), "--connect", endpoint)
    assert (code, "several robots are heard: ada, bob; name one with --robot" in shown) == (2, True)


def test_without_ros_rules_are_checked_against_what_the_robot_publishes(
    robot: SmallRobot, runtime: Process, endpoint: str
) -> None:
    rules = robot.folder / "to_check.adirf"
    rules.write_text("begin\n  SetFrequency /imu 10\n  SetFrequency /nowhere 5\nend\n")
    end_s = time.monotonic() + LINE_TIMEOUT_S
    runtime.line_with("/imu")
    # The robot's end may not have discovered its source yet.
    while "/imu" in (answer := without_ros(robot, "check", str(rules), "--connect", endpoint))[1]:
        assert time.monotonic() < end_s, answer
    code, shown = answer
    assert code == 0, shown
    assert "the robot publishes no /nowhere" in shown
    code, shown = without_ros(robot, "check", str(rules), "--connect", endpoint, "--robot", "bob")
    assert (code, "there is no robot 'bob', but tb3" in shown) == (2, True)
