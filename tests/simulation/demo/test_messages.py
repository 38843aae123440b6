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

from simulation.missions import START_NS, readings
from smarttestudo.simulation.camera import FrameSize
from smarttestudo.simulation.demo.mission import JPEG_BYTES
from smarttestudo.simulation.messages.messages import RobotMessages
from smarttestudo.simulation.readings import Command, Image, Odometry, Scan, TimedReading, Topic, Transforms

THESIS_BYTES = {
    Topic.CMD_VEL: 52,
    Topic.ODOM: 720,
    Topic.CAMERA_INFO: 380,
    Topic.IMU: 320,
    Topic.SCAN: 2940,
}


@pytest.fixture(scope="module")
def second() -> list[TimedReading]:
    return readings(1)


def _decoded(timed: list[TimedReading], messages: RobotMessages) -> Iterator[tuple[TimedReading, Any]]:
    types = get_typestore(Stores.ROS2_HUMBLE)
    for reading in timed:
        payload = messages.payload(reading.topic, reading.reading)
        yield reading, types.deserialize_cdr(payload, messages.channels[reading.topic].type_name)


def _payloads(timed: list[TimedReading]) -> list[tuple[int, bytes]]:
    messages = RobotMessages()
    return [(reading.time_ns, messages.payload(reading.topic, reading.reading)) for reading in timed]


@pytest.mark.parametrize("topic", THESIS_BYTES)
def test_messages_are_as_large_as_on_the_real_robot(topic: Topic, second: list[TimedReading]) -> None:
    messages = RobotMessages()

    sizes = {len(messages.payload(topic, r.reading)) for r in second if r.topic is topic}

    assert len(sizes) == 1
    assert sizes.pop() == pytest.approx(THESIS_BYTES[topic], rel=0.015)


def test_transforms_are_as_large_as_one_of_gazebo_and_two_of_a_robot_state_publisher(
    second: list[TimedReading],
) -> None:
    messages = RobotMessages()
    sizes = {
        len(one.reading.frames): len(messages.payload(one.topic, one.reading))
        for one in second
        if one.topic is Topic.TF and isinstance(one.reading, Transforms)
    }
    assert sizes == {1: 108, 2: 212}


def test_every_message_decodes_with_its_stamp_and_frame(second: list[TimedReading]) -> None:
    for reading, message in _decoded(second, RobotMessages()):
        if isinstance(reading.reading, Command):
            continue
        header = message.transforms[0].header if "transforms" in dir(message) else message.header
        assert header.stamp.sec * 10**9 + header.stamp.nanosec == reading.reading.stamp_ns
        assert header.frame_id


def test_messages_say_what_the_readings_say(second: list[TimedReading]) -> None:
    for timed, message in _decoded(second, RobotMessages()):
        reading = timed.reading
        match reading:
            case Odometry():
                pose = message.pose.pose
                assert (pose.position.x, pose.position.y) == (reading.pose.x_m, reading.pose.y_m)
                assert 2 * math.atan2(pose.orientation.z, pose.orientation.w) == pytest.approx(
                    reading.pose.yaw_rad
                )
                assert message.twist.twist.linear.x == reading.velocity.linear_m_per_s
                assert message.twist.covariance[0] == pytest.approx(reading.linear_noise_m_per_s**2)
            case Scan():
                assert np.array_equal(message.ranges, reading.ranges_m)
                assert message.angle_increment * 360 == pytest.approx(math.tau, abs=1e-5)
            case Transforms():
                assert [t.child_frame_id for t in message.transforms] == [f.child for f in reading.frames]
            case Image() if timed.topic is Topic.IMAGE:
                assert np.array_equal(message.data.reshape(message.height, message.width, 3), reading.pixels)
                assert message.step == message.width * 3


def test_the_calibration_describes_the_image_it_comes_with(second: list[TimedReading]) -> None:
    decoded = list(_decoded(second, RobotMessages()))
    images = {m.header.stamp.nanosec: m for r, m in decoded if r.topic is Topic.IMAGE}

    infos = [m for r, m in decoded if r.topic is Topic.CAMERA_INFO]

    for info in infos:
        image = images[info.header.stamp.nanosec]
        assert (image.width, image.height) == (info.width // info.binning_x, info.height // info.binning_y)
        assert info.k[2] == info.width / 2


def test_compressed_images_are_jpegs_of_the_view(second: list[TimedReading]) -> None:
    decoded = list(_decoded(second, RobotMessages()))
    raw = {m.header.stamp.nanosec: m for r, m in decoded if r.topic is Topic.IMAGE}

    for message in (m for r, m in decoded if r.topic is Topic.COMPRESSED_IMAGE):
        picture = np.asarray(PillowImage.open(io.BytesIO(bytes(message.data)))).astype(float)
        image = raw[message.header.stamp.nanosec]
        assert np.abs(picture - image.data.reshape(image.height, image.width, 3)).mean() < 12


def test_full_images_are_whole_and_their_jpegs_come_close_to_the_real_size() -> None:
    messages = RobotMessages(jpeg_bytes=420_000)
    timed = readings(0.2, frames=FrameSize.FULL)

    raw = {len(messages.payload(r.topic, r.reading)) for r in timed if r.topic is Topic.IMAGE}
    compressed = {
        len(messages.payload(r.topic, r.reading)) for r in timed if r.topic is Topic.COMPRESSED_IMAGE
    }

    assert all(size == pytest.approx(6_220_000, rel=1e-3) for size in raw)
    assert all(350_000 < size <= 420_100 for size in compressed)


def test_medium_frames_fill_a_thin_link_compressed() -> None:
    messages = RobotMessages(jpeg_bytes=JPEG_BYTES[FrameSize.MEDIUM])
    timed = readings(0.2, frames=FrameSize.MEDIUM)

    sizes = [len(messages.payload(r.topic, r.reading)) for r in timed if r.topic is Topic.COMPRESSED_IMAGE]

    assert sizes
    assert all(80_000 < size <= 100_100 for size in sizes)


def test_the_same_seed_gives_the_same_bytes() -> None:
    first, again, other = (_payloads(readings(0.5, seed=seed)) for seed in (3, 3, 4))

    assert first == again
    assert first != other
    assert first[0][0] >= START_NS
