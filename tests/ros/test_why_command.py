# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo why`` of a running robot, on its graph and over a link, and its newest decision."""

from __future__ import annotations

import json
from typing import Any

import pytest

from ros.ros_processes import LINE_TIMEOUT_S, Process, SmallRobot

ODOM = {"type": "nav_msgs/msg/Odometry", "hz": 20}
RULES = """begin
  SetFrequency /odom 10
  Rule "Near" If (CheckValue /odom pose_x < 5 AND CheckValue /odom pose_y < 3) Then SetFrequency /odom 4
end
"""
BEYOND = [
    ("/odom pose_x", [(">= 5", 10.0, "default")]),
    ("/odom pose_y", [(">= 3", 10.0, "default")]),
]


@pytest.fixture
def runtime(robot: SmallRobot, endpoint: str) -> Process:
    runtime = robot.runtime(RULES, "--link-listen", endpoint, "--robot", "tb3")
    robot.source(odom=ODOM)
    runtime.line_with("(block: Near)")
    return runtime


def told(robot: SmallRobot, *arguments: str) -> Any:
    command = robot.testudo(*arguments)
    assert command.exit_code() == 0, "".join(command.output)
    return json.loads(next(line for line in command.output if line.startswith("{")))


@pytest.mark.contract
@pytest.mark.parametrize("place", ["on the graph", "over the link"])
@pytest.mark.usefixtures("runtime")
def test_rate_rule_values_and_borders_are_said_of_a_running_robot(
    robot: SmallRobot, endpoint: str, place: str
) -> None:
    connect = () if place == "on the graph" else ("--connect", endpoint)
    why = told(robot, "why", "/odom", "--json", "--timeout", f"{LINE_TIMEOUT_S:g}", *connect)
    assert (why["to_hz"], why["rule"], why["line"], why["asked"]["to_hz"]) == (4.0, "Near", 3, 4.0)
    assert all(one["value"] is not None for one in why["values"])
    borders = [
        (one["signal"], [(each["where"], each["to_hz"], each["reason"]) for each in one["borders"]])
        for one in why["values"]
    ]
    assert borders == BEYOND


@pytest.mark.usefixtures("runtime")
def test_echo_once_gives_the_newest_decision(robot: SmallRobot) -> None:
    echo = told(robot, "echo", "/testudo/decisions", "--once", "--json", "--full-length", "--timeout", "60")
    assert json.loads(echo["values"]["data"])["rule"] == "Near"
    assert echo["messages"] > 1
