# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import itertools
import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from simulation.missions import of_topic, poses, stamp_ns
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.simulation.geometry import BodyVelocity, Pose
from smarttestudo.simulation.messages import RobotTopic, TimedMessage
from smarttestudo.simulation.robot import DifferentialDrive, DriveModel
from smarttestudo.simulation.warehouse import patrol

COMMANDS = st.builds(BodyVelocity, st.floats(-0.26, 0.26), st.floats(-1.82, 1.82))
PLANS = st.lists(st.tuples(COMMANDS, st.integers(1, NS_PER_S)), min_size=1, max_size=6)


def _drive() -> DifferentialDrive:
    return DifferentialDrive(DriveModel(), pose=Pose(0.0, 0.0, 0.0), now_ns=0)


def _euler(plan: list[tuple[BodyVelocity, int]], dt_s: float) -> Pose:
    """The naive second opinion: body speeds from wheel speeds, summed in tiny steps."""
    model = DriveModel()
    x = y = yaw = left = right = 0.0
    for command, duration_ns in plan:
        half = command.angular_rad_per_s * model.wheel_separation_m / 2
        steps = max(1, round(duration_ns / NS_PER_S / dt_s))
        dt = duration_ns / NS_PER_S / steps
        for _ in range(steps):
            gain = model.wheel_acceleration_m_per_s2 * dt
            left += max(-gain, min(gain, command.linear_m_per_s - half - left))
            right += max(-gain, min(gain, command.linear_m_per_s + half - right))
            x += (left + right) / 2 * math.cos(yaw) * dt
            y += (left + right) / 2 * math.sin(yaw) * dt
            yaw += (right - left) / model.wheel_separation_m * dt
    return Pose(x, y, yaw)


@settings(max_examples=25, deadline=None)
@given(plan=PLANS)
def test_the_motion_agrees_with_a_sum_of_tiny_steps(plan: list[tuple[BodyVelocity, int]]) -> None:
    drive = _drive()
    for command, duration_ns in plan:
        drive.command(command)
        drive.advance_to(drive.now_ns + duration_ns)

    expected = _euler(plan, 2e-4)

    assert drive.pose.x_m == pytest.approx(expected.x_m, abs=3e-3)
    assert drive.pose.y_m == pytest.approx(expected.y_m, abs=3e-3)
    assert drive.pose.yaw_rad == pytest.approx(expected.yaw_rad, abs=1e-2)


@settings(max_examples=25, deadline=None)
@given(plan=PLANS)
def test_the_heading_is_what_the_wheels_have_rolled(plan: list[tuple[BodyVelocity, int]]) -> None:
    drive = _drive()
    for command, duration_ns in plan:
        drive.command(command)
        drive.advance_to(drive.now_ns + duration_ns)

    left_rad, right_rad = drive.angles_rad

    rolled_rad = (right_rad - left_rad) * drive.model.wheel_radius_m / drive.model.wheel_separation_m
    assert drive.pose.yaw_rad == pytest.approx(rolled_rad, abs=1e-9)


@given(command=COMMANDS)
@settings(max_examples=50, deadline=None)
def test_no_wheel_gains_speed_faster_than_its_acceleration(command: BodyVelocity) -> None:
    drive = _drive()
    drive.command(command)
    before = drive.rim_m_per_s

    for step in range(1, 40):
        drive.advance_to(step * 10_000_000)
        for old, new in zip(before, drive.rim_m_per_s, strict=True):
            assert abs(new - old) <= drive.model.wheel_acceleration_m_per_s2 * 0.01 + 1e-12
        before = drive.rim_m_per_s


def test_a_steady_command_drives_a_circle_of_radius_speed_over_turn_rate() -> None:
    drive = _drive()
    drive.command(BodyVelocity(0.2, 0.5))
    drive.advance_to(NS_PER_S)
    centre = Pose(drive.pose.x_m, drive.pose.y_m, drive.pose.yaw_rad + math.pi / 2).ahead(0.2 / 0.5)

    for second in range(2, 20):
        drive.advance_to(second * NS_PER_S)
        assert math.hypot(drive.pose.x_m - centre.x_m, drive.pose.y_m - centre.y_m) == pytest.approx(
            0.4, abs=1e-4
        )


def test_the_commands_of_a_patrol_add_up_to_its_odometry(patrol_messages: list[TimedMessage]) -> None:
    commands = of_topic(patrol_messages, RobotTopic.CMD_VEL)
    way = list(poses(patrol_messages).values())

    commanded_m = sum(command.linear.x for command in commands) / 10
    commanded_rad = sum(command.angular.z for command in commands) / 10
    driven_m = sum(math.hypot(b.x_m - a.x_m, b.y_m - a.y_m) for a, b in itertools.pairwise(way))

    # Reaching the first command from rest costs 0.25² / (2 · 1.0) = 0.03 m.
    assert driven_m == pytest.approx(commanded_m, abs=0.1)
    assert way[-1].yaw_rad - way[0].yaw_rad == pytest.approx(commanded_rad, abs=0.05)


def test_the_wheels_turn_as_far_as_the_robot_drives(patrol_messages: list[TimedMessage]) -> None:
    last = of_topic(patrol_messages, RobotTopic.JOINT_STATES)[-1]
    way = poses(patrol_messages)
    model = DriveModel()
    last_ns = min(way, key=lambda at_ns: abs(at_ns - stamp_ns(last)))

    turned_rad = last.position[1] - last.position[0]

    yaw_rad = turned_rad * model.wheel_radius_m / model.wheel_separation_m
    assert way[last_ns].yaw_rad - patrol().start.yaw_rad == pytest.approx(yaw_rad, abs=0.03)
