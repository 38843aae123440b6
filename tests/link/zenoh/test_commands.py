# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What an operator sends arrives at the robot that accepts it, over a real link on this machine."""

from __future__ import annotations

import random
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import pytest

from link.zenoh.ends import free_endpoint, refuse_warning, until
from smarttestudo.domain.errors import RosError
from smarttestudo.domain.robot import Payload
from smarttestudo.link.protocol.commands import CommandedRobot
from smarttestudo.link.zenoh import open_operator_end, open_robot_end
from smarttestudo.link.zenoh.commands import CommandInbox, CommandOutbox
from smarttestudo.link.zenoh.security import LinkOptions

pytestmark = pytest.mark.full

JOY, GOAL = "/joy", "/goal_pose"
TYPE = "sensor_msgs/msg/Joy"
RANDOM = random.Random(3)


class Published:
    """A publisher that remembers; it ``fails`` when asked to."""

    def __init__(self) -> None:
        self.payloads: list[bytes] = []
        self.fails = False

    def publish(self, payload: Payload) -> None:
        if self.fails:
            raise RosError("it is full", place=JOY)
        self.payloads.append(payload[:])

    def close(self) -> None: ...


@contextmanager
def accepting(
    endpoint: str, name: str = "ada", warn: Callable[[str], None] = refuse_warning
) -> Iterator[tuple[CommandInbox, Published]]:
    """A robot that accepts both topics."""
    options = LinkOptions(connect=(endpoint,), commands=(GOAL, JOY))
    with open_robot_end(name, options, warn) as end:
        assert end.commands is not None
        published = Published()
        end.commands.follow(JOY, TYPE, published)
        yield end.commands, published


@contextmanager
def sending(endpoint: str, *names: str) -> Iterator[CommandOutbox]:
    with open_operator_end(LinkOptions(listen=(endpoint,), commands=names or (JOY,)), refuse_warning) as end:
        assert end.commands is not None
        yield end.commands


def heard(outbox: CommandOutbox, name: str = "ada") -> CommandedRobot:
    """The robot, once it has told what it accepts."""

    def found() -> list[CommandedRobot]:
        return [robot for robot in outbox.robots() if robot.boot.robot == name and robot.topics]

    until(lambda: bool(found()), outbox.pump)
    return found()[0]


@pytest.mark.contract
def test_a_message_arrives_byte_for_byte_and_both_ends_count_it() -> None:
    endpoint = free_endpoint()
    with sending(endpoint, JOY) as outbox, accepting(endpoint, warn=print) as (inbox, published):
        boot = heard(outbox).boot
        payloads = [RANDOM.randbytes(size) for size in (0, 1, 300, 64_000)]
        for payload in payloads:
            # What a machine that stands still makes too old is sent once more.
            until(lambda: payload in published.payloads, lambda: outbox.send(boot, JOY, b"", payload))  # noqa: B023
        assert [*dict.fromkeys(published.payloads)] == payloads
        until(lambda: heard(outbox).topics[JOY].delivered == len(published.payloads), outbox.pump)
        assert heard(outbox).counts[JOY].sent >= len(published.payloads)
        assert heard(outbox).topics[GOAL].type_name is None
        # One that was sent once more may still be on its way.
        until(
            lambda: [topic.delivered for topic in inbox.topics] == [0, len(published.payloads)], outbox.pump
        )
        assert [topic.topic for topic in inbox.topics] == [GOAL, JOY]
        until(lambda: inbox.sent_names() == [(JOY,)], outbox.pump)
        assert not outbox.send(boot, JOY, b"", bytes(64_001))


@pytest.mark.contract
def test_what_waits_while_the_robot_is_away_is_never_delivered() -> None:
    endpoint = free_endpoint()
    with sending(endpoint) as outbox:
        with accepting(endpoint, warn=print):
            boot = heard(outbox).boot
        for number in range(20):
            outbox.send(boot, JOY, b"", bytes([number]))
        with accepting(endpoint, warn=print) as (_, published):
            until(lambda: heard(outbox).boot != boot, outbox.pump)
            end_s = time.monotonic() + 1.0
            until(lambda: time.monotonic() > end_s, outbox.pump)
            assert published.payloads == []
            boot = heard(outbox).boot
            until(lambda: bool(published.payloads), lambda: outbox.send(boot, JOY, b"", b"new"))
            assert {*published.payloads} == {b"new"}
