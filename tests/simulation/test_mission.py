# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

from itertools import islice, pairwise

import pytest

from simulation.missions import START_NS, of_topic, readings
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.simulation.mission import MissionRequest, drive_mission
from smarttestudo.simulation.readings import CameraInfo, CompressedImage, Image, TimedReading, Topic
from smarttestudo.simulation.warehouse import patrol, warehouse

RATES_HZ = {
    Topic.CMD_VEL: 10,
    Topic.ODOM: 25.5,
    Topic.CAMERA_INFO: 29,
    Topic.COMPRESSED_IMAGE: 28,
    Topic.IMAGE: 29,
    Topic.IMU: 195,
    Topic.JOINT_STATES: 5,
    Topic.SCAN: 5,
    Topic.TF: 25.5 + 5,
}


@pytest.mark.parametrize("topic", RATES_HZ)
def test_every_topic_comes_at_its_rate(topic: Topic, patrol_readings: list[TimedReading]) -> None:
    stamps_ns = [reading.time_ns for reading in patrol_readings if reading.topic is topic]

    mean_hz = (len(stamps_ns) - 1) / (stamps_ns[-1] - stamps_ns[0]) * NS_PER_S

    assert mean_hz == pytest.approx(RATES_HZ[topic], rel=1e-3)


@pytest.mark.parametrize(
    "topic", [topic for topic in RATES_HZ if topic not in (Topic.COMPRESSED_IMAGE, Topic.TF)]
)
def test_arrivals_jitter_by_a_few_percent_of_the_period(
    topic: Topic, patrol_readings: list[TimedReading]
) -> None:
    stamps_ns = [reading.time_ns for reading in patrol_readings if reading.topic is topic]
    period_ns = NS_PER_S / RATES_HZ[topic]

    gaps = [(b - a) / period_ns for a, b in pairwise(stamps_ns)]

    assert 0.9 <= min(gaps) < 0.99
    assert 1.01 < max(gaps) <= 1.1


def test_readings_come_in_the_order_of_their_arrival_and_after_they_were_measured(
    patrol_readings: list[TimedReading],
) -> None:
    times_ns = [reading.time_ns for reading in patrol_readings]

    assert times_ns == sorted(times_ns)
    for timed in patrol_readings:
        stamp_ns = getattr(timed.reading, "stamp_ns", timed.time_ns)
        assert START_NS <= stamp_ns <= timed.time_ns


def test_images_their_calibration_and_their_compressed_copies_share_stamps(
    patrol_readings: list[TimedReading],
) -> None:
    images = [r.stamp_ns for r in of_topic(patrol_readings, Topic.IMAGE) if isinstance(r, Image)]
    infos = [r.stamp_ns for r in of_topic(patrol_readings, Topic.CAMERA_INFO) if isinstance(r, CameraInfo)]
    jpegs = [
        r.stamp_ns
        for r in of_topic(patrol_readings, Topic.COMPRESSED_IMAGE)
        if isinstance(r, CompressedImage)
    ]

    assert infos == images
    assert set(jpegs) < set(images)


@pytest.mark.full
def test_the_same_seed_gives_the_same_mission_and_another_seed_other_noise() -> None:
    first, again, other = (repr(readings(3, seed=seed)) for seed in (5, 5, 6))

    assert first == again
    assert first != other


def test_a_longer_mission_begins_as_a_shorter_one() -> None:
    short, long = readings(2), readings(4)

    assert repr(long[: len(short)]) == repr(short)


def test_a_mission_is_computed_as_it_is_taken_and_never_ends() -> None:
    mission = drive_mission(MissionRequest(plan=warehouse(), route=patrol(), seed=0, start_ns=START_NS))

    taken = list(islice(mission, 5))

    assert taken[-1].time_ns < START_NS + NS_PER_S // 10
    assert next(mission).time_ns >= taken[-1].time_ns
