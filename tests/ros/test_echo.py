# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""testudo echo on a real graph."""

from __future__ import annotations

import json
import signal

import pytest

from ros.ros_processes import SmallRobot

IMU = "sensor_msgs/msg/Imu"
ODOMETRY = "nav_msgs/msg/Odometry"
TEXT = "std_msgs/msg/String"


@pytest.mark.contract
def test_it_is_a_subscriber_so_the_relay_begins_and_its_rate_is_seen(robot: SmallRobot) -> None:
    runtime = robot.runtime("begin SetFrequency /odom 10 end")
    robot.source(odom={"type": ODOMETRY, "hz": 50, "x": 1.5})
    echo = robot.testudo("echo", "/testudo/odom", "--fields", "pose_x", "header.stamp")
    runtime.line_with("/odom: subscribed, because there is a subscriber")
    while " – Hz" in (line := echo.line_with("/testudo/odom  ")):
        pass
    assert line.startswith("/testudo/odom  ")
    assert " Hz  " in line
    assert " KB/s  " in line
    assert " messages  pose_x: 1.5  header.stamp.sec: " in line
    echo.signal(signal.SIGINT)
    assert echo.exit_code() == 0
    assert "Traceback" not in "".join(echo.output)


def test_its_qos_follows_the_publishers(robot: SmallRobot) -> None:
    robot.source(
        imu={"type": IMU, "hz": 50, "reliable": False}, map_name={"type": TEXT, "texts": ["ground floor"]}
    )
    echo = robot.testudo("echo", "imu", "map_name", "--once", "--json", "--timeout", "60")
    assert echo.exit_code() == 0
    messages = [json.loads(line) for line in echo.output if line.startswith("{")]
    heard = {message["topic"]: message for message in messages}
    assert heard["/map_name"]["values"] == {"data": "ground floor"}
    assert heard["/imu"]["type"] == IMU
    assert heard["/imu"]["values"]["orientation_covariance"] == [0.0] * 8 + ["… 1 more"]


def test_as_many_messages_are_printed_whole_as_asked_for(robot: SmallRobot) -> None:
    # Slow, so that a busy machine loses none of them.
    robot.source(name={"type": TEXT, "hz": 2})
    echo = robot.testudo("echo", "/name", "--count", "3")
    assert echo.exit_code() == 0
    assert [line.split("  ")[2] for line in echo.output if TEXT in line] == [
        "message 1",
        "message 2",
        "message 3",
    ]
    numbers = [int(line.removeprefix("data: ")) for line in echo.output if line.startswith("data: ")]
    assert numbers == list(range(numbers[0], numbers[0] + 3))


def test_an_unknown_topic_is_waited_for_and_then_the_similar_one_is_named(robot: SmallRobot) -> None:
    robot.source(odom={"type": ODOMETRY, "hz": 20}).line_with("ready")
    echo = robot.testudo("echo", "/odm", "--timeout", "10")
    echo.line_with("note: /odm: waiting for a publisher")
    echo.line_with("/odm: error: nobody published it within 10 s; did you mean /odom?")
    assert echo.exit_code() == 1
