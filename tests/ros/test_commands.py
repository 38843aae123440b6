# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo receive --send`` at an operator's and ``testudo run --accept`` on a robot, in two ROS domains."""

from __future__ import annotations

import signal
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from link.zenoh.ends import until
from ros.ros_processes import LINE_TIMEOUT_S, Process, SmallRobot

GOAL_TYPE = "geometry_msgs/msg/PoseStamped"
JOY_TYPE = "sensor_msgs/msg/Joy"
RULES = "begin SetFrequency /odom 10 end"
PAUSED = 30
MAX_AGE_S = 0.5
SENDS = ("--send", "/goal_pose", "/joy")
ACCEPTS = ("--accept", "/goal_pose", "/joy")


def runtime(robot: SmallRobot, endpoint: str, *arguments: str, name: str = "ada") -> Process:
    return robot.runtime(RULES, "--link", endpoint, "--robot", name, *arguments)


def joy(topic: str = "/joy", **others: Any) -> dict[str, Any]:
    return {"type": JOY_TYPE, "topic": topic, **others}


def statuses(
    robot: SmallRobot, *names: str, holds: Callable[[dict[str, Any]], bool] = lambda _: True
) -> dict[str, Any]:
    """What these robots tell, by their names on the link, once it ``holds``."""

    def by_name(nodes: dict[str, Any]) -> dict[str, Any]:
        return {status["robot"]: status for status in nodes.values()}

    # A node that joins a graph finds others one after the other.
    return by_name(
        robot.nodes_told(lambda nodes: by_name(nodes).keys() >= set(names) and holds(by_name(nodes)))
    )


def delivered(told: dict[str, Any], name: str) -> int:
    return int(told[name]["accepted"]["/joy"]["delivered"])


@pytest.mark.contract
def test_a_goal_arrives_byte_for_byte(robot: SmallRobot, operators: SmallRobot, endpoint: str) -> None:
    goal = {"type": GOAL_TYPE, "topic": "/goal_pose", "raw": True, "messages": 3, "reliable": True}
    operators.receiver(endpoint, *SENDS)
    runtime(robot, endpoint, *ACCEPTS)
    here = robot.operator(goal=goal)
    there = operators.operator(goal=goal)
    operators.source(goal_pose={"type": GOAL_TYPE, "hz": 5})
    # Who subscribes beside the source may have found it later than the link did, and may hear it later.
    arrived: list[str] = []
    published: set[str] = set()
    end_s = time.monotonic() + LINE_TIMEOUT_S
    while len(arrived) < 3 or not published >= set(arrived):
        assert time.monotonic() < end_s, f"{len(set(arrived) - published)} messages were never published"
        here.line_with("heard")
        received = [value for _, value, _ in here.result("go on")["goal"]]
        there.line_with("heard")
        published = {value for _, value, _ in there.result("go on")["goal"]}
        known = [place for place, value in enumerate(received) if value in published]
        arrived = received[known[0] :] if known else []
    assert len(set(arrived)) == len(arrived), "stamps tell messages apart"


def stands_still(pid: int) -> bool:
    """Whether each thread of the process has stopped, which takes a moment after the signal."""
    states = [
        task.read_text().rpartition(")")[2].split()[0] for task in Path(f"/proc/{pid}/task").glob("*/stat")
    ]
    return {*states} == {"T"}


def test_nothing_that_waited_while_the_operator_s_process_stood_still_is_delivered(
    robot: SmallRobot, operators: SmallRobot, endpoint: str
) -> None:
    receiving = operators.receiver(endpoint, *SENDS)
    runtime(robot, endpoint, *ACCEPTS)
    station = robot.operator(joy=joy(messages=20))
    beside = operators.operator(joy=joy())
    operators.source(joy={"type": JOY_TYPE, "hz": 20})
    station.line_with("heard")
    receiving.signal(signal.SIGSTOP)
    until(lambda: stands_still(receiving.pid), within_s=LINE_TIMEOUT_S)
    stopped_s = time.monotonic()
    waiting_s: list[float] = []
    # Those that another subscriber had meanwhile wait for the one that stands still.
    while len(waiting_s) < PAUSED:
        beside.line_with("heard")
        waiting_s = [due for _, _, due in beside.result("go on")["joy"] if due > stopped_s]
    time.sleep(MAX_AGE_S)
    going_s = time.monotonic()
    receiving.signal(signal.SIGCONT)
    due_s: list[float] = []
    # Then all of it arrives again, a second long. What a busy machine holds up for too long is dropped.
    while len(due_s) < 20 or due_s[-20] < going_s or due_s[-1] - due_s[-20] > 19.5 / 20:
        assert time.monotonic() < going_s + LINE_TIMEOUT_S, due_s
        station.line_with("heard")
        due_s = [due for _, _, due in station.result("go on")["joy"]]
    assert {*due_s}.isdisjoint(waiting_s)
    assert due_s == sorted(set(due_s))


def test_another_type_at_the_operator_s_costs_that_topic_and_is_said(
    robot: SmallRobot, operators: SmallRobot, endpoint: str
) -> None:
    receiving = operators.receiver(endpoint, *SENDS)
    runtime(robot, endpoint, *ACCEPTS)
    station = robot.operator(
        joy={"type": "std_msgs/msg/String", "topic": "/joy"},
        goal={"type": GOAL_TYPE, "topic": "/goal_pose", "raw": True},
    )
    operators.source(joy={"type": JOY_TYPE, "hz": 5}, goal_pose={"type": GOAL_TYPE, "hz": 5})
    said = receiving.line_with("/joy is not sent to ada")
    assert said.strip().endswith(
        f"  testudo: /joy is not sent to ada: it is {JOY_TYPE} here and std_msgs/msg/String at ada"
    )
    while len((arrived := station.result("go on"))["goal"]) < 5:
        pass
    assert arrived["joy"] == []


@pytest.mark.contract
def test_of_two_robots_only_the_one_that_is_named_is_driven(
    robot: SmallRobot, operators: SmallRobot, endpoint: str
) -> None:
    receiving = operators.receiver(endpoint, "--send", "/joy")
    station = robot.operator(joy=joy())
    runtime(robot, endpoint, "--accept", "/joy")
    runtime(robot, endpoint, "--accept", "/joy", "--ros-args", "-r", "__node:=of_bob", name="bob")
    operators.source(joy={"type": JOY_TYPE, "hz": 20})
    said = receiving.line_with("/joy is not sent to")
    assert "2 robots accept it, and nothing tells which is meant" in said
    receiving.signal(signal.SIGINT)
    assert receiving.exit_code() == 0
    # What left before has come by then.
    told = statuses(
        robot, "ada", "bob", holds=lambda told: not any(one["link"]["connected"] for one in told.values())
    )
    operators.receiver(endpoint, "--send", "/joy", "--output-topic", "/{robot}{topic}")
    operators.source(joy={"type": JOY_TYPE, "hz": 20, "topic": "bob/joy"})
    heard = len(station.result("go on")["joy"])
    while len(station.result("go on")["joy"]) < heard + 20:
        station.line_with("heard")
    now = statuses(robot, "ada", "bob", holds=lambda now: delivered(now, "bob") > delivered(told, "bob"))
    assert delivered(now, "ada") == delivered(told, "ada")


def test_what_is_relayed_does_not_come_back_and_what_is_named_at_one_end_only_is_said(
    robot: SmallRobot, operators: SmallRobot, endpoint: str
) -> None:
    receiving = operators.receiver(endpoint, "--send", "/odom", "/joy")
    running = runtime(robot, endpoint, "--accept", "/odom", "/goal_pose")
    robot.source(odom={"type": "nav_msgs/msg/Odometry", "hz": 20})
    station = operators.operator(odom={"type": "nav_msgs/msg/Odometry", "topic": "/odom", "messages": 20})
    station.line_with("heard")
    for process, sentence in (
        (receiving, "/odom is not sent to ada: it comes from a robot under that name, so it would go round"),
        (receiving, "ada accepts /goal_pose, which is not sent"),
        (receiving, "ada does not accept /joy"),
        (running, "/odom is not accepted from operators: it is relayed to operators under the same name"),
        (running, "An operator sends /joy, which is not accepted"),
        (running, "/goal_pose is accepted, but no operator sends it"),
    ):
        until(lambda: any(sentence in line for line in process.output), within_s=LINE_TIMEOUT_S)  # noqa: B023
    assert statuses(robot, "ada")["ada"]["accepted"]["/odom"]["received"] == 0
