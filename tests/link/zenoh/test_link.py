# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a robot sends arrives at an operator, over a real link on this machine."""

from __future__ import annotations

import random
import struct
from contextlib import ExitStack
from dataclasses import replace

import pytest

from link.zenoh.ends import (
    MAP,
    ODOM,
    Reader,
    free_endpoint,
    messages,
    operator_end,
    refuse_warning,
    robot_end,
    until,
)
from smarttestudo.domain.link import ReceivedMessage
from smarttestudo.link.zenoh import open_operator_end, open_robot_end
from smarttestudo.link.zenoh.arrivals import RobotPresence, StreamSaid
from smarttestudo.link.zenoh.security import LinkOptions

pytestmark = pytest.mark.process


def transform(frame: str, z: float) -> bytes:
    """A tf2_msgs/msg/TFMessage with one transform."""
    parent, child = (struct.pack("<I8s", 8, name.encode()) for name in ("map", frame))
    place = struct.pack("<4x7d", 0.0, 0.0, z, 0.0, 0.0, 0.0, 1.0)
    return b"\0\1\0\0" + struct.pack("<III", 1, 0, 0) + parent + child + place


@pytest.mark.parametrize("payload", [b"", b"x", bytes(300_000), random.Random(1).randbytes(100_000)])
def test_a_message_arrives_byte_for_byte_with_its_type_and_qos(payload: bytes) -> None:
    endpoint = free_endpoint()
    with operator_end(endpoint) as operator, robot_end(endpoint) as robot:
        reader, publisher = Reader(operator), robot.advertise(MAP)
        publisher.publish(payload)
        until(lambda: bool(reader.payloads("/map")))
        # Where a machine that stood still cut the link, all is said again.
        assert [*dict.fromkeys(map(type, reader.events))] == [RobotPresence, StreamSaid, ReceivedMessage]
        assert reader.events[0] == RobotPresence(robot="r1", boot=robot.boot.number, is_present=True)
        assert {one.info for one in reader.events if isinstance(one, StreamSaid)} == {MAP}
        assert {(one.payload, one.stream) for one in messages(reader.events)} == {(payload, MAP)}


def test_each_side_may_be_the_one_that_listens_and_both_may_meet_elsewhere() -> None:
    endpoint, other = free_endpoint(), free_endpoint()
    listens, connects = LinkOptions(listen=(endpoint,)), LinkOptions(connect=(endpoint,))
    for at_robot, at_operator, elsewhere in (
        (listens, connects, LinkOptions(listen=(other,))),
        (connects, LinkOptions(connect=(endpoint,)), listens),
    ):
        with (
            open_operator_end(elsewhere, print),
            open_robot_end("r1", at_robot, print) as robot,
            open_operator_end(at_operator, print) as operator,
        ):
            reader, publisher = Reader(operator), robot.advertise(ODOM)
            until(lambda: bool(reader.payloads()), lambda: publisher.publish(b"one"))  # noqa: B023


def test_a_closed_stream_sends_nothing_and_is_said_to_be_closed() -> None:
    endpoint = free_endpoint()
    with operator_end(endpoint) as operator, robot_end(endpoint) as robot:
        reader, first = Reader(operator), robot.advertise(ODOM)
        until(lambda: bool(reader.payloads()), lambda: first.publish(b"first"))
        first.close()
        first.close()
        second = robot.advertise(MAP)
        first.publish(b"after its end")
        second.publish(b"map")
        until(lambda: bool(reader.payloads("/map")))
        # Where a machine that stood still cut the link, what is open and closed by then is said again.
        assert {*reader.payloads("/map")} == {b"map"}
        assert {*reader.payloads()} == {b"first"}
        said = [event.info for event in reader.events if isinstance(event, StreamSaid)]
        assert [*dict.fromkeys(said)] == [ODOM, None, MAP]


def test_each_set_of_child_frames_replaces_only_itself() -> None:
    endpoint = free_endpoint()
    with robot_end(endpoint, warn=print) as robot:
        publisher = robot.advertise(replace(ODOM, topic="/tf", type_name="tf2_msgs/msg/TFMessage"))
        for z in (1.0, 2.0):
            for frame in ("odom", "base"):
                publisher.publish(transform(frame, z))
        newest = [transform(frame, 2.0) for frame in ("odom", "base")]
        with operator_end(endpoint) as operator:
            reader = Reader(operator)
            until(lambda: len(reader.payloads("/tf")) == 2)
            assert reader.payloads("/tf") == newest


def test_one_operator_is_served_and_the_next_when_that_is_gone() -> None:
    endpoint = free_endpoint()
    connects = LinkOptions(connect=(endpoint,))
    with (
        open_robot_end("r1", LinkOptions(listen=(endpoint,)), refuse_warning) as robot,
        ExitStack() as second_end,
    ):
        publisher = robot.advertise(ODOM)
        with open_operator_end(connects, refuse_warning) as first:
            reader = Reader(first)
            until(lambda: bool(reader.payloads()), lambda: publisher.publish(b"one"))
            second = second_end.enter_context(open_operator_end(connects, refuse_warning))
            until(lambda: bool(second.counts()), reader.read)
        reader = Reader(second)
        until(lambda: b"two" in reader.payloads(), lambda: publisher.publish(b"two"))


def test_an_operator_that_comes_while_another_is_served_gets_what_is_latched_and_that_one_no_twice() -> None:
    endpoint = free_endpoint()
    with operator_end(endpoint) as first, robot_end(endpoint) as robot:
        latched, other = robot.advertise(replace(MAP, qos=replace(MAP.qos, depth=3))), robot.advertise(ODOM)
        for payload in (b"1", b"2", b"3", b"4"):
            latched.publish(payload)
        there = Reader(first)
        until(lambda: there.payloads("/map")[-1:] == [b"4"])
        before = there.payloads("/map")
        with open_operator_end(LinkOptions(connect=(endpoint,)), print) as second:
            late = Reader(second)
            until(lambda: bool(late.payloads("/map")), there.read)
            latched.publish(b"5")
            until(lambda: b"5" in late.payloads("/map"), there.read)
            until(lambda: b"5" in there.payloads("/map"))
            until(lambda: bool(late.payloads()), lambda: other.publish(b"pose"))
            assert late.payloads("/map") == [b"2", b"3", b"4", b"5"]
        assert there.payloads("/map") == [*before, b"5"]


def test_the_robot_knows_what_became_of_its_messages() -> None:
    endpoint = free_endpoint()
    with robot_end(endpoint, warn=print) as robot:
        publisher = robot.advertise(ODOM)
        assert not robot.state.is_connected
        with operator_end(endpoint) as operator:
            reader = Reader(operator)
            until(lambda: len(reader.payloads()) >= 20, lambda: publisher.publish(bytes(1000)))
            until(lambda: robot.age_ms("/odom") is not None and robot.state.is_connected, reader.read)
            assert robot.state.round_trip_ms is not None
            assert robot.counts()["/odom"].sent >= 20


def test_what_arrives_and_what_was_replaced_is_all_that_was_published() -> None:
    endpoint, count = free_endpoint(), 400
    image = replace(ODOM, topic="/image", type_name="sensor_msgs/msg/Image")
    noise = random.Random(2).randbytes(100_000)
    with operator_end(endpoint) as operator, robot_end(endpoint) as robot:
        reader, publisher = Reader(operator), robot.advertise(image)
        until(lambda: robot.state.is_connected, reader.read)
        for number in range(count):
            publisher.publish(number.to_bytes(4, "big") + noise)
            reader.read()

        def numbers() -> list[int]:
            return [int.from_bytes(payload[:4], "big") for payload in reader.payloads("/image")]

        until(lambda: count - 1 in numbers())
        until(lambda: robot.counts()["/image"].sent == len(numbers()))
        counts = robot.counts()["/image"]
        assert numbers() == sorted({*numbers()})
        assert counts.sent + counts.replaced == count
        assert counts.overflowed == counts.queued_bytes == operator.dropped == 0
