# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What an operator sends arrives at the robot that accepts it, over a real link on this machine."""

from __future__ import annotations

import random
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import pytest
import zenoh

from link.zenoh.ends import free_endpoint, refuse_warning, stranger_at, until
from link.zenoh.slow_wire import slow_wire
from smarttestudo.domain.errors import RosError, UsageError
from smarttestudo.domain.payload import Payload
from smarttestudo.link.protocol.command_sender import CommandedRobot
from smarttestudo.link.protocol.messages import (
    COMMAND_REPORTS,
    COMMANDS,
    CommandMessage,
    CommandReport,
)
from smarttestudo.link.zenoh import open_operator_end, open_robot_end
from smarttestudo.link.zenoh.command_inbox import CommandInbox
from smarttestudo.link.zenoh.command_outbox import CommandOutbox
from smarttestudo.link.zenoh.security import LinkOptions

pytestmark = pytest.mark.process

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


def test_where_the_way_takes_too_long_nothing_is_delivered_and_the_age_is_told() -> None:
    endpoint = free_endpoint()
    with (
        sending(endpoint) as outbox,
        slow_wire(endpoint, 0.3) as near,
        accepting(near, warn=print) as (_, published),
    ):
        boot = heard(outbox).boot
        until(lambda: heard(outbox).topics[JOY].too_old >= 3, lambda: outbox.send(boot, JOY, b"", b"late"))
        assert published.payloads == []
        age_ms = heard(outbox).topics[JOY].age_ms
        assert age_ms is not None
        assert age_ms >= 600


def test_a_topic_without_a_type_takes_nothing_and_a_failure_costs_its_message() -> None:
    endpoint = free_endpoint()
    said: list[str] = []
    with sending(endpoint) as outbox, accepting(endpoint, warn=said.append) as (inbox, published):
        boot = heard(outbox).boot
        published.fails = True
        until(lambda: inbox.topics[1].refused >= 2, lambda: outbox.send(boot, JOY, b"", b"lost"))
        published.fails = False
        inbox.follow(JOY, None, None, "two types subscribe to it")
        until(lambda: heard(outbox).topics[JOY].problem is not None, outbox.pump)
        outbox.send(boot, JOY, b"", b"never")
        inbox.follow(JOY, TYPE, published)
        until(lambda: heard(outbox).topics[JOY].type_name == TYPE, outbox.pump)
        until(lambda: b"now" in published.payloads, lambda: outbox.send(boot, JOY, b"", b"now"))
        assert [line for line in said if "it is full" in line] == ["/joy: error: it is full"]


def test_strangers_reach_nothing_with_malformed_old_stamps_and_forged_reports() -> None:
    endpoint = free_endpoint()
    with (
        sending(endpoint) as outbox,
        accepting(endpoint, warn=print) as (inbox, published),
        stranger_at(endpoint) as other,
    ):
        boot = heard(outbox).boot
        strange = [b"", b"\0" * 40, *(b"\0" + RANDOM.randbytes(size) for size in (20, 60_000, 900_000))]
        old = [
            COMMANDS.to_bytes(
                CommandMessage(sender=9, number=1, topic=1, revision=1, stamp_ns=stamp_ns, payload=b"go")
            )
            for stamp_ns in (0, 2**62)
        ]
        forged = COMMAND_REPORTS.to_bytes(CommandReport(sent_ns=0, acknowledged={1: 2**63}))

        def put_all() -> None:
            """What comes before the stranger knows of both ends reaches nobody."""
            for key, more in ((boot.command_key, old), (boot.accepts_key, [forged])):
                for data in (*strange, *more):
                    other.put(key, data, congestion_control=zenoh.CongestionControl.BLOCK)
            outbox.pump()

        until(lambda: inbox.malformed >= len(strange) and inbox.topics[1].received >= len(old), put_all)
        assert published.payloads == []
        until(lambda: b"new" in published.payloads, lambda: outbox.send(boot, JOY, b"", b"new"))


def test_a_message_to_more_keys_than_the_robots_own_reaches_nothing_there() -> None:
    # Zenoh's access control denies a put where the rule's key includes that of the put.
    endpoint = free_endpoint()
    options = LinkOptions(connect=(endpoint,), commands=(JOY,))
    puts = 0
    with sending(endpoint), open_robot_end("ada", options, print) as end, stranger_at(endpoint) as other:
        assert end.commands is not None
        inbox = end.commands

        def put_all() -> None:
            nonlocal puts
            puts += 1
            for key in ("testudo/**", "**", f"{end.boot.key}/*", "testudo/*/*/command", "testudo/*/*/report"):
                other.put(key, b"", congestion_control=zenoh.CongestionControl.BLOCK)
            for key in (end.boot.command_key, end.boot.report_key):
                other.put(key, b"", congestion_control=zenoh.CongestionControl.BLOCK)

        until(lambda: min(inbox.malformed, end.malformed) >= 3, put_all)
        assert max(inbox.malformed, end.malformed) <= puts


@pytest.mark.parametrize("side", ["listen", "connect"])
def test_nobody_is_driven_over_a_link_that_lets_anybody_in(side: str) -> None:
    endpoints = {side: ("tcp/0.0.0.0:0" if side == "listen" else "tcp/192.0.2.1:7447",)}
    options = LinkOptions(**endpoints, insecure=True, commands=(JOY,))  # type: ignore[arg-type]
    for opened in (open_robot_end("ada", options, print), open_operator_end(options, print)):
        with pytest.raises(UsageError, match="whoever reaches it could drive the robot with /joy"), opened:
            pass
