# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a robot sends arrives at an operator, over a real link on this machine."""

from __future__ import annotations

import random
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

pytestmark = pytest.mark.full


def arrives_whole(payload: bytes) -> None:
    """A message arrives as it was published."""
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


@pytest.mark.contract
def test_a_message_arrives_byte_for_byte_with_its_type_and_qos() -> None:
    arrives_whole(random.Random(1).randbytes(100_000))


@pytest.mark.contract
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


@pytest.mark.contract
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
