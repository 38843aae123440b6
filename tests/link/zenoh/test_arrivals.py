# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What waits at the operator's end while nobody reads."""

from __future__ import annotations

from dataclasses import replace

from link.zenoh.ends import MAP, ODOM
from smarttestudo.domain.link import ReceivedMessage, StreamInfo
from smarttestudo.link.zenoh.arrivals import EventQueue, LinkEvent, RobotPresence


def message(stream: StreamInfo, number: int, size_bytes: int = 10_000) -> ReceivedMessage:
    """A message that can be told from others."""
    payload = bytes(size_bytes)
    return ReceivedMessage(robot="r1", stream=stream, payload=payload, offered_ns=number, age_ns=None)


def test_what_arrived_is_read_once_and_in_order() -> None:
    arrivals = EventQueue(60_000)
    events: list[LinkEvent] = [
        RobotPresence(robot="r1", boot="0", is_present=True),
        message(ODOM, 1),
        message(MAP, 2),
        message(ODOM, 3),
    ]
    for event in events:
        arrivals.put(event)
    assert arrivals.wait(0) == events
    assert arrivals.wait(0) == []


def test_the_oldest_messages_give_way_and_latched_ones_stay() -> None:
    arrivals = EventQueue(60_000)
    presence = RobotPresence(robot="r1", boot="0", is_present=True)
    arrivals.put(presence)
    arrivals.put(message(MAP, 0))
    for number in range(1, 101):
        arrivals.put(message(ODOM, number))
    assert arrivals.wait(0) == [presence, message(MAP, 0), *(message(ODOM, n) for n in range(97, 101))]
    assert arrivals.dropped == 96


def test_what_waits_is_bounded_whatever_it_is() -> None:
    arrivals = EventQueue(60_000)
    for number in range(100):
        arrivals.put(message(MAP, number))
        arrivals.put(RobotPresence(robot="r1", boot=str(number), is_present=True))
    left = arrivals.wait(0)
    assert arrivals.dropped == 200 - len(left)
    assert sum(len(event.payload) for event in left if isinstance(event, ReceivedMessage)) <= 60_000
    assert left[-1] == RobotPresence(robot="r1", boot="99", is_present=True)


def test_the_newest_arrives_though_it_is_too_large() -> None:
    arrivals = EventQueue(10)
    large = message(replace(ODOM, topic="/large"), 7)
    arrivals.put(message(ODOM, 1))
    arrivals.put(large)
    assert arrivals.wait(0) == [large]
