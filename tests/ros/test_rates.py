# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What an operator receives of a running robot."""

from __future__ import annotations

import json
from typing import Any

import pytest

from ros.ros_processes import SmallRobot

IMU = "sensor_msgs/msg/Imu"
ODOMETRY = "nav_msgs/msg/Odometry"
SCAN = "sensor_msgs/msg/LaserScan"
TWIST = "geometry_msgs/msg/Twist"

SOURCES = {
    "imu": {"type": IMU, "hz": 195},
    "odom": {"type": ODOMETRY, "hz": 25.5},
    "scan": {"type": SCAN, "hz": 30},
    "cmd_vel": {"type": TWIST, "hz": 30},
}
TARGETS_HZ = {"imu": 50, "odom": 20, "scan": 20, "cmd_vel": 7}
SPAN_S = 10.0
ATTEMPTS = 3


def rules(rates_hz: dict[str, float]) -> str:
    return (
        "begin\n" + "\n".join(f"SetFrequency /{name} {rate}" for name, rate in rates_hz.items()) + "\nend\n"
    )


def mean_hz(arrivals: list[tuple[float, Any]]) -> float:
    return (len(arrivals) - 1) / (arrivals[-1][0] - arrivals[0][0])


def count_within(stamps_s: list[float], start_s: float, end_s: float) -> int:
    return sum(start_s <= stamp_s < end_s for stamp_s in stamps_s)


def run_once(robot: SmallRobot) -> tuple[dict[str, float], dict[str, float]]:
    """The rates in Hz at which the sources sent and the operator received."""
    operator = robot.operator(span_s=SPAN_S, **SOURCES)
    runtime = robot.runtime(rules(TARGETS_HZ))
    source = robot.source(**SOURCES)
    operator.line_with("heard 1")
    received = operator.result()
    sent = source.result()
    runtime.end()
    return sent, {name: mean_hz(arrivals) for name, arrivals in received.items()}


def test_every_topic_arrives_at_its_rate_within_one_percent(robot: SmallRobot) -> None:
    for _ in range(ATTEMPTS):
        sent_hz, received_hz = run_once(robot)
        if all(sent_hz[name] >= 0.98 * topic["hz"] for name, topic in SOURCES.items()):
            assert received_hz == pytest.approx(TARGETS_HZ, rel=0.01)
            return
    pytest.fail(f"machine too slow: the sources sent at {sent_hz}")


def test_a_robot_that_enters_a_zone_raises_the_rate_of_another_topic(robot: SmallRobot) -> None:
    topics = {"odom": {"type": ODOMETRY, "hz": 20}, "imu": {"type": IMU, "hz": 200}}
    decisions = robot.folder / "decisions.jsonl"
    operator = robot.operator(span_s=2.0, **topics)
    runtime = robot.runtime(
        "begin SetFrequency /odom Full SetFrequency /imu 5 "
        'Rule "Zone" If (CheckValue /odom pose_x > 3) Then SetFrequency /imu 50 EndIf end',
        "--decisions",
        str(decisions),
    )
    source = robot.source(**topics)
    runtime.line_with("/imu: 50 Hz → 5 Hz (default)")
    operator.line_with("heard 2")
    source.say("move")
    operator.line_with("heard 4")
    arrivals = operator.result()

    entered_s = next(at_s for at_s, x in arrivals["odom"] if x == 5)
    imu_s = [at_s for at_s, _ in arrivals["imu"]]
    # A pacer makes up for late messages, so over so short a time a rate is less than exact.
    assert count_within(imu_s, entered_s, entered_s + 1.5) > 2 * count_within(
        imu_s, entered_s - 1.5, entered_s
    )
    last = json.loads(decisions.read_text(encoding="utf-8").splitlines()[-1])
    assert (last["topic"], last["from_hz"], last["to_hz"], last["rule"]) == ("/imu", 5.0, 50.0, "Zone")
    assert last["values"] == {"/odom pose_x": 5.0}


def test_a_rate_counts_in_simulated_time_where_the_robot_does(robot: SmallRobot) -> None:
    operator = robot.operator(span_s=4.0, imu={"type": IMU})
    runtime = robot.runtime(rules({"imu": 10}), "--ros-args", "-p", "use_sim_time:=true")
    runtime.line_with("Waiting for simulated time on /clock")
    twice_as_fast = {"type": "rosgraph_msgs/msg/Clock", "hz": 100, "step_ms": 20}
    source = robot.source(imu={"type": IMU, "hz": 100}, clock=twice_as_fast)
    operator.line_with("heard 1")
    received = operator.result()
    sent_hz = source.result()
    # 80 messages, of which a pacer that makes up for late ones may pass five more or fewer.
    assert mean_hz(received["imu"]) == pytest.approx(10 * sent_hz["clock"] / 50, rel=0.1)
