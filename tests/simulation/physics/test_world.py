# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What stands and walks in the world with physics, what its camera sees, and keys that drive."""

from __future__ import annotations

import pytest

from simulation.missions import START_NS, of_topic
from simulation.physics.physical_drives import robot_of, until
from smarttestudo.domain.floor_plan import Point
from smarttestudo.simulation.geometry import BodyVelocity
from smarttestudo.simulation.messages import RobotTopic
from smarttestudo.simulation.physics.drive import RobotKind, Teleop
from smarttestudo.simulation.physics.world import PERSON_RADIUS_M, WalkingPerson, people
from smarttestudo.simulation.robot import DriveModel
from smarttestudo.simulation.warehouse import patrol, warehouse

FAR = Point(-100.0, 0.0)


@pytest.mark.parametrize("number", range(len(people())))
def test_people_walk_clear_of_everything_and_of_the_patrol(number: int) -> None:
    person, radius_m, robot_m = people()[number], PERSON_RADIUS_M, DriveModel().radius_m
    for _ in range(400):
        person.walk(0.1, FAR)
        place = person.pose.place
        assert warehouse().clearance_m(place) > radius_m + 0.1
        assert min(place.distance_m(point) for point in patrol().points) > radius_m + robot_m + 0.2


def test_a_person_waits_for_a_robot_ahead_and_goes_on_without_it() -> None:
    person = WalkingPerson(start=Point(0.0, 0.0), end=Point(5.0, 0.0), speed_m_per_s=1.0)
    person.walk(1.0, Point(1.5, 0.2))
    assert person.pose.x_m == pytest.approx(1.0)
    person.walk(1.0, Point(1.5, 0.2))
    assert person.pose.x_m == pytest.approx(1.0)
    person.walk(1.0, Point(1.5, 2.0))
    assert person.pose.x_m == pytest.approx(2.0)


@pytest.mark.full
def test_the_camera_sees_the_warehouse() -> None:
    with robot_of() as robot:
        if robot.camera_problem is not None:
            pytest.skip(robot.camera_problem)
        images = [
            image.data.reshape(image.height, image.width, 3)
            for image in of_topic(until(robot, robot.start(START_NS), 3), RobotTopic.IMAGE)
        ]
    first, last = images[0].astype(int), images[-1].astype(int)
    assert first.shape == (27, 48, 3)
    assert first.std() > 15
    assert abs(first - last).mean() > 2


def test_keys_step_stop_and_end_at_the_robots_speed() -> None:
    teleop = Teleop(RobotKind.WAFFLE)
    teleop.press("wwa")
    assert teleop.velocity == BodyVelocity(0.1, 0.2)
    teleop.press("rW?d")
    assert teleop.velocity == BodyVelocity(0.15, 0.0)
    teleop.press("w" * 20)
    assert teleop.velocity.linear_m_per_s == DriveModel().max_linear_m_per_s
    teleop.press("x" * 40)
    assert teleop.velocity.linear_m_per_s == -DriveModel().max_linear_m_per_s
    teleop.press(" ")
    assert teleop.velocity == BodyVelocity(0.0, 0.0)


def test_only_what_flies_climbs() -> None:
    teleop = Teleop(RobotKind.QUADROTOR)
    teleop.press("rrf")
    assert teleop.velocity == BodyVelocity(0.0, 0.0, climb_m_per_s=0.1)
