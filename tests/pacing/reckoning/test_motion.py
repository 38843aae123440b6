# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How the parts of messages move, on land and between satellites."""

from __future__ import annotations

import math
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from bags.bag_factory import START_NS, BagContent, BagMessage, BagTopic, cdr, message_of
from pacing.reckoning.ros_messages import planar
from replays.replay_runs import replay_content
from smarttestudo.accuracy.recorded_loss import LossQuestion, measure_loss
from smarttestudo.language.properties import gauges_for
from smarttestudo.pacing.reckoning.gauges import Place, places_distance_m
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
from smarttestudo.rules.rule_sets import load_rules

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


FIX = "sensor_msgs/msg/NavSatFix"
NAN = math.nan


def fix(
    latitude: float, longitude: float, altitude: float = 100.0, *, status: int = 0, frame: str = "gps"
) -> bytes:
    message = message_of(FIX, latitude=latitude, longitude=longitude, altitude=altitude)
    message.header.stamp.sec, message.header.frame_id, message.status.status = 1, frame, status
    message.position_covariance = np.zeros(9)
    return cdr(FIX, message)


@pytest.mark.parametrize(
    ("one", "other", "metres"),
    [
        # A minute of latitude was a sea mile; lengths of a degree by WGS 84.
        pytest.param(Place(0, 0, 0), Place(0, 1e-5, 0), 1.11319, id="east at the equator"),
        pytest.param(Place(0, 0, 0), Place(1e-5, 0, 0), 1.10574, id="north at the equator"),
        pytest.param(Place(60, 10, 0), Place(60, 10 + 1e-5, 0), 0.55800, id="east at 60 degrees"),
        pytest.param(Place(89.99999, 0, 0), Place(89.99999, 180, 0), 2.23387, id="across the pole"),
        pytest.param(Place(0, 179.999995, 0), Place(0, -179.999995, 0), 1.11319, id="where longitudes begin"),
        pytest.param(Place(48, 11, 500), Place(48, 11, 503), 3.0, id="up"),
        pytest.param(Place(48, 11, NAN), Place(48, 11, 503), 0.0, id="an altitude that is not known"),
        pytest.param(Place(NAN, 11, 0), Place(48, 11, 0), NAN, id="nowhere"),
        pytest.param(Place(480, 11, 0), Place(48, 11, 0), NAN, id="no latitude"),
    ],
)
def test_degrees_are_metres_of_wgs_84(one: Place, other: Place, metres: float) -> None:
    assert places_distance_m(one, other) == pytest.approx(metres, abs=1e-5, nan_ok=True)


@given(st.floats(-80, 80), st.floats(-180, 180), st.floats(-50, 50), st.floats(-50, 50))
def test_near_places_are_apart_as_in_the_tangent_plane(
    latitude: float, longitude: float, east_m: float, north_m: float
) -> None:
    """By the radii of curvature: Groves, Principles of GNSS, Inertial and Multisensor Navigation, 2.4.2."""
    a_m, squared = 6_378_137.0, 0.00669437999014
    sine = math.sin(math.radians(latitude))
    meridian_m = a_m * (1 - squared) / (1 - squared * sine**2) ** 1.5
    normal_m = a_m / math.sqrt(1 - squared * sine**2)
    moved = Place(
        latitude + math.degrees(north_m / meridian_m),
        longitude + math.degrees(east_m / (normal_m * math.cos(math.radians(latitude)))),
        0.0,
    )
    found = places_distance_m(Place(latitude, longitude, 0.0), moved)
    assert found == pytest.approx(math.hypot(east_m, north_m), rel=1e-4, abs=1e-6)


@pytest.mark.parametrize("frame", ["", "g", "gps", "gps_link"])
def test_a_message_is_read_as_another_implementation_writes_it(frame: str) -> None:
    (gauge,) = gauges_for(FIX, ["position"])
    reading = gauge.read(fix(48.1, -11.5, 512.0, frame=frame), None, 5)
    assert reading is not None
    (part,) = reading
    assert (part.state, part.at_ns) == (Place(48.1, -11.5, 512.0), 1_000_000_000)
    assert gauge.read(fix(48.1, 11.5)[:40], None, 5) is None


def test_without_a_fix_nothing_is_known_of_the_place() -> None:
    (gauge,) = gauges_for(FIX, ["position"])
    reading = gauge.read(fix(48.1, 11.5, status=-1), None, 5)
    assert reading is not None
    assert not gauge.distances["position"].has_value(reading[0].state)


def test_a_robot_outdoors_is_kept_within_metres(tmp_path: Path) -> None:
    """1 m/s to the north, 10 Hz."""
    messages = tuple(
        BagMessage("/fix", START_NS + number * 100_000_000, fix(48 + number * 0.1 / 111_194.0, 11.0))
        for number in range(200)
    )
    content = BagContent((BagTopic("/fix", FIX),), messages)
    run = replay_content(content, "KeepWithin /fix position 0.5", tmp_path)
    (record,) = run.outcome.topics["/fix"].bounds["position"]
    assert (record.bound, record.broken) == (0.5, 0)
    assert record.worst is not None
    assert 0.35 < record.worst <= 0.5
    assert 30 <= len(run.on("/fix")) <= 45
    question = LossQuestion(rule_set=load_rules([tmp_path / "rules.adirf"]).rule_set)
    (loss,) = measure_loss(tmp_path / "bag", run.output, question).bounds
    assert (loss.unit, loss.broken) == ("m", 0)
    assert loss.worst == pytest.approx(record.worst)
