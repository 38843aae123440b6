# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The quadrotor: it takes off, flies the route, and lands when its battery is empty."""

from __future__ import annotations

from typing import Any

import pytest

from simulation.physics.physical_drives import START_NS, Driven, robot_of, until
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.simulation.messages import Topic
from smarttestudo.simulation.physics.drive import RobotKind
from smarttestudo.simulation.physics.quadrotor import CRUISE_HEIGHT_M, LANDED_HEIGHT_M, RANGE_MOUNT_M

pytestmark = pytest.mark.full


def test_it_climbs_flies_on_and_measures_its_height() -> None:
    result = Driven()
    ranges_m, heights_m, odometry_m = [], [], []
    with robot_of(RobotKind.QUADROTOR, has_camera=False) as robot:
        for timed in robot.start(START_NS):
            result.note(robot, timed)
            message: Any = timed.message
            if timed.topic is Topic.RANGE:
                ranges_m.append(message.range)
                heights_m.append(robot.body.engine.position.z)
            elif timed.topic is Topic.ODOM:
                odometry_m.append(message.pose.pose.position.z)
            if timed.time_ns > START_NS + 14 * NS_PER_S:
                break
        place = robot.body.pose
    assert heights_m[0] < LANDED_HEIGHT_M + 0.01
    assert heights_m[-1] == pytest.approx(CRUISE_HEIGHT_M, abs=0.05)
    assert odometry_m[-1] == pytest.approx(CRUISE_HEIGHT_M, abs=0.3)
    assert ranges_m[-1] == pytest.approx(heights_m[-1] - RANGE_MOUNT_M, abs=0.06)
    assert place.y_m < 3.6
    assert result.touched == set()
    assert Topic.SCAN not in result.counts
    assert result.counts[Topic.RANGE] == pytest.approx(280, abs=3)


def test_it_lands_when_the_battery_is_empty() -> None:
    with robot_of(RobotKind.QUADROTOR, has_camera=False, battery_percent=0.25) as robot:
        drive = robot.start(START_NS)
        until(robot, drive, 4)
        highest_m = robot.body.engine.position.z
        until(robot, drive, 10)
        speed = robot.body.engine.velocity
        height_m = robot.body.engine.position.z
    assert highest_m > 0.5
    assert height_m == pytest.approx(LANDED_HEIGHT_M, abs=0.02)
    assert abs(speed.z) < 0.05
