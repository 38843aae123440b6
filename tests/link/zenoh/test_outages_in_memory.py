# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A link in memory goes on without a hand after either end was away or did not read."""

from __future__ import annotations

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
from link.zenoh.memory_zenoh import Network, network
from smarttestudo.link.zenoh import open_operator_end, open_robot_end
from smarttestudo.link.zenoh.arrivals import RobotPresence, StreamSaid
from smarttestudo.link.zenoh.security import LinkOptions

__all__ = ["network"]
pytestmark = pytest.mark.usefixtures("network")


def test_latched_messages_come_to_an_operator_that_starts_later_and_again_to_the_next() -> None:
    endpoint = free_endpoint()
    with robot_end(endpoint, warn=print) as robot:
        latched, other = robot.advertise(MAP), robot.advertise(ODOM)
        latched.publish(b"old map")
        latched.publish(b"map")
        for _ in range(2):
            with operator_end(endpoint) as operator:
                reader = Reader(operator)
                until(lambda: bool(reader.payloads("/map")))  # noqa: B023
                assert reader.payloads("/map") == [b"map"]
                until(lambda: bool(reader.payloads()), lambda: other.publish(b"pose"))  # noqa: B023


def test_an_operator_that_leaves_makes_room_at_once() -> None:
    endpoint = free_endpoint()
    # Where no time passes, nobody is missed because of silence.
    with open_robot_end("r1", LinkOptions(connect=(endpoint,)), print, clock=lambda: 1) as robot:
        robot.advertise(MAP).publish(b"map")
        for _ in range(2):
            with operator_end(endpoint) as operator:
                reader = Reader(operator)
                until(lambda: bool(reader.payloads("/map")))  # noqa: B023
                until(lambda: robot.state.is_connected)
            until(lambda: not robot.state.is_connected)


def test_a_robot_that_was_away_is_said_to_be_gone_and_back() -> None:
    endpoint = free_endpoint()
    with operator_end(endpoint) as operator:
        reader = Reader(operator)
        for payload in (b"one", b"two"):
            with robot_end(endpoint) as robot:
                publisher = robot.advertise(ODOM)
                until(
                    lambda: payload in reader.payloads(),  # noqa: B023
                    lambda: publisher.publish(payload),  # noqa: B023
                )
            gone = RobotPresence(robot="r1", boot=robot.boot.number, is_present=False)
            until(lambda: gone in reader.read())  # noqa: B023


def test_what_a_robot_has_is_said_again_when_it_is_back(network: Network) -> None:
    endpoint = free_endpoint()
    with operator_end(endpoint) as operator, robot_end(endpoint) as robot:
        reader = Reader(operator)
        robot.advertise(MAP)
        until(lambda: len(reader.read()) == 2)
        session = network.sessions.pop()
        network.settle()
        network.sessions.append(session)
        network.settle()
        name, boot = robot.boot
        away, back = (RobotPresence(robot=name, boot=boot, is_present=there) for there in (False, True))
        has = StreamSaid(robot=name, boot=boot, number=1, info=MAP)
        until(lambda: reader.read()[1:5] == [has, away, back, has])


def test_who_does_not_read_loses_the_oldest_and_holds_up_nobody() -> None:
    endpoint = free_endpoint()
    options = LinkOptions(listen=(endpoint,))
    with (
        open_operator_end(options, refuse_warning, most_waiting_bytes=100_000) as operator,
        robot_end(endpoint) as robot,
    ):
        latched, other = robot.advertise(MAP), robot.advertise(ODOM)
        latched.publish(b"map")
        number = 0

        def publish() -> None:
            nonlocal number
            number += 1
            other.publish(number.to_bytes(4, "big") * 2_500)

        until(lambda: operator.dropped >= 20, publish)
        assert robot.state.is_connected
        waiting = messages(operator.wait(1.0))
        assert waiting[0].payload == b"map"
        assert sum(len(message.payload) for message in waiting) <= 100_000
        numbers = [int.from_bytes(message.payload[:4], "big") for message in waiting[1:]]
        assert numbers[0] > 1
        assert numbers == sorted(numbers)


def test_a_robot_that_loses_the_reliable_link_alone_is_there_by_datagrams_until_these_end(
    network: Network,
) -> None:
    endpoint = free_endpoint()
    port = int(endpoint.rpartition(":")[2])
    listening = LinkOptions(listen=(endpoint,), datagrams_port=port)
    connecting = LinkOptions(connect=(endpoint,), datagrams_port=port + 20_000, needs_datagrams=True)
    with (
        open_operator_end(listening, refuse_warning) as operator,
        open_robot_end("r1", connecting, refuse_warning) as robot,
    ):
        reader, publisher = Reader(operator), robot.advertise(ODOM)
        until(lambda: robot.state.by_datagrams, lambda: publisher.publish(b"before"))
        network.sessions.pop()
        network.settle()
        until(lambda: reader.payloads().count(b"cut") >= 10, lambda: publisher.publish(b"cut"))
        name, boot = robot.boot
        gone = RobotPresence(robot=name, boot=boot, is_present=False)
        assert gone not in reader.read()
        robot.close()
        until(lambda: gone in reader.read())
