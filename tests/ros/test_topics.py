# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Topics that come late, come back otherwise, or are none of the robot's."""

from __future__ import annotations

from typing import Any

import pytest

from ros.ros_processes import SmallRobot, on_every_data_path, told_apart

IMU = "sensor_msgs/msg/Imu"
ODOMETRY = "nav_msgs/msg/Odometry"
TEXT = "std_msgs/msg/String"


@on_every_data_path
@pytest.mark.contract
def test_a_late_subscriber_gets_the_latched_message_of_each_publisher(robot: SmallRobot) -> None:
    latched: dict[str, Any] = {"map_name": {"type": TEXT, "transient_local": True, "messages": 2}}
    robot.runtime("begin SetFrequency /map_name Full end")
    robot.source(map_name={"type": TEXT, "texts": ["ground floor", "first floor"]})
    robot.operator(**latched).line_with("heard")
    late = robot.operator(**latched)
    late.line_with("heard")
    assert sorted(text for _, text, _ in late.result()["map_name"]) == ["first floor", "ground floor"]


@on_every_data_path
def test_a_topic_whose_output_has_a_name_too_long_for_ros_costs_itself_alone(robot: SmallRobot) -> None:
    long = "a" * 239
    runtime = robot.testudo_run()
    robot.source(**{long: {"type": IMU, "hz": 50}, "imu": {"type": IMU, "hz": 50}})
    runtime.line_with(f"/{long}: error: its name here would have 248 letters, and ROS 2 takes 247")
    robot.operator(imu={"type": IMU}).line_with("heard")


@on_every_data_path
def test_a_source_that_comes_back_with_another_qos_is_relayed_again(robot: SmallRobot) -> None:
    operator = robot.operator(imu={"type": IMU})
    runtime = robot.runtime("begin SetFrequency /imu Full end")
    source = robot.source(imu={"type": IMU, "hz": 50})
    operator.line_with("heard")
    source.end()
    robot.source(imu={"type": IMU, "hz": 50, "reliable": False})
    runtime.line_with("/imu: sensor_msgs/msg/Imu, best effort")
    again = robot.operator(imu={"type": IMU})
    again.line_with("heard")


@pytest.mark.contract
def test_what_another_smarttestudo_relays_is_not_relayed_again(robot: SmallRobot) -> None:
    operator = robot.operator(imu={"type": IMU})
    robot.runtime("begin SetFrequency /imu 10 end")
    robot.source(imu={"type": IMU, "hz": 50})
    operator.line_with("heard")
    second = robot.runtime("begin SetFrequency /testudo/imu 5 end", "--ros-args", "-r", "__node:=second")
    second.line_with("/testudo/imu: only SmartTestudo nodes publish it, so it is not relayed")


@pytest.mark.contract
def test_the_last_decisions_are_there_for_a_late_subscriber(robot: SmallRobot) -> None:
    robot.runtime("begin SetFrequency /imu 10 end").line_with("/imu: 10 Hz (default)")
    operator = robot.operator(decisions={"type": TEXT, "transient_local": True})
    operator.line_with("heard")
    (_, line, _), *_ = operator.result()["decisions"]
    assert '"topic": "/imu"' in line


@pytest.mark.contract
def test_a_topic_is_heard_only_while_an_operator_listens(robot: SmallRobot) -> None:
    runtime = robot.runtime("begin SetFrequency /imu Full SetFrequency /map_name Full end")
    robot.source(imu={"type": IMU, "hz": 50}, map_name={"type": TEXT, "texts": ["ground floor"]})
    runtime.line_with("not subscribed, because there is no subscriber")
    runtime.line_with("not subscribed, because there is no subscriber")
    topics: dict[str, Any] = {"imu": {"type": IMU}, "map_name": {"type": TEXT, "transient_local": True}}
    operator = robot.operator(**topics)
    operator.line_with("heard")
    operator.result()
    runtime.line_with(": not subscribed, because there is no subscriber")
    runtime.line_with(": not subscribed, because there is no subscriber")
    again = robot.operator(**topics)
    again.line_with("heard")
    assert [text for _, text, _ in again.result()["map_name"]] == ["ground floor"]


@on_every_data_path
def test_a_topic_that_comes_back_with_another_type_is_relayed_again(robot: SmallRobot) -> None:
    runtime = robot.runtime("begin SetFrequency /pose Full end")
    source = robot.source(pose={"type": IMU, "hz": 50})
    robot.operator(pose={"type": IMU}).line_with("heard")
    source.say("stop")
    runtime.line_with("/pose: no publisher left")
    robot.source(pose={"type": ODOMETRY, "hz": 50})
    robot.operator(pose={"type": ODOMETRY}).line_with("heard")


@pytest.mark.contract
def test_an_operator_who_asks_for_too_much_is_named(robot: SmallRobot) -> None:
    runtime = robot.runtime("begin SetFrequency /imu Full end")
    robot.source(imu={"type": IMU, "hz": 50, "reliable": False})
    robot.operator(imu={"type": IMU, "reliable": True})
    runtime.line_with("/testudo/imu: /operator asks for reliable delivery, which this relay does not offer")


@told_apart
def test_what_another_smarttestudo_sends_on_a_topic_of_the_robot_is_left_out(robot: SmallRobot) -> None:
    robot.source(
        odom={"type": ODOMETRY, "hz": 50, "x": 1.0},
        own={"type": ODOMETRY, "topic": "testudo/odom", "hz": 50, "x": 7.0},
    )
    second = robot.runtime("begin SetFrequency /odom Full end", "--ros-args", "-r", "__node:=second")
    first = robot.runtime("begin SetFrequency /testudo/odom Full end")
    first.line_with("/testudo/odom: a SmartTestudo node publishes it too; its messages are not relayed")
    operator = robot.operator(odom={"type": ODOMETRY, "topic": "/testudo/testudo/odom"})
    second.line_with("/odom: subscribed, because there is a subscriber")
    operator.result("go on")
    for _ in range(20):
        operator.line_with("heard")
    assert {x for _, x, _ in operator.result()["odom"]} == {7.0}
