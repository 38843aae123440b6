# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What an operator receives of a running robot."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import pytest

from ros.calm_window import Arrival, calm_window
from ros.ros_processes import Process, SmallRobot

IMU = "sensor_msgs/msg/Imu"
ODOMETRY = "nav_msgs/msg/Odometry"
SCAN = "sensor_msgs/msg/LaserScan"
JOINTS = "sensor_msgs/msg/JointState"
TWIST = "geometry_msgs/msg/Twist"

SOURCES: dict[str, Any] = {
    "odom": {"type": ODOMETRY, "hz": 25.5},
    "scan": {"type": SCAN, "hz": 30},
    "cmd_vel": {"type": TWIST, "hz": 30},
    "imu": {"type": IMU, "hz": 195},
    "joint_states": {"type": JOINTS, "hz": 1000},
}
TARGETS_HZ = {"odom": 20, "scan": 20, "cmd_vel": 4, "imu": 50, "joint_states": 100}
SPAN_S = 10.0
RUN_S = 13.0
ATTEMPTS = 15


def rules(rates_hz: Mapping[str, float]) -> str:
    return (
        "begin\n" + "\n".join(f"SetFrequency /{name} {rate}" for name, rate in rates_hz.items()) + "\nend\n"
    )


def received_by(operator: Process, line: str) -> dict[str, list[Arrival]]:
    return {name: [Arrival(*one) for one in arrivals] for name, arrivals in operator.result(line).items()}


def mean_hz(arrivals: list[Arrival]) -> float:
    return (len(arrivals) - 1) / (arrivals[-1].at_s - arrivals[0].at_s)


def most_within(arrivals: list[Arrival], span_s: float) -> int:
    """The most messages that were due within ``span_s``."""
    due_s = [one.due_s for one in arrivals]
    return max(sum(start_s <= at_s < start_s + span_s for at_s in due_s) for start_s in due_s)


@pytest.mark.calm
def test_every_topic_arrives_at_its_rate_within_one_percent_and_a_message(robot: SmallRobot) -> None:
    operator = robot.operator(span_s=RUN_S, **SOURCES)
    robot.runtime(rules(TARGETS_HZ))
    robot.source(**SOURCES)
    for attempt in range(1, ATTEMPTS + 1):
        operator.line_with(f"heard {attempt}")
        received = calm_window(received_by(operator, "go on"), SPAN_S)
        if received is not None:
            for name, target_hz in TARGETS_HZ.items():
                assert mean_hz(received[name]) == pytest.approx(target_hz, abs=0.01 * target_hz + 1 / SPAN_S)
            return
    pytest.fail("machine too slow: in no ten seconds did the messages come promptly")


@pytest.mark.contract
def test_a_robot_that_enters_a_zone_raises_the_rate_of_another_topic(robot: SmallRobot) -> None:
    topics = {"odom": {"type": ODOMETRY, "hz": 20}, "imu": {"type": IMU, "hz": 200}}
    decisions = robot.folder / "decisions.jsonl"
    runtime = robot.runtime(
        "begin SetFrequency /odom Full SetFrequency /imu 5 "
        'Rule "Zone" If (CheckValue /odom pose_x > 3) Then SetFrequency /imu 50 EndIf end',
        "--decisions",
        str(decisions),
    )
    source = robot.source(**topics)
    runtime.line_with("/imu: 50 Hz → 5 Hz (default)")
    # A pacer that aims at 5 Hz lets at most 9 messages pass in a second.
    operator = robot.operator(odom={"type": ODOMETRY}, imu={"type": IMU, "messages": 25, "within_s": 1.0})
    source.say("move odom")
    runtime.line_with("/imu: 5 Hz → 50 Hz (block: Zone)")
    operator.line_with("heard")

    last = json.loads(decisions.read_text(encoding="utf-8").splitlines()[-1])
    assert (last["topic"], last["from_hz"], last["to_hz"], last["rule"]) == ("/imu", 5.0, 50.0, "Zone")
    assert last["values"] == {"/odom pose_x": 5.0}


@pytest.mark.contract
def test_a_rate_counts_in_simulated_time_where_the_robot_does(robot: SmallRobot) -> None:
    # At 10 Hz at most 25 messages pass in 2 s of real time, and 45 in the 4 s that it is here.
    operator = robot.operator(imu={"type": IMU, "messages": 32, "within_s": 2.0})
    runtime = robot.runtime(rules({"imu": 10}), "--ros-args", "-p", "use_sim_time:=true")
    runtime.line_with("Waiting for simulated time on /clock")
    twice_as_fast = {"type": "rosgraph_msgs/msg/Clock", "hz": 100, "step_ms": 20}
    robot.source(imu={"type": IMU, "hz": 100}, clock=twice_as_fast)
    operator.line_with("heard")
    assert most_within(received_by(operator, "stop")["imu"], 2.0) < 100
