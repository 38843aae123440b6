# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Which messages still count, however old they are."""

from __future__ import annotations

from pacing.test_stream_reader import tf_message
from smarttestudo.incidents.latched import LatchedSamples
from smarttestudo.incidents.topic_ring import SourceMessage


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
        samples.add(message, None, message.number)
    assert samples.counting_at(10) == [first, second, again]
    newest = static_transforms(4, "camera", "imu")
    samples.add(newest, None, 4)
    assert samples.counting_at(10) == [second, newest]
    # A window that begins earlier shows what counted then.
    assert samples.counting_at(5) == [second, newest]
    assert samples.counting_at(4) == [first, second, again]
    assert samples.counting_at(3) == [first, second]
    assert samples.since(3) == [again, newest]
    samples.forget_before(10)
    assert samples.held_bytes == second.held_bytes + newest.held_bytes
    assert samples.replaced_bytes == 0
    assert samples.complete_since_ns == 4


def test_each_publisher_of_another_topic_has_its_last_message() -> None:
    samples = LatchedSamples("/map")
    for number, publisher in enumerate("abab"):
        samples.add(SourceMessage(number, "/map", number, b""), publisher, number)
    assert [message.number for message in samples.counting_at(10)] == [2, 3]
    assert [message.number for message in samples.counting_at(2)] == [0, 1]
    assert [message.number for message in samples.counting_at(1)] == [0]
    assert samples.complete_since_ns is None


def test_publishers_that_come_and_go_do_not_pile_up() -> None:
    samples = LatchedSamples("/map")
    for number in range(5000):
        samples.add(SourceMessage(number, "/map", number, b""), number, number)
        samples.forget_before(number)
    assert [message.number for message in samples.counting_at(5000)] == list(range(4000, 5000))


def test_what_publishers_that_are_gone_latched_is_kept_for_windows_from_before_that_alone() -> None:
    samples = LatchedSamples("/map")
    for number, publisher in enumerate("abab"):
        samples.add(SourceMessage(number, "/map", number, b""), publisher, number)
    samples.forget_before(5)
    both_bytes = samples.held_bytes
    samples.end("a", 10)
    assert [message.number for message in samples.counting_at(10)] == [2, 3]
    assert [message.number for message in samples.counting_at(11)] == [3]
    assert samples.publishers == ("b",)
    samples.forget_before(11)
    assert samples.held_bytes == both_bytes // 2


def test_what_was_given_up_is_counted_while_a_window_may_ask_for_it() -> None:
    samples = LatchedSamples("/map")
    for number in range(4):
        samples.add(SourceMessage(number, "/map", number, bytes(1000)), None, number)
    before = samples.held_bytes
    assert samples.give_up_oldest() == (1, SourceMessage(0, "/map", 0, bytes(1000)))
    assert samples.held_bytes < before
    assert [one.number for one in samples.given_up_of(0)] == [0]
    assert [one.number for one in samples.given_up_of(1)] == [0]
    assert samples.given_up_of(2) == []
    assert [one.number for one in samples.counting_at(2)] == [1]
    assert [one.number for one in samples.since(1)] == [1, 2, 3]
