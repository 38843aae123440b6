# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

from itertools import groupby, pairwise

import pytest

from simulation.missions import poses
from smarttestudo.domain.floor_plan import Point
from smarttestudo.simulation.messages import TimedMessage
from smarttestudo.simulation.robot import DriveModel
from smarttestudo.simulation.warehouse import patrol, warehouse, warehouse_bounds


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
