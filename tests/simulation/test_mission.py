# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

from itertools import islice, pairwise

import pytest

from simulation.missions import START_NS, driven, of_topic, stamp_ns
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.simulation.messages import TimedMessage, Topic
from smarttestudo.simulation.mission import drive_mission
from smarttestudo.simulation.warehouse import patrol

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
def test_every_topic_comes_at_its_rate(topic: Topic, patrol_messages: list[TimedMessage]) -> None:
    stamps_ns = [timed.time_ns for timed in patrol_messages if timed.topic is topic]

    mean_hz = (len(stamps_ns) - 1) / (stamps_ns[-1] - stamps_ns[0]) * NS_PER_S

    assert mean_hz == pytest.approx(RATES_HZ[topic], rel=1e-3)


@pytest.mark.parametrize(
    "topic", [topic for topic in RATES_HZ if topic not in (Topic.COMPRESSED_IMAGE, Topic.TF)]
)
def test_arrivals_jitter_by_a_few_percent_of_the_period(
    topic: Topic, patrol_messages: list[TimedMessage]
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
        if timed.topic is not Topic.CMD_VEL:
            assert START_NS <= stamp_ns(timed.message) <= timed.time_ns


def test_images_their_calibration_and_their_compressed_copies_share_stamps(
    patrol_messages: list[TimedMessage],
) -> None:
    images, infos, jpegs = (
        [stamp_ns(message) for message in of_topic(patrol_messages, topic)]
        for topic in (Topic.IMAGE, Topic.CAMERA_INFO, Topic.COMPRESSED_IMAGE)
    )

    assert infos == images
    assert set(jpegs) < set(images)


@pytest.mark.full
def test_the_same_seed_gives_the_same_mission_and_another_seed_other_noise() -> None:
    first, again, other = (repr(driven(3, seed=seed)) for seed in (5, 5, 6))

    assert first == again
    assert first != other


def test_a_longer_mission_begins_as_a_shorter_one() -> None:
    short, long = driven(2), driven(4)

    assert repr(long[: len(short)]) == repr(short)


def test_a_mission_is_computed_as_it_is_taken_and_never_ends() -> None:
    mission = drive_mission(patrol(), seed=0, start_ns=START_NS)

    taken = list(islice(mission, 5))

    assert taken[-1].time_ns < START_NS + NS_PER_S // 10
    assert next(mission).time_ns >= taken[-1].time_ns
