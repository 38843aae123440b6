# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What operators and strangers send over a link in memory, and what the robot makes of it."""

from __future__ import annotations

import pytest
import zenoh

from link.zenoh.ends import free_endpoint, stranger_at, until
from link.zenoh.memory_zenoh import network
from link.zenoh.test_commands import JOY, RANDOM, TYPE, accepting, heard, sending
from smarttestudo.domain.errors import UsageError
from smarttestudo.link.protocol.messages import COMMAND_REPORTS, COMMANDS, CommandMessage, CommandReport
from smarttestudo.link.zenoh import open_operator_end, open_robot_end
from smarttestudo.link.zenoh.security import LinkOptions

__all__ = ["network"]
pytestmark = pytest.mark.usefixtures("network")


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
