# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Datagrams between two machines whose network changes: back within two seconds, and nothing of Full lost."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from itertools import pairwise

import pytest

from link.zenoh.datagram_process import EVENTS, End, end_in
from link.zenoh.ends import until
from thin_link.emulated_path import PathConditions
from thin_link.network_namespaces import OPERATOR_ADDRESS, OPERATOR_ADDRESS_V6, ThinLink, thin_link

pytestmark = [pytest.mark.full, pytest.mark.usefixtures("network_namespaces")]
RADIO = PathConditions(rate_bits_per_s=2e6, delay_ms=15, jitter_ms=5, loss=0.05)
BACK_WITHIN_S = 2.0
GOES_ON_S = 9.0


@contextmanager
def ends_over(link: ThinLink, host: str = OPERATOR_ADDRESS) -> Iterator[tuple[End, End]]:
    """The robot's end and the operator's, between which what is relayed goes as datagrams."""
    endpoint = f"tcp/[{host}]:7447" if ":" in host else f"tcp/{host}:7447"
    with ExitStack() as opened:
        operator = opened.enter_context(end_in(link.operator, "operator", endpoint))
        robot = opened.enter_context(end_in(link.robot, "robot", endpoint))
        until(lambda: bool(robot.newest("by_datagrams")))
        until(lambda: len(operator.numbers("/odom")) > 20)
        yield robot, operator


def go_on(robot: End, operator: End) -> None:
    """Let it run for a while, and end with all that was offered on its way."""
    time.sleep(GOES_ON_S)
    robot.finish()
    until(lambda: robot.numbers("offered")[-1] in operator.numbers(EVENTS.topic))


def require_whole(robot: End, operator: End) -> None:
    odom, events = operator.numbers("/odom"), operator.numbers(EVENTS.topic)
    assert odom == sorted({*odom})
    assert events == list(range(events[0], robot.numbers("offered")[-1] + 1))


def longest_gap_s(operator: End, since_s: float) -> float:
    times_s = [at_s for at_s in operator.times_s("/odom") if at_s > since_s - 1]
    return max(after - before for before, after in pairwise(times_s))


@pytest.mark.calm
@pytest.mark.parametrize(
    ("is_behind_nat", "change"),
    [
        (False, lambda link: link.move_robot("10.99.0.77/24")),
        (True, lambda link: link.rebind()),
        # What it loses from then on, TCP sends again, and may take seconds for that.
        (False, lambda link: link.change(replace(RADIO, loss=0.0, blocks_udp=True))),
    ],
    ids=["the robot's address", "the port of its router", "no UDP any more"],
)
def test_what_changes_in_the_network_costs_two_seconds_and_nothing_of_full(
    *, is_behind_nat: bool, change: Callable[[ThinLink], None]
) -> None:
    with thin_link(RADIO, is_behind_nat=is_behind_nat) as link, ends_over(link) as (robot, operator):
        since_s = time.monotonic()
        change(link)
        go_on(robot, operator)
        gap_s = longest_gap_s(operator, since_s)
    require_whole(robot, operator)
    assert gap_s < BACK_WITHIN_S


def test_udp_that_is_blocked_from_the_beginning_is_said_and_used_once_it_passes() -> None:
    with thin_link(replace(RADIO, blocks_udp=True)) as link, ExitStack() as opened:
        endpoint = f"tcp/{OPERATOR_ADDRESS}:7447"
        operator = opened.enter_context(end_in(link.operator, "operator", endpoint))
        robot = opened.enter_context(end_in(link.robot, "robot", endpoint))
        until(lambda: str(robot.newest("warning")).startswith("no datagrams come through"))
        assert not robot.newest("by_datagrams")
        assert operator.numbers("/odom")
        link.change(RADIO)
        until(lambda: robot.newest("warning") == "datagrams come through again")
        until(lambda: bool(robot.newest("by_datagrams")))
        robot.finish()
        until(lambda: robot.numbers("offered")[-1] in operator.numbers(EVENTS.topic))
    require_whole(robot, operator)
    # The first is of --insecure.
    assert len(robot.times_s("warning")) == 3


def test_datagrams_that_are_not_asked_for_are_used_once_the_radio_loses_some() -> None:
    with thin_link(replace(RADIO, loss=0.0)) as link, ExitStack() as opened:
        endpoint = f"tcp/{OPERATOR_ADDRESS}:7447"
        operator = opened.enter_context(end_in(link.operator, "operator", endpoint))
        robot = opened.enter_context(end_in(link.robot, "auto", endpoint))
        until(lambda: len(operator.numbers("/odom")) > 150)
        assert True not in [value for _, what, value in robot.said if what == "by_datagrams"]
        link.change(replace(RADIO, loss=0.08))
        until(lambda: bool(robot.newest("by_datagrams")), within_s=60)
        robot.finish()
        until(lambda: robot.numbers("offered")[-1] in operator.numbers(EVENTS.topic))
    require_whole(robot, operator)


@pytest.mark.parametrize("host", [OPERATOR_ADDRESS, OPERATOR_ADDRESS_V6])
def test_a_path_that_takes_1280_bytes_carries_datagrams_whole(host: str) -> None:
    with thin_link(replace(RADIO, mtu_bytes=1_280)) as link, ends_over(link, host) as (robot, operator):
        robot.finish()
        until(lambda: robot.numbers("offered")[-1] in operator.numbers(EVENTS.topic))
    require_whole(robot, operator)
