# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Robots with physics: they drive, slip, drift, see, fly and run out of charge."""

from __future__ import annotations

import math
from typing import Any, cast

import numpy as np
import pytest

from simulation.missions import START_NS, of_topic, stamp_ns
from simulation.physics.physical_drives import Driven, distance_m, driven, rates_hz, robot_of, until
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.simulation.geometry import BodyVelocity
from smarttestudo.simulation.messages import RobotTopic
from smarttestudo.simulation.physics.drive import RobotKind
from smarttestudo.simulation.physics.quadrotor import CRUISE_HEIGHT_M, LANDED_HEIGHT_M, RANGE_MOUNT_M
from smarttestudo.simulation.robot import DriveModel
from smarttestudo.simulation.sensors import Lidar, RayCaster
from smarttestudo.simulation.steering import OTHERS_NS
from smarttestudo.simulation.warehouse import warehouse

pytestmark = pytest.mark.full

ROUND_S = 200.0


@pytest.fixture(scope="module")
def patrol_drive() -> Driven:
    """A whole round, without a camera."""
    with robot_of(has_camera=False) as robot:
        return driven(robot, ROUND_S)


def test_a_round_of_the_patrol_touches_nothing(patrol_drive: Driven) -> None:
    assert patrol_drive.touched == set()
    assert patrol_drive.hardest_m_per_s2 < 11


def test_odometry_drifts_and_finds_no_way_back(patrol_drive: Driven) -> None:
    assert patrol_drive.off_m[0] < 0.01
    assert 0.05 < patrol_drive.off_m[-1] < 1.5


def test_every_device_has_the_rate_of_the_thesis(patrol_drive: Driven) -> None:
    rates = {topic.value: hz for topic, hz in rates_hz(patrol_drive.counts, ROUND_S).items()}
    expected = {"/cmd_vel": 10, "/odom": 25.5, "/imu": 195, "/scan": 5, "/joint_states": 5}
    assert {topic: rates[topic] for topic in expected} == pytest.approx(expected, rel=0.005)


def test_a_robot_that_pushes_feels_a_blow_and_its_wheels_slip() -> None:
    with robot_of(has_camera=False) as robot:
        result = Driven()
        last: Any = None
        drive = robot.start(START_NS)
        for timed in drive:
            # The first seconds of the patrol lead past a rack: turn to it and push.
            turn = 0.6 if timed.time_ns < START_NS + 3 * NS_PER_S else 0.0
            robot.obey(BodyVelocity(0.26, -turn))
            result.note(robot, timed)
            last = timed.message if timed.topic is RobotTopic.ODOM else last
            if timed.time_ns > START_NS + 12 * NS_PER_S:
                break
        true = robot.body.engine.velocity
    assert last is not None
    assert {name.partition("_")[0] for name in result.touched} == {"rack"}
    assert result.hardest_m_per_s2 > 13
    assert last.twist.twist.linear.x > 0.1
    assert math.hypot(true.x, true.y) < 0.05
    assert distance_m(last.pose.pose.position, robot.body.engine.position) > 0.2


def test_the_lidar_sees_the_walls_where_they_are() -> None:
    caster = RayCaster(warehouse())
    with robot_of(has_camera=False) as robot:
        for timed in robot.start(START_NS):
            if timed.topic is RobotTopic.SCAN:
                break
        pose = robot.body.pose
    seen = cast("Any", timed.message).ranges
    bearings = np.linspace(0, 2 * np.pi, len(seen), endpoint=False) + pose.yaw_rad
    origin = pose.ahead(DriveModel().scan_x_m)
    true = caster.cast(origin, bearings, range_m=Lidar.range_max_m - 0.1).distances_m
    near = np.isfinite(true)
    assert np.count_nonzero(near) > 60
    # At the edge of a rack half a millimetre decides what a ray meets.
    agreeing = np.abs(seen[near] - true[near]) < 5 * Lidar.noise_m
    assert np.mean(agreeing) > 0.97


def test_a_covered_lidar_reads_too_near_all_around() -> None:
    with robot_of(has_camera=False, cover_s=1.0) as robot:
        scans = of_topic(until(robot, robot.start(START_NS), 2), RobotTopic.SCAN)
    covered = [scan.ranges for scan in scans if stamp_ns(scan) > START_NS + 1.05 * NS_PER_S]
    assert len(covered) > 2
    assert all(np.isneginf(ranges).all() for ranges in covered)
    assert np.isfinite(scans[0].ranges).any()


def test_an_empty_battery_stops_the_robot() -> None:
    with robot_of(has_camera=False, battery_percent=0.03) as robot:
        found = until(robot, robot.start(START_NS), 7)
        speed = robot.body.engine.velocity
    shares = [battery.percentage for battery in of_topic(found, RobotTopic.BATTERY_STATE)]
    assert shares == sorted(shares, reverse=True)
    assert shares[0] > 0 == shares[-1]
    assert math.hypot(speed.x, speed.y) < 0.01


def test_the_localizer_stays_with_the_truth() -> None:
    with robot_of(has_camera=False) as robot:
        off = []
        for timed in robot.start(START_NS):
            if timed.topic is RobotTopic.AMCL_POSE:
                place = cast("Any", timed.message).pose.pose.position
                off.append(distance_m(place, robot.body.engine.position))
            if timed.time_ns > START_NS + 5 * NS_PER_S:
                break
    assert len(off) == 10
    assert 0.005 < max(off) < 0.15


def test_who_publishes_cmd_vel_drives_until_two_seconds_after() -> None:
    with robot_of(has_camera=False) as robot:
        drive = robot.start(START_NS)
        until(robot, drive, 1)
        robot.obey(BodyVelocity(0.0, 0.0))
        heard_ns = robot.body.now_ns
        own = [one.time_ns for one in until(robot, drive, 5) if one.topic is RobotTopic.CMD_VEL]
    assert heard_ns + OTHERS_NS <= own[0] < heard_ns + OTHERS_NS + NS_PER_S / 5


def test_lost_time_moves_stamps_and_not_the_robot() -> None:
    with robot_of(has_camera=False) as robot:
        drive = robot.start(START_NS)
        until(robot, drive, 2)
        before, lost_ns = robot.body.engine.position, 30 * NS_PER_S
        drive.skip(lost_ns)
        stamps = [stamp_ns(message) for message in of_topic(until(robot, drive, 32.2), RobotTopic.IMU)]
        moved_m = distance_m(before, robot.body.engine.position)
    assert len(stamps) == pytest.approx(39, abs=3)
    assert min(stamps[3:]) >= START_NS + lost_ns + 2 * NS_PER_S
    assert moved_m < 0.26 * 0.3


def test_the_same_seed_gives_the_same_drive() -> None:
    drives = []
    for seed in (1, 1, 2):
        with robot_of(has_camera=False, seed=seed) as robot:
            found = until(robot, robot.start(START_NS), 1)
        drives.append(repr([one for one in found if one.topic in (RobotTopic.ODOM, RobotTopic.IMU)]))
    assert drives[0] == drives[1] != drives[2]


def test_it_climbs_flies_on_and_measures_its_height() -> None:
    result = Driven()
    ranges_m, heights_m, odometry_m = [], [], []
    with robot_of(RobotKind.QUADROTOR, has_camera=False) as robot:
        for timed in robot.start(START_NS):
            result.note(robot, timed)
            message: Any = timed.message
            if timed.topic is RobotTopic.RANGE:
                ranges_m.append(message.range)
                heights_m.append(robot.body.engine.position.z)
            elif timed.topic is RobotTopic.ODOM:
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
    assert RobotTopic.SCAN not in result.counts
    assert result.counts[RobotTopic.RANGE] == pytest.approx(280, abs=3)


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
