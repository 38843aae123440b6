# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What goes wrong on a robot costs what it touches, and no more."""

from __future__ import annotations

import signal
from typing import Any

import pytest

from ros.calm_window import Arrival, calm_window
from ros.ros_processes import SmallRobot, told_apart

BOOL = "std_msgs/msg/Bool"
CLOCK = "rosgraph_msgs/msg/Clock"
IMU = "sensor_msgs/msg/Imu"
ODOMETRY = "nav_msgs/msg/Odometry"
TEXT = "std_msgs/msg/String"
SPAN_S = 3.0
ATTEMPTS = 30


@pytest.mark.contract
def test_killing_the_runtime_leaves_the_robot_alone_and_a_new_one_takes_over(robot: SmallRobot) -> None:
    on_board = robot.operator(imu={"type": IMU, "topic": "/imu"})
    operator = robot.operator(imu={"type": IMU})
    robot.source(imu={"type": IMU, "hz": 50})
    runtime = robot.runtime("begin SetFrequency /imu 10 end")
    operator.line_with("heard")

    runtime.signal(signal.SIGKILL)
    assert runtime.exit_code() == -signal.SIGKILL
    on_board.result("go on")
    for _ in range(20):
        on_board.line_with("heard")

    operator.result("go on")
    robot.runtime("begin SetFrequency /imu 10 end")
    operator.line_with("heard")


@pytest.mark.contract
def test_context_that_is_broken_or_silent_asks_for_more_not_for_less(robot: SmallRobot) -> None:
    runtime = robot.runtime(
        "begin SetFrequency /imu 5 "
        'Rule "Zone" If (CheckValue /odom pose_x > 3) Then SetFrequency /imu 50 EndIf end'
    )
    source = robot.source(odom={"type": ODOMETRY, "hz": 20}, imu={"type": IMU, "hz": 100})
    runtime.line_with("/imu: 50 Hz → 5 Hz (default)")
    source.say("spoil odom")
    runtime.line_with("/odom: a message could not be decoded; what checks read is unknown then")
    runtime.line_with("/imu: 5 Hz → 50 Hz (unknown: Zone)")
    source.say("heal odom")
    runtime.line_with("/imu: 50 Hz → 5 Hz (default)")
    source.say("hush odom")
    runtime.line_with("/imu: 5 Hz → 50 Hz (unknown: Zone)")
    operator = robot.operator(imu={"type": IMU})
    operator.line_with("heard")


@pytest.mark.calm
def test_simulated_time_that_jumps_back_leaves_the_relays_at_their_rates(robot: SmallRobot) -> None:
    operator = robot.operator(imu={"type": IMU})
    robot.runtime("begin SetFrequency /imu 10 end", "--ros-args", "-p", "use_sim_time:=true")
    clock = {"type": CLOCK, "hz": 100, "from_s": 10_000, "step_ms": 10}
    source = robot.source(imu={"type": IMU, "hz": 100}, clock=clock)
    operator.line_with("heard")
    source.say("rewind clock")
    heard = len(operator.result("go on")["imu"]) + 10
    for _ in range(ATTEMPTS):
        for _ in range(50):
            operator.line_with("heard")
        later = [Arrival(*one) for one in operator.result("go on")["imu"][heard:]]
        window = calm_window({"imu": later}, SPAN_S)
        if window is not None:
            arrivals = window["imu"]
            mean_hz = (len(arrivals) - 1) / (arrivals[-1].at_s - arrivals[0].at_s)
            assert mean_hz == pytest.approx(10, rel=0.05)
            return
    pytest.fail(f"the machine was never calm for {SPAN_S} s")


def test_an_event_that_says_true_and_goes_silent_arrives(robot: SmallRobot) -> None:
    operator = robot.operator(estop={"type": BOOL})
    robot.runtime("begin SetFrequency /estop 1 end")
    source = robot.source(estop={"type": BOOL, "hz": 50})
    operator.line_with("heard")
    source.say("press estop")
    while operator.result("go on")["estop"][-1][1] is not True:
        operator.line_with("heard")


@told_apart
def test_what_one_publisher_latched_survives_another_that_says_much(robot: SmallRobot) -> None:
    robot.runtime("begin SetFrequency /map_name Full end").line_with("publishers told apart")
    robot.source(
        map_name={"type": TEXT, "texts": ["ground floor"]},
        robot_name={"type": TEXT, "topic": "map_name", "hz": 50, "transient_local": True},
    )
    latched = {"type": TEXT, "transient_local": True, "values": ["ground floor"]}
    robot.operator(map_name={**latched, "messages": 50}).line_with("heard")
    robot.operator(map_name=latched).line_with("heard")


def test_two_hundred_topics_come_at_once(robot: SmallRobot) -> None:
    topics: dict[str, Any] = {f"topic{number}": {"type": TEXT, "hz": 2} for number in range(200)}
    operator = robot.operator(**topics)
    rules = "\n".join(f"SetFrequency /{name} 1" for name in topics)
    robot.runtime(f"begin\n{rules}\nend")
    robot.source(**topics)
    operator.line_with("heard")
