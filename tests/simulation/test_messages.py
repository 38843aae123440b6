# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0

from __future__ import annotations

import io
import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from PIL import Image as PillowImage
from rosbags.typesys import Stores, get_typestore

from simulation.missions import START_NS, driven, of_topic, stamp_ns
from simulation.physics.physical_drives import robot_of, until
from smarttestudo.simulation.camera import FrameSize
from smarttestudo.simulation.geometry import BodyVelocity
from smarttestudo.simulation.messages import RobotMessages, RobotTopic, TimedMessage, command
from smarttestudo.simulation.physics.drive import RobotKind

THESIS_BYTES = {
    RobotTopic.CMD_VEL: 52,
    RobotTopic.ODOM: 720,
    RobotTopic.CAMERA_INFO: 380,
    RobotTopic.IMU: 320,
    RobotTopic.SCAN: 2940,
}
TRANSFORMS = (RobotTopic.TF, RobotTopic.TF_STATIC)


@pytest.fixture(scope="module")
def second() -> list[TimedMessage]:
    return driven(1)


def _decoded(timed: list[TimedMessage], messages: RobotMessages) -> Iterator[tuple[TimedMessage, Any]]:
    types = get_typestore(Stores.ROS2_HUMBLE)
    for one in timed:
        payload = messages.payload(one.topic, one.message)
        yield one, types.deserialize_cdr(payload, messages.channels[one.topic].type_name)


def _payloads(timed: list[TimedMessage]) -> list[tuple[int, bytes]]:
    messages = RobotMessages()
    return [(one.time_ns, messages.payload(one.topic, one.message)) for one in timed]


@pytest.mark.parametrize("topic", THESIS_BYTES)
def test_messages_are_as_large_as_on_the_real_robot(topic: RobotTopic, second: list[TimedMessage]) -> None:
    messages = RobotMessages()

    sizes = {len(messages.payload(topic, r.message)) for r in second if r.topic is topic}

    assert len(sizes) == 1
    assert sizes.pop() == pytest.approx(THESIS_BYTES[topic], rel=0.015)


def test_transforms_are_as_large_as_one_of_gazebo_and_two_of_a_robot_state_publisher(
    second: list[TimedMessage],
) -> None:
    messages = RobotMessages()
    sizes = {
        len(message.transforms): len(messages.payload(RobotTopic.TF, message))
        for message in of_topic(second, RobotTopic.TF)
    }
    assert sizes == {1: 108, 2: 212}


def test_every_message_decodes_with_its_stamp_and_frame(second: list[TimedMessage]) -> None:
    for timed, message in _decoded(second, RobotMessages()):
        if timed.topic is RobotTopic.CMD_VEL:
            continue
        assert stamp_ns(message) == stamp_ns(timed.message)
        assert (message.transforms[0] if timed.topic in TRANSFORMS else message).header.frame_id


def test_noise_and_the_layout_of_arrays_are_told_as_they_are(second: list[TimedMessage]) -> None:
    for timed, message in _decoded(second, RobotMessages()):
        match timed.topic:
            case RobotTopic.ODOM:
                assert message.twist.covariance[[0, 35]] == pytest.approx([0.002**2, 0.005**2])
            case RobotTopic.SCAN:
                assert message.angle_increment * len(message.ranges) == pytest.approx(math.tau, abs=1e-5)
            case RobotTopic.IMAGE:
                assert (
                    message.step * message.height == message.width * message.height * 3 == len(message.data)
                )


def test_the_calibration_describes_the_image_it_comes_with(second: list[TimedMessage]) -> None:
    decoded = list(_decoded(second, RobotMessages()))
    images = {m.header.stamp.nanosec: m for r, m in decoded if r.topic is RobotTopic.IMAGE}

    infos = [m for r, m in decoded if r.topic is RobotTopic.CAMERA_INFO]

    for info in infos:
        image = images[info.header.stamp.nanosec]
        assert (info.width, info.height) == (1920, 1080)
        assert (image.width, image.height) == (1920 // info.binning_x, 1080 // info.binning_y)
        assert info.k[2] == info.width / 2


def test_compressed_images_are_jpegs_of_the_view(second: list[TimedMessage]) -> None:
    decoded = list(_decoded(second, RobotMessages()))
    raw = {m.header.stamp.nanosec: m for r, m in decoded if r.topic is RobotTopic.IMAGE}

    for message in (m for r, m in decoded if r.topic is RobotTopic.COMPRESSED_IMAGE):
        picture = np.asarray(PillowImage.open(io.BytesIO(bytes(message.data)))).astype(float)
        image = raw[message.header.stamp.nanosec]
        assert np.abs(picture - image.data.reshape(image.height, image.width, 3)).mean() < 12


def test_full_images_are_whole_and_their_jpegs_come_close_to_the_real_size() -> None:
    messages = RobotMessages()
    timed = driven(0.2, frames=FrameSize.FULL)

    raw = {len(messages.payload(r.topic, r.message)) for r in timed if r.topic is RobotTopic.IMAGE}
    compressed = {
        len(messages.payload(r.topic, r.message)) for r in timed if r.topic is RobotTopic.COMPRESSED_IMAGE
    }

    assert all(size == pytest.approx(6_220_000, rel=1e-3) for size in raw)
    assert all(350_000 < size <= 420_100 for size in compressed)


def test_medium_frames_fill_a_thin_link_compressed() -> None:
    messages = RobotMessages()
    timed = driven(0.2, frames=FrameSize.MEDIUM)

    sizes = [
        len(messages.payload(r.topic, r.message)) for r in timed if r.topic is RobotTopic.COMPRESSED_IMAGE
    ]

    assert sizes
    assert all(80_000 < size <= 100_100 for size in sizes)


def test_the_same_seed_gives_the_same_bytes() -> None:
    first, again, other = (_payloads(driven(0.5, seed=seed)) for seed in (3, 3, 4))

    assert first == again
    assert first != other
    assert first[0][0] >= START_NS


@pytest.mark.full
@pytest.mark.parametrize("kind", RobotKind)
@pytest.mark.parametrize("release", [Stores.ROS2_HUMBLE, Stores.ROS2_JAZZY])
def test_every_message_of_a_robot_with_physics_decodes_with_its_stamp_and_what_was_measured(
    kind: RobotKind, release: Stores
) -> None:
    types = get_typestore(release)
    last: dict[RobotTopic, Any] = {}
    with robot_of(kind, has_camera=False, battery_percent=50) as robot:
        messages = RobotMessages(robot.topics, has_range_variance=release is not Stores.ROS2_HUMBLE)
        for timed in until(robot, robot.start(START_NS), 1.2):
            payload = messages.payload(timed.topic, timed.message)
            message: Any = types.deserialize_cdr(payload, messages.channels[timed.topic].type_name)
            last[timed.topic] = message
            if timed.topic is not RobotTopic.CMD_VEL:
                assert stamp_ns(message) == stamp_ns(timed.message)
    assert set(last) == set(robot.topics)
    assert last[RobotTopic.BATTERY_STATE].percentage == pytest.approx(0.5, abs=0.001)
    assert last[RobotTopic.AMCL_POSE].pose.pose.position.x == pytest.approx(10.8, abs=0.2)
    if kind is RobotKind.QUADROTOR:
        assert last[RobotTopic.RANGE].range > 0.03
        assert last[RobotTopic.ODOM].pose.pose.position.z > 0.05


def test_a_twist_of_others_is_read_and_damaged_ones_are_refused() -> None:
    messages = RobotMessages()
    asked = BodyVelocity(0.2, -0.3, lateral_m_per_s=0.1, climb_m_per_s=0.4)
    payload = messages.payload(RobotTopic.CMD_VEL, command(asked))
    assert messages.velocity(payload) == asked
    for damaged in (b"", payload[:20], payload[:4] + b"\xff" * 48):
        with pytest.raises(ValueError, match=r"it is no Twist|not all finite"):
            messages.velocity(damaged)
