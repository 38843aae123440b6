# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import math
from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from smarttestudo.domain.floor_plan import Point
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.simulation.geometry import Pose
from smarttestudo.simulation.robot import DifferentialDrive, DriveModel
from smarttestudo.simulation.route import Route
from smarttestudo.simulation.steering import PurePursuit

SQUARE = [Point(0.0, 0.0), Point(4.0, 0.0), Point(4.0, 4.0), Point(0.0, 4.0)]


@given(radius_m=st.floats(0.2, 1.9))
@settings(max_examples=20, deadline=None)
def test_each_rounded_corner_of_a_square_saves_two_radii_less_a_quarter_circle(radius_m: float) -> None:
    route = Route.through(SQUARE, corner_radius_m=radius_m)

    # The arcs are drawn as chords of 5 cm, which are a little shorter.
    assert route.length_m == pytest.approx(16 - 4 * (2 - math.pi / 2) * radius_m, rel=1e-3)


@given(travelled_m=st.floats(0, 50), step_m=st.floats(0.001, 0.2))
@settings(max_examples=50, deadline=None)
def test_places_lie_no_further_apart_than_the_route_between_them(travelled_m: float, step_m: float) -> None:
    route = Route.through(SQUARE, corner_radius_m=0.5)

    assert route.at(travelled_m).distance_m(route.at(travelled_m + step_m)) <= step_m + 1e-9


def test_a_route_turns_right_and_left_and_ends_where_it_starts() -> None:
    zigzag = [
        Point(0.0, 0.0),
        Point(3.0, 0.0),
        Point(3.0, 3.0),
        Point(6.0, 3.0),
        Point(6.0, 6.0),
        Point(0.0, 6.0),
    ]
    route = Route.through(zigzag, corner_radius_m=0.5)

    assert route.points[0] == route.points[-1]
    assert max(a.distance_m(b) for a, b in pairwise(route.points)) < 5.1
    headings = [math.atan2(b.y_m - a.y_m, b.x_m - a.x_m) for a, b in pairwise(route.points) if a != b]
    assert max(abs(math.remainder(b - a, math.tau)) for a, b in pairwise(headings)) < 0.2


@pytest.mark.parametrize("aside_m", [-0.3, 0.3])
def test_a_robot_beside_its_route_comes_back_to_it(aside_m: float) -> None:
    route = Route.through(SQUARE, corner_radius_m=0.5)
    model = DriveModel()
    drive = DifferentialDrive(model, pose=Pose(2.0, aside_m, 0.0), now_ns=0)
    pursuit = PurePursuit(route, model)

    for tick in range(1, 101):
        drive.command(pursuit.command(drive))
        drive.advance_to(tick * NS_PER_S // 10)

    here = Point(drive.pose.x_m, drive.pose.y_m)
    assert min(here.distance_m(route.at(step * 0.02)) for step in range(800)) < 0.06
    assert pursuit.travelled_m > 2.0
