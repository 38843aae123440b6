# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Two ends of different versions say so at both ends, and ends of the same version go on."""

from __future__ import annotations

import pytest

from link.zenoh.ends import Reader, free_endpoint, operator_end, refuse_warning, robot_end, stranger_at, until
from link.zenoh.other_version import robot_of_version
from link.zenoh.test_hostile import still_works
from smarttestudo.domain.errors import LinkError
from smarttestudo.link.protocol.wire import WIRE_VERSION, other_version
from smarttestudo.link.zenoh import open_link_incidents, open_link_robots
from smarttestudo.link.zenoh.security import LinkOptions

pytestmark = pytest.mark.full


@pytest.mark.parametrize("version", [WIRE_VERSION + 1])
def test_both_ends_say_once_which_version_they_speak_and_other_robots_are_received(version: int) -> None:
    endpoint, warnings = free_endpoint(), list[str]()
    with (
        operator_end(endpoint, warn=warnings.append) as operator,
        robot_of_version(version, "ada", endpoint) as said,
        robot_end(endpoint) as robot,
    ):
        reader = Reader(operator)
        still_works(robot, reader)
        until(lambda: bool(warnings and said), reader.read)
        still_works(robot, reader)
        options = LinkOptions(connect=(endpoint,))
        sentence = (
            f"robot ada speaks version {version} of the link's protocol, and this end version "
            f"{WIRE_VERSION}; update SmartTestudo here"
        )
        with open_link_robots(options, refuse_warning) as robots:
            until(lambda: robots.problem == sentence, lambda: robots.wait(0.02))
        with open_link_incidents(options, refuse_warning) as incidents:
            until(lambda: "ada" in incidents.robots(0))
            with pytest.raises(LinkError, match=sentence):
                incidents.list("ada")
    assert warnings == [sentence]
    assert said == [
        f"an operator's end speaks version {WIRE_VERSION} of the link's protocol, and this end version "
        f"{version}; update SmartTestudo at the other end"
    ]


def test_a_robot_of_the_first_version_is_told_from_what_is_malformed() -> None:
    endpoint, warnings = free_endpoint(), list[str]()
    with (
        operator_end(endpoint, warn=warnings.append),
        robot_end(endpoint) as robot,
        stranger_at(endpoint) as old,
    ):
        # Statuses of it began with 1 or 2.
        for data in (b"\xff" * 50, b"", b"\0", b"\2" + bytes(60)):
            old.put(robot.boot.status_key, data)
        until(lambda: bool(warnings), lambda: old.put(robot.boot.status_key, b"\2" + bytes(60)))
    assert [*map(other_version, (b"\xff", b"", b"\0", bytes([WIRE_VERSION])))] == [None] * 4
    assert warnings == [
        f"robot r1 speaks version 1 of the link's protocol, and this end version {WIRE_VERSION}; "
        "update SmartTestudo at the other end"
    ]
