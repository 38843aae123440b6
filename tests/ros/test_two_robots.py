# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Two robots on one graph, one rule file, and a runtime for each robot."""

from __future__ import annotations

import re
from typing import Any

import pytest

from ros.ros_processes import Process, SmallRobot
from smarttestudo.domain.names import NAME_OPTION

ODOMETRY = "nav_msgs/msg/Odometry"
IMU = "sensor_msgs/msg/Imu"
RULES = (
    "begin SetFrequency /odom Full SetFrequency /imu 5 "
    'Rule "Zone" If (CheckValue /odom pose_x > 3) Then SetFrequency /imu 50 EndIf end'
)
ROBOTS = ("tb3_0", "tb3_1")


def runtime_of(robot: SmallRobot, name: str) -> Process:
    return robot.runtime(RULES, "--topic-prefix", f"/{name}", "--ros-args", "-r", f"__ns:=/{name}")


def source_of(robot: SmallRobot, name: str) -> Process:
    return robot.source(
        **{f"{name}/odom": {"type": ODOMETRY, "hz": 20}, f"{name}/imu": {"type": IMU, "hz": 100}}
    )


@pytest.mark.contract
def test_each_runtime_relays_its_own_robot_only(robot: SmallRobot) -> None:
    topics: dict[str, Any] = {f"{name}/imu": {"type": IMU} for name in ROBOTS}
    operator = robot.operator(**topics)
    runtimes = [runtime_of(robot, name) for name in ROBOTS]
    first, second = (source_of(robot, name) for name in ROBOTS)
    operator.line_with("heard")
    for runtime, name in zip(runtimes, ROBOTS, strict=True):
        runtime.line_with(f"/{name}/imu: 50 Hz → 5 Hz (default)")

    first.say("move")
    assert "/tb3_0/imu: " in runtimes[0].line_with("(block: Zone)")
    assert "(block: Zone)" not in "".join(runtimes[1].output)
    second.say("move")
    assert "/tb3_1/imu: " in runtimes[1].line_with("(block: Zone)")
    for runtime, other in zip(runtimes, reversed(ROBOTS), strict=True):
        assert f"/{other}/" not in "".join(runtime.output)


def test_two_of_one_name_are_both_shown_and_the_log_says_how_to_name_them(
    robot: SmallRobot, endpoint: str
) -> None:
    prefixed = [("--topic-prefix", f"/{name}") for name in ROBOTS]
    first = robot.runtime(RULES, *prefixed[0])
    # Nobody listens at the endpoint.
    second = robot.runtime(RULES, *prefixed[1], "--link", endpoint)
    log = r"\[WARN\] \[[0-9.]+\] \[smarttestudo\]: "
    assert re.match(
        f"{log}another /smarttestudo relays .*, as with {NAME_OPTION}:", first.line_with("another")
    )
    assert re.match(f"{log}{endpoint}: it cannot be reached", second.line_with("cannot be reached"))
    robot.runtime(RULES, *prefixed[1], *NAME_OPTION.split())

    def names(nodes: dict[str, Any]) -> list[str]:
        return sorted(status["node"] for status in nodes.values())

    shown = robot.nodes_told(lambda nodes: len(nodes) == 3)
    assert names(shown) == ["/smarttestudo", "/smarttestudo", "/smarttestudo_2"]
    assert {topic for status in shown.values() for topic in status["topics"]} == {
        f"/{name}/{topic}" for name in ROBOTS for topic in ("imu", "odom")
    }
