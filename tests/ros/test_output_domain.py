# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A radio that carries the relays and nothing else: operators in a ROS domain of their own."""

from __future__ import annotations

import pytest

from ros.ros_processes import SmallRobot

IMU = "sensor_msgs/msg/Imu"
RULES = "begin SetFrequency /imu 10 SetFrequency /camera Off end"


@pytest.mark.contract
def test_operators_in_another_domain_find_the_relays_and_nothing_else(
    robot: SmallRobot, other_domain: int
) -> None:
    robot.runtime(RULES, "--output-domain", str(other_domain), "--output-topic", "{topic}")
    robot.source(imu={"type": IMU, "hz": 50}, lidar={"type": IMU, "hz": 50})
    operator = robot.operator(domain=other_domain, imu={"type": IMU, "topic": "/imu"})
    operator.line_with("heard")
    told = {"/testudo/decisions", "/testudo/status", "/diagnostics"}
    of_every_node = {"/rosout", "/parameter_events"}
    assert operator.topics() - of_every_node == {"/imu", *told}


@pytest.mark.parametrize(
    ("arguments", "place"),
    [
        (("--output-domain", "{domain}"), "--output-domain: error: the robot itself is in domain"),
        (("--output-discovery", "subnet"), "--output-discovery: error: "),
        (("--output-domain", "233"), "--output-domain: error: a ROS domain is a number from 0 to 232"),
    ],
)
def test_an_output_domain_that_is_none_is_refused(
    robot: SmallRobot, domain: int, arguments: tuple[str, ...], place: str
) -> None:
    runtime = robot.runtime(RULES, *(one.format(domain=domain) for one in arguments))
    assert runtime.exit_code() == 2
    assert place in runtime.output[-1]
    assert "Traceback" not in "".join(runtime.output)
