# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Which messages still count, however old they are."""

from __future__ import annotations

from pacing.test_frame_reader import tf_message
from smarttestudo.runtime.incidents.latched import LatchedSamples
from smarttestudo.runtime.incidents.topic_ring import SourceMessage


def static_transforms(number: int, *children: str) -> SourceMessage:
    payload = tf_message([("base", child) for child in children], number, little_endian=True)
    return SourceMessage(number, "/tf_static", number, payload)


def test_every_static_frame_stays_with_its_last_transform() -> None:
    samples = LatchedSamples("/tf_static")
    first, second, again = (
        static_transforms(1, "camera", "imu"),
        static_transforms(2, "lidar"),
        static_transforms(3, "imu"),
    )
    for message in (first, second, again):
        samples.add(message, None)
    assert list(samples) == [first, second, again]
    newest = static_transforms(4, "camera", "imu")
    samples.add(newest, None)
    assert list(samples) == [second, newest]
    assert samples.held_bytes == second.held_bytes + newest.held_bytes


def test_each_publisher_of_another_topic_has_its_last_message() -> None:
    samples = LatchedSamples("/map")
    for number, publisher in enumerate("abab"):
        samples.add(SourceMessage(number, "/map", number, b""), publisher)
    assert [message.number for message in samples] == [2, 3]


def test_publishers_that_come_and_go_do_not_pile_up() -> None:
    samples = LatchedSamples("/map")
    for number in range(5000):
        samples.add(SourceMessage(number, "/map", number, b""), number)
    assert [message.number for message in samples] == list(range(4000, 5000))
