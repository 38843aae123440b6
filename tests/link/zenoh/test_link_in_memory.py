# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What is said, replaced and closed on a link in memory."""

from __future__ import annotations

import struct
from dataclasses import replace

import pytest

from link.zenoh.ends import MAP, ODOM, Reader, free_endpoint, operator_end, robot_end, until
from link.zenoh.memory_zenoh import network
from link.zenoh.test_link import arrives_whole
from smarttestudo.link.zenoh import open_operator_end
from smarttestudo.link.zenoh.arrivals import StreamSaid
from smarttestudo.link.zenoh.security import LinkOptions

__all__ = ["network"]
pytestmark = pytest.mark.usefixtures("network")


def transform(frame: str, z: float) -> bytes:
    """A tf2_msgs/msg/TFMessage with one transform."""
    parent, child = (struct.pack("<I8s", 8, name.encode()) for name in ("map", frame))
    place = struct.pack("<4x7d", 0.0, 0.0, z, 0.0, 0.0, 0.0, 1.0)
    return b"\0\1\0\0" + struct.pack("<III", 1, 0, 0) + parent + child + place


@pytest.mark.parametrize("payload", [b"", b"x", bytes(300_000)])
def test_a_message_arrives_byte_for_byte_with_its_type_and_qos(payload: bytes) -> None:
    arrives_whole(payload)


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
