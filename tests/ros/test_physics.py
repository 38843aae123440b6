# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Robots with physics on a real graph, under rules."""

from __future__ import annotations

import signal
import sys
import time
from pathlib import Path
from typing import Any

import pytest

from ros.live_incidents import record_of, recorded
from ros.ros_processes import FOLDER, Process, SmallRobot
from ros.test_rates import IMU, JOINTS, ODOMETRY, SCAN, TWIST, mean_hz, received_by

EXAMPLES = Path(__file__).parents[2] / "examples"
INTO_A_RACK = {"type": TWIST, "hz": 10, "twist": [0.26, -0.3]}
IN_THE_HALL_HZ = {"odom": 10, "cmd_vel": 7, "scan": 3, "imu": 10, "joint_states": 3}
TYPES: dict[str, Any] = {
    "odom": {"type": ODOMETRY},
    "cmd_vel": {"type": TWIST},
    "scan": {"type": SCAN},
    "imu": {"type": IMU},
    "joint_states": {"type": JOINTS},
}
SPAN_S = 14.0
SETTLING_S = 1.5
ATTEMPTS = 3


def relay(robot: SmallRobot, example: str, *options: str) -> Process:
    runtime = robot.testudo_run("--rules", str(EXAMPLES / example), *options)
    runtime.line_with("Relaying")
    return runtime


def physics(robot: SmallRobot, *options: str) -> Process:
    simulated = robot.testudo("simulate", "--physics", *options)
    simulated.line_with("with physics (MuJoCo")
    return simulated


def test_it_drives_in_the_background_of_a_shell(robot: SmallRobot) -> None:
    command = (sys.executable, "-m", "smarttestudo", "simulate", "--physics", "--seconds", "1")
    job = robot.command(sys.executable, str(FOLDER.parent / "in_background.py"), *command)
    assert job.exit_code() == 0
    assert "with physics (MuJoCo" in "".join(job.output)


@pytest.mark.calm
def test_under_the_rules_of_the_thesis_every_topic_has_its_rate(robot: SmallRobot) -> None:
    seen = []
    for _ in range(ATTEMPTS):
        seen.append(rates_in_the_hall_hz(robot))
        # The source of a scan is 0.2 s apart, and both ends of the stretch fall on one.
        if seen[-1] == pytest.approx(IN_THE_HALL_HZ, rel=0.04):
            return
        robot.end()
    pytest.fail(f"in no drive were these the rates: {seen}")


def rates_in_the_hall_hz(robot: SmallRobot) -> dict[str, float]:
    """What an operator receives while the robot drives there."""
    operator = robot.operator(span_s=SPAN_S, **TYPES)
    relay(robot, "warehouse.adirf")
    physics(robot)
    operator.line_with("heard 1")
    received = received_by(operator, "stop")
    # Until the robot's place is known, rules monitor more.
    settled_s = max(arrivals[0].at_s for arrivals in received.values()) + SETTLING_S
    return {
        name: mean_hz([one for one in arrivals if one.at_s >= settled_s])
        for name, arrivals in received.items()
    }


def test_rules_on_a_collision_and_on_a_covered_lidar_record_both(robot: SmallRobot) -> None:
    folder = robot.folder / "incidents"
    runtime = relay(robot, "collision.adirf", "--incidents", str(folder))
    robot.source(cmd_vel=INTO_A_RACK)
    physics(robot, "--cover-lidar", "12")
    expected, rules = {"Collision", "LiDAR covered"}, set[str]()
    while rules != expected:
        rules.add(record_of(folder / recorded(runtime))["rule"])


def test_the_quadrotor_takes_off_by_rules_and_says_what_real_time_it_lost(robot: SmallRobot) -> None:
    runtime = relay(robot, "quadrotor.adirf")
    quadrotor = physics(robot, "--robot", "quadrotor", "--battery", "90")
    runtime.line_with("/range: Full → 2 Hz (default)")
    quadrotor.signal(signal.SIGSTOP)
    time.sleep(1.5)
    quadrotor.signal(signal.SIGCONT)
    assert "of real time so far" in quadrotor.line_with("Lost ")
    quadrotor.signal(signal.SIGINT)
    assert quadrotor.exit_code() == 0
