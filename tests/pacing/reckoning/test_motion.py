# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Constant twists against closed formulas and small steps."""

from __future__ import annotations

import math
from functools import cache

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from pacing.reckoning.ros_messages import planar
from smarttestudo.pacing.reckoning.motion import (
    SMALL_ANGLE,
    Rotation,
    SpatialPose,
    Twist,
    Vector3,
    moved,
    orientation_distance_degrees,
    position_distance_m,
    twist_between,
)

numbers = st.floats(-3, 3)
vectors = st.builds(Vector3, numbers, numbers, numbers)


@cache
@st.composite
def poses(draw: st.DrawFn) -> SpatialPose:
    parts = [draw(st.floats(-1, 1)) for _ in range(4)]
    length = math.hypot(*parts)
    assume(length > 0.1)
    return SpatialPose(draw(vectors), Rotation(*(part / length for part in parts)))


@given(vectors, st.floats(-2, 2), st.floats(-2, 2), st.floats(0, 5))
def test_in_a_plane_a_twist_is_the_unicycle(
    start: Vector3, speed: float, yaw_rate: float, elapsed_s: float
) -> None:
    x, y, yaw = start
    assume(abs(yaw_rate) > 1e-3)
    after = moved(planar(x, y, yaw), Twist(Vector3(speed, 0, 0), Vector3(0, 0, yaw_rate)), elapsed_s)
    end = yaw + yaw_rate * elapsed_s
    radius = speed / yaw_rate
    expected = planar(
        x + radius * (math.sin(end) - math.sin(yaw)), y - radius * (math.cos(end) - math.cos(yaw)), end
    )
    assert position_distance_m(after, expected) < 1e-9
    assert orientation_distance_degrees(after, expected) < 1e-5


@pytest.mark.parametrize("share", [0.999, 1.001])
def test_a_hair_s_turn_shortens_the_way_as_any_turn_does(share: float) -> None:
    """On either side of the angle from which on sines are used."""
    angle, way_m = share * SMALL_ANGLE, 1e9
    after = moved(planar(0, 0, 0), Twist(Vector3(way_m, 0, 0), Vector3(0, 0, angle)), 1.0)
    assert way_m - after.position.x == pytest.approx(way_m * angle**2 / 6, rel=0.01)


@given(poses(), vectors, vectors, st.floats(0, 1), st.floats(0, 1))
def test_moving_twice_is_moving_on(
    pose: SpatialPose, linear: Vector3, angular: Vector3, first: float, then: float
) -> None:
    twist = Twist(linear, angular)
    twice, once = moved(moved(pose, twist, first), twist, then), moved(pose, twist, first + then)
    assert position_distance_m(twice, once) < 1e-9
    assert orientation_distance_degrees(twice, once) < 1e-5


@given(poses(), poses(), st.floats(0.01, 5))
def test_the_twist_between_two_poses_leads_from_one_to_the_other(
    one: SpatialPose, other: SpatialPose, elapsed_s: float
) -> None:
    after = moved(one, twist_between(one, other, elapsed_s), elapsed_s)
    assert position_distance_m(after, other) < 1e-6
    assert orientation_distance_degrees(after, other) < 1e-4


@given(poses(), st.floats(-180, 180))
def test_the_distance_of_orientations_is_the_angle_turned(pose: SpatialPose, degrees: float) -> None:
    turned = moved(pose, Twist(Vector3(0, 0, 0), Vector3(0, math.radians(degrees), 0)), 1.0)
    assert orientation_distance_degrees(pose, turned) == pytest.approx(abs(degrees), abs=1e-5)


def test_a_quaternion_and_its_negative_are_one_orientation() -> None:
    pose = planar(0, 0, 1.0)
    negative = SpatialPose(pose.position, Rotation(*(-part for part in pose.orientation)))
    assert orientation_distance_degrees(pose, negative) == pytest.approx(0, abs=1e-6)


def test_an_unset_orientation_is_unknown_and_turns_by_nothing() -> None:
    unset = SpatialPose(Vector3(1, 2, 3), Rotation(0, 0, 0, 0))
    assert math.isnan(orientation_distance_degrees(unset, planar(0, 0, 0)))
    assert moved(unset, Twist(Vector3(1, 0, 0), Vector3(0, 0, 0)), 2.0).position == Vector3(3, 2, 3)


def test_what_is_beyond_all_numbers_is_unknown() -> None:
    lost = moved(planar(0, 0, 0), Twist(Vector3(1, 0, 0), Vector3(0, 0, math.inf)), 1.0)
    assert math.isnan(position_distance_m(lost, planar(0, 0, 0)))
