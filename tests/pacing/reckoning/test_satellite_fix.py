# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Places that satellites say are bound in metres."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bags.bag_factory import START_NS, BagContent, BagMessage, BagTopic, cdr, message_of
from replays.replay_runs import replay_content
from smarttestudo.accuracy.recorded_loss import LossQuestion, measure_loss
from smarttestudo.language.properties import gauges_for
from smarttestudo.pacing.reckoning.gauges import Place, places_distance_m
from smarttestudo.rules.rule_sets import load_rules

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
