# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a robot sends arrives at an operator, over a real link on this machine."""

from __future__ import annotations

import random

import pytest

from adapters.zenoh.ends import MAP, ODOM, Reader, free_endpoint, operator_end, robot_end, until
from smarttestudo.adapters.zenoh import open_operator_end, open_robot_end
from smarttestudo.adapters.zenoh.arrivals import RobotPresence, StreamSaid
from smarttestudo.adapters.zenoh.security import LinkOptions

pytestmark = pytest.mark.process


@pytest.mark.parametrize("payload", [b"", b"x", bytes(300_000), random.Random(1).randbytes(100_000)])
def test_a_message_arrives_byte_for_byte_with_its_type_and_qos(payload: bytes) -> None:
    endpoint = free_endpoint()
    with operator_end(endpoint) as operator, robot_end(endpoint) as robot:
        reader, publisher = Reader(operator), robot.advertise(MAP)
        publisher.publish(payload)
        until(lambda: bool(reader.payloads("/map")))
        assert reader.payloads("/map") == [payload]
        presence, said, message = reader.events
        assert presence == RobotPresence(robot="r1", boot=robot.boot.number, is_present=True)
        assert isinstance(said, StreamSaid)
        assert said.info == MAP
        assert message.stream == MAP  # type: ignore[union-attr]


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


def test_the_robot_knows_what_became_of_its_messages() -> None:
    endpoint = free_endpoint()
    with operator_end(endpoint) as operator, robot_end(endpoint) as robot:
        reader, publisher = Reader(operator), robot.advertise(ODOM)
        assert not robot.state.is_connected
        until(lambda: len(reader.payloads()) >= 20, lambda: publisher.publish(bytes(1000)))
        until(lambda: robot.age_ms("/odom") is not None, reader.read)
        assert robot.state.is_connected
        assert robot.state.round_trip_ms is not None
        assert robot.state.round_trip_ms < 1000
        assert robot.counts()["/odom"].sent >= 20
