# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0

from __future__ import annotations

from itertools import groupby, islice, pairwise

import pytest

from simulation.missions import START_NS, driven, of_topic, poses, stamp_ns
from smarttestudo.domain.floor_plan import Point
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.simulation.messages import RobotTopic, TimedMessage
from smarttestudo.simulation.mission import drive_mission
from smarttestudo.simulation.robot import DriveModel
from smarttestudo.simulation.warehouse import patrol, warehouse, warehouse_bounds

RATES_HZ = {
    RobotTopic.CMD_VEL: 10,
    RobotTopic.ODOM: 25.5,
    RobotTopic.CAMERA_INFO: 29,
    RobotTopic.COMPRESSED_IMAGE: 28,
    RobotTopic.IMAGE: 29,
    RobotTopic.IMU: 195,
    RobotTopic.JOINT_STATES: 5,
    RobotTopic.SCAN: 5,
    RobotTopic.TF: 25.5 + 5,
}


@pytest.mark.parametrize("topic", RATES_HZ)
def test_every_topic_comes_at_its_rate(topic: RobotTopic, patrol_messages: list[TimedMessage]) -> None:
    stamps_ns = [timed.time_ns for timed in patrol_messages if timed.topic is topic]

    mean_hz = (len(stamps_ns) - 1) / (stamps_ns[-1] - stamps_ns[0]) * NS_PER_S

    assert mean_hz == pytest.approx(RATES_HZ[topic], rel=1e-3)


@pytest.mark.parametrize(
    "topic", [topic for topic in RATES_HZ if topic not in (RobotTopic.COMPRESSED_IMAGE, RobotTopic.TF)]
)
def test_arrivals_jitter_by_a_few_percent_of_the_period(
    topic: RobotTopic, patrol_messages: list[TimedMessage]
) -> None:
    stamps_ns = [timed.time_ns for timed in patrol_messages if timed.topic is topic]
    period_ns = NS_PER_S / RATES_HZ[topic]

    gaps = [(b - a) / period_ns for a, b in pairwise(stamps_ns)]

    assert 0.9 <= min(gaps) < 0.99
    assert 1.01 < max(gaps) <= 1.1


def test_messages_come_in_the_order_of_their_arrival_and_after_they_were_measured(
    patrol_messages: list[TimedMessage],
) -> None:
    times_ns = [timed.time_ns for timed in patrol_messages]

    assert times_ns == sorted(times_ns)
    for timed in patrol_messages:
        if timed.topic is not RobotTopic.CMD_VEL:
            assert START_NS <= stamp_ns(timed.message) <= timed.time_ns


def test_images_their_calibration_and_their_compressed_copies_share_stamps(
    patrol_messages: list[TimedMessage],
) -> None:
    images, infos, jpegs = (
        [stamp_ns(message) for message in of_topic(patrol_messages, topic)]
        for topic in (RobotTopic.IMAGE, RobotTopic.CAMERA_INFO, RobotTopic.COMPRESSED_IMAGE)
    )

    assert infos == images
    assert set(jpegs) < set(images)


def test_a_longer_mission_begins_as_a_shorter_one() -> None:
    short, long = driven(2), driven(4)

    assert repr(long[: len(short)]) == repr(short)


def test_a_mission_is_computed_as_it_is_taken_and_never_ends() -> None:
    mission = drive_mission(patrol(), seed=0, start_ns=START_NS)

    taken = list(islice(mission, 5))

    assert taken[-1].time_ns < START_NS + NS_PER_S // 10
    assert next(mission).time_ns >= taken[-1].time_ns


def _places(patrol_messages: list[TimedMessage]) -> list[Point]:
    return [Point(pose.x_m, pose.y_m) for pose in poses(patrol_messages).values()]


def _zone(place: Point) -> str | None:
    """The name of the zone that ``place`` lies in; ``None`` for the open floor."""
    return next((zone.name for zone in warehouse().zones if zone.area.contains(place)), None)


@pytest.mark.full
def test_a_patrol_goes_through_hall_corridor_and_scaffolding_and_back(
    patrol_messages: list[TimedMessage],
) -> None:
    visited = [zone for zone, _ in groupby(map(_zone, _places(patrol_messages)))]

    # Between the corridor and the scaffolding lies the wall, 0.6 m that belong to neither zone.
    assert visited == [None, "Warehouse Corridor", None, "Scaffolding", None]


def test_the_robot_never_touches_anything(patrol_messages: list[TimedMessage]) -> None:
    plan = warehouse()

    nearest_m = min(plan.clearance_m(place) for place in _places(patrol_messages))

    assert nearest_m > DriveModel().radius_m


def test_a_round_takes_the_demo_200_seconds_within_the_robots_top_speed(
    patrol_messages: list[TimedMessage],
) -> None:
    places = _places(patrol_messages)
    driven_m = sum(a.distance_m(b) for a, b in pairwise(places))

    assert abs(driven_m - patrol().length_m) < 0.5
    assert driven_m < 200 * DriveModel().max_linear_m_per_s


def test_the_robot_stays_on_its_route(patrol_messages: list[TimedMessage]) -> None:
    route = patrol()
    line = [route.at(step * 0.02) for step in range(round(route.length_m / 0.02))]

    off_m = max(min(place.distance_m(point) for point in line) for place in _places(patrol_messages)[::50])

    assert off_m < 0.1


def test_every_obstacle_stands_within_the_outer_walls() -> None:
    plan, bounds = warehouse(), warehouse_bounds()

    for obstacle in plan.obstacles:
        box = obstacle.footprint
        assert box.min_x_m < box.max_x_m
        assert box.min_y_m < box.max_y_m
        assert bounds.min_x_m - 0.2 <= box.min_x_m
        assert box.max_x_m <= bounds.max_x_m + 0.2
        assert bounds.min_y_m - 0.2 <= box.min_y_m
        assert box.max_y_m <= bounds.max_y_m + 0.2


def test_the_border_of_a_zone_belongs_to_the_open_floor() -> None:
    assert [_zone(Point(0.0, y_m)) for y_m in (1.0, 1.01, 5.39, 5.4, 6.0, 6.01)] == [
        None,
        "Warehouse Corridor",
        "Warehouse Corridor",
        None,
        None,
        "Scaffolding",
    ]
