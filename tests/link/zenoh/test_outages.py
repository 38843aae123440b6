# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A link goes on without a hand after either end was killed or stood still."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from link.zenoh.ends import MAP, ODOM, free_endpoint, robot_end, until
from link.zenoh.operator_process import OperatorProcess

pytestmark = pytest.mark.full


@contextmanager
def operator_process(endpoint: str) -> Iterator[OperatorProcess]:
    """An operator in a process of its own, killed in the end."""
    process = OperatorProcess(endpoint)
    try:
        yield process
    finally:
        process.kill()


@pytest.mark.contract
def test_a_killed_operator_that_starts_again_gets_what_is_sent_from_then_on() -> None:
    endpoint = free_endpoint()
    with robot_end(endpoint, warn=print) as robot:
        latched, other = robot.advertise(MAP), robot.advertise(ODOM)
        latched.publish(b"map")
        for payload in (b"before", b"after"):
            with operator_process(endpoint) as operator:
                until(
                    lambda: {b"map", payload} <= set(operator.payloads),  # noqa: B023
                    lambda: other.publish(payload),  # noqa: B023
                )
        assert set(operator.payloads) == {b"map", b"after"}


def test_an_operator_that_stands_still_holds_up_nobody_and_gets_the_newest_then() -> None:
    endpoint = free_endpoint()
    with robot_end(endpoint, warn=print) as robot, operator_process(endpoint) as operator:
        publisher = robot.advertise(ODOM)
        until(lambda: b"before" in operator.payloads, lambda: publisher.publish(b"before"))
        operator.process.send_signal(signal.SIGSTOP)
        until(lambda: not robot.state.is_connected, lambda: publisher.publish(bytes(1_000_000)))
        for _ in range(1_000):
            publisher.publish(bytes(1_000_000))
        assert robot.counts()["/odom"].queued_bytes <= 2_000_000
        operator.process.send_signal(signal.SIGCONT)
        until(lambda: b"after" in operator.payloads, lambda: publisher.publish(b"after"))
