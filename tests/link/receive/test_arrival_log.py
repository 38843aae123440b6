# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a file or a journal has of robots that come, leave and change."""

from __future__ import annotations

from dataclasses import replace

from link.zenoh.ends import MAP, ODOM
from smarttestudo.domain.link import ReceivedMessage, StreamInfo
from smarttestudo.link.receive.arrival_log import ArrivalLog
from smarttestudo.link.zenoh.arrivals import LinkEvent, RobotPresence, StreamSaid


def lines(*events: LinkEvent) -> list[str]:
    said: list[str] = []
    log = ArrivalLog(said.append)
    for event in events:
        log.handle(event)
    return said


def presence(boot: str, *, is_present: bool) -> RobotPresence:
    return RobotPresence(robot="ada", boot=boot, is_present=is_present)


def stream(info: StreamInfo | None, number: int = 1) -> StreamSaid:
    return StreamSaid(robot="ada", boot="0", number=number, info=info)


def test_a_robot_that_comes_leaves_and_is_back_is_a_line_each() -> None:
    come, leave = presence("0", is_present=True), presence("0", is_present=False)
    assert lines(come, come, leave, leave, come) == [
        "ada: connected",
        "ada: not connected any more",
        "ada: connected",
    ]


def test_two_robots_of_one_name_are_said() -> None:
    events = [
        presence(boot, is_present=is_present)
        for boot, is_present in (("0", True), ("1", True), ("0", False), ("1", False))
    ]
    assert lines(*events) == [
        "ada: connected",
        "ada: 2 robots of this name are connected",
        "ada: one robot of this name",
        "ada: not connected any more",
    ]


def test_a_topic_is_said_when_it_is_new_or_has_another_type_and_messages_are_not() -> None:
    other = replace(ODOM, type_name="acme_msgs/msg/Odometry")
    message = ReceivedMessage(robot="ada", stream=ODOM, payload=b"", offered_ns=0, age_ns=None)
    again = replace(ODOM, publisher=1)
    assert lines(
        stream(ODOM), message, stream(again, 2), stream(MAP, 3), stream(None), stream(ODOM), stream(other)
    ) == [
        "ada: sends /odom (nav_msgs/msg/Odometry)",
        "ada: sends /map (nav_msgs/msg/OccupancyGrid)",
        "ada: /odom is acme_msgs/msg/Odometry now, not nav_msgs/msg/Odometry",
    ]
