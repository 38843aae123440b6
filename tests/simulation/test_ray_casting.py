# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from smarttestudo.domain.floor_plan import FloorPlan, Obstacle, ObstacleKind, Point, Rectangle
from smarttestudo.simulation.sensors import RayCaster
from smarttestudo.simulation.warehouse import warehouse

FREE_PLACES = st.builds(Point, st.floats(-12.9, 13.9), st.floats(-7.9, 25.4)).filter(
    lambda place: warehouse().clearance_m(place) > 0.01
)


def _slab_distance_m(plan: FloorPlan, origin: Point, bearing_rad: float) -> float:
    """The naive second opinion: one ray, one box at a time, by clipping against its slabs."""
    direction = (math.cos(bearing_rad), math.sin(bearing_rad))
    best = math.inf
    for obstacle in plan.obstacles:
        box = obstacle.footprint
        enter, leave = 0.0, math.inf
        for start, step, low, high in (
            (origin.x_m, direction[0], box.min_x_m, box.max_x_m),
            (origin.y_m, direction[1], box.min_y_m, box.max_y_m),
        ):
            if step == 0:
                if not low <= start <= high:
                    leave = -1.0
                continue
            first, second = sorted(((low - start) / step, (high - start) / step))
            enter, leave = max(enter, first), min(leave, second)
        if enter <= leave:
            best = min(best, enter)
    return best


@settings(max_examples=30, deadline=None)
@example(place=Point(0.0, 0.0), turn_rad=5e-324)
@given(place=FREE_PLACES, turn_rad=st.floats(0, math.tau))
def test_casting_agrees_with_clipping_each_ray_against_each_box(place: Point, turn_rad: float) -> None:
    plan = warehouse()
    bearings_rad = turn_rad + np.linspace(0, math.tau, 90, endpoint=False)

    hits = RayCaster(plan).cast(place, bearings_rad, range_m=100.0)

    expected_m = [_slab_distance_m(plan, place, bearing_rad) for bearing_rad in bearings_rad.tolist()]
    # A ray that grazes a corner may meet or miss it by rounding: nothing else may differ.
    differing = np.flatnonzero(~np.isclose(hits.distances_m, expected_m, atol=1e-6))
    for ray in differing.tolist():
        nudged = [_slab_distance_m(plan, place, bearings_rad[ray] + nudge) for nudge in (-1e-7, 1e-7)]
        assert any(hits.distances_m[ray] == pytest.approx(distance_m, abs=1e-4) for distance_m in nudged)


def test_a_ray_names_the_obstacle_it_meets_and_none_beyond_its_range() -> None:
    boxes = [
        Rectangle(min_x_m=2, max_x_m=3, min_y_m=-1, max_y_m=1),
        Rectangle(min_x_m=-5, max_x_m=-4, min_y_m=-1, max_y_m=1),
    ]
    obstacles = tuple(Obstacle(kind=ObstacleKind.RACK, footprint=box, height_m=1.0) for box in boxes)
    plan = FloorPlan(obstacles=obstacles)

    hits = RayCaster(plan).cast(Point(0.0, 0.0), np.array([0.0, math.pi / 2, math.pi]), range_m=3.5)

    assert hits.distances_m.tolist() == [2.0, math.inf, math.inf]
    assert hits.obstacles.tolist() == [0, -1, -1]
