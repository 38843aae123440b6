# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A link between namespaces does what its model does in virtual time, and changes while it runs."""

from __future__ import annotations

import time
from dataclasses import replace
from itertools import pairwise

import pytest

from datagram_ends import HEADERS_BYTES, Arrived, receiver, send, sender
from link.protocol.simulated_link import quantile
from thin_link.emulated_path import EmulatedPath, PathConditions
from thin_link.network_namespaces import (
    OPERATOR_ADDRESS,
    OPERATOR_ADDRESS_V6,
    ROBOT_ADDRESS,
    thin_link,
)
from thin_link.scenario import load_scenario, scenario_paths

pytestmark = [pytest.mark.full, pytest.mark.usefixtures("network_namespaces")]
SECONDS = 4.0
SIZE_BYTES = 1_000
SEED = 5
MOST_OFF_MS = 5.0
MOST_OFF = 0.03
FAST = PathConditions(rate_bits_per_s=50e6, delay_ms=1)


def in_virtual_time(conditions: PathConditions, sent_ns: list[int]) -> list[tuple[int, int]]:
    """The numbers that arrive of the same datagrams over the model alone, each with its time."""
    path = EmulatedPath[int](conditions, 2 * SEED)
    arrived = list[tuple[int, int]]()

    def take_until(end_ns: float) -> None:
        while (wake_ns := path.wake_ns) is not None and wake_ns <= end_ns:
            arrived.extend((number, wake_ns) for number in path.take(wake_ns))

    for number, at_ns in enumerate(sent_ns):
        take_until(at_ns)
        path.put(number, SIZE_BYTES + HEADERS_BYTES[OPERATOR_ADDRESS], at_ns)
    take_until(float("inf"))
    return arrived


def over_a_link(conditions: PathConditions, load: float) -> tuple[list[int], list[Arrived]]:
    """When datagrams were sent that take ``load`` of the rate, and those that arrived."""
    period_s = (SIZE_BYTES + HEADERS_BYTES[OPERATOR_ADDRESS]) * 8 / conditions.rate_bits_per_s / load
    with thin_link(conditions, SEED) as link, receiver(link) as arrived:
        sent_ns = send(link, int(SECONDS / period_s), size_bytes=SIZE_BYTES, period_s=period_s)
        time.sleep(1.0)
        return sent_ns, arrived()


@pytest.mark.calm
@pytest.mark.calm
@pytest.mark.parametrize(
    ("name", "load"),
    [
        ("clean", 0.5),
        ("starlink", 1.5),
        ("4g", 0.5),
        ("wifi-walls", 0.5),
        ("wifi-walls", 1.5),
        ("severe", 0.5),
    ],
)
def test_a_link_agrees_with_its_model_in_loss_rate_and_delay(name: str, load: float) -> None:
    conditions = load_scenario(scenario_paths()[name]).conditions
    sent_ns, found = over_a_link(conditions, load)
    expected = in_virtual_time(conditions, sent_ns)
    real = [(one.number, one.at_ns) for one in found]
    if load < 1:
        # Nothing waits long enough to overflow, so the same packets are lost.
        assert [number for number, _ in real] == [number for number, _ in expected]
    assert len(real) / len(sent_ns) == pytest.approx(len(expected) / len(sent_ns), abs=MOST_OFF)
    assert rate_hz(real) == pytest.approx(rate_hz(expected), rel=MOST_OFF)
    took_ms, would_take_ms = (
        [(at_ns - sent_ns[number]) / 1e6 for number, at_ns in arrived] for arrived in (real, expected)
    )
    for share in (0.05, 0.5, 0.95):
        assert quantile(took_ms, share) == pytest.approx(quantile(would_take_ms, share), abs=MOST_OFF_MS)


def rate_hz(arrived: list[tuple[int, int]]) -> float:
    return (len(arrived) - 1) * 1e9 / (arrived[-1][1] - arrived[0][1])


def test_packets_out_of_order_and_copies_are_those_that_were_asked_for() -> None:
    conditions = replace(FAST, reordered=0.2, duplicated=0.1)
    with thin_link(conditions) as link, receiver(link) as arrived:
        send(link, 500, period_s=0.002)
        time.sleep(0.2)
        numbers = [one.number for one in arrived()]
        counts, _ = link.counts()
    assert set(numbers) == set(range(500))
    assert len(numbers) - 500 == counts.duplicated > 20
    assert sum(after < before for before, after in pairwise(numbers)) > 50


def test_udp_is_blocked_and_opened_while_tcp_goes_on() -> None:
    with thin_link(FAST) as link, receiver(link) as arrived:
        for first, is_blocked in ((0, False), (10, True), (20, False)):
            link.change(replace(FAST, blocks_udp=is_blocked))
            send(link, 10, first=first)
            send(link, 10, first=first, to=OPERATOR_ADDRESS_V6)
        time.sleep(0.2)
        numbers = [one.number for one in arrived()]
        counts, _ = link.counts()
    assert sorted(numbers) == sorted([*range(10), *range(20, 30)] * 2)
    assert counts.blocked == 20


def test_the_robot_s_address_changes_while_the_link_runs() -> None:
    with thin_link(FAST) as link, receiver(link) as arrived:
        send(link, 3)
        link.move_robot("10.99.0.77/24")
        send(link, 3, first=3)
        time.sleep(0.2)
        hosts = [one.host.removeprefix("::ffff:") for one in arrived()]
    assert hosts == ["10.99.0.1"] * 3 + ["10.99.0.77"] * 3


def test_a_robot_behind_a_router_has_another_port_after_a_rebinding() -> None:
    with thin_link(FAST, is_behind_nat=True) as link, receiver(link) as arrived:
        with sender(link) as send_next:
            for is_after in (False, True):
                if is_after:
                    link.rebind()
                send_next()
        time.sleep(0.2)
        found = arrived()
    assert [one.number for one in found] == [0, 1]
    assert {one.host.removeprefix("::ffff:") for one in found} == {ROBOT_ADDRESS}
    assert [one.port for one in found] == [40_000, 40_001]


@pytest.mark.parametrize("address", [OPERATOR_ADDRESS, OPERATOR_ADDRESS_V6])
def test_a_link_that_takes_1280_bytes_takes_no_larger_packet(address: str) -> None:
    with thin_link(FAST) as link, receiver(link) as arrived:
        link.change(replace(FAST, mtu_bytes=1_280))
        fits = 1_280 - HEADERS_BYTES[address]
        send(link, 3, size_bytes=fits, to=address)
        # The kernel sends it in two parts.
        send(link, 1, size_bytes=fits + 1, to=address, first=3)
        time.sleep(0.2)
        numbers = [one.number for one in arrived()]
        counts, _ = link.counts()
    assert numbers == [0, 1, 2, 3]
    assert (counts.arrived, counts.too_large) == (5, 0)


def test_a_rate_that_falls_is_the_rate_from_then_on() -> None:
    with thin_link(replace(FAST, rate_bits_per_s=8e6)) as link, receiver(link) as arrived:
        send(link, 100, period_s=0.002)
        link.change(replace(FAST, rate_bits_per_s=0.8e6))
        send(link, 100, period_s=0.002, first=100)
        time.sleep(1.0)
        at_ns = {one.number: one.at_ns for one in arrived()}
        counts, _ = link.counts()
    # At 8 Mbit/s they come as they are sent; then 62 fit into the queue, which drains in 640 ms.
    assert (at_ns[99] - at_ns[0]) / 1e9 == pytest.approx(0.198, abs=0.05)
    late = [number for number in at_ns if number >= 100]
    assert (at_ns[late[-1]] - at_ns[late[0]]) / 1e9 == pytest.approx((len(late) - 1) * 0.01028, rel=0.1)
    assert counts.overflowed == 200 - len(at_ns) > 0
