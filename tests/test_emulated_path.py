# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A path does to packets what its conditions say, and nothing else."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from functools import cache
from itertools import groupby

import pytest
from hypothesis import given
from hypothesis import strategies as st

from thin_link.emulated_path import EmulatedPath, PathConditions, PathCounts

MS, S = 1_000_000, 1_000_000_000
END_NS = 10_000 * S
TWO_MBIT = PathConditions(rate_bits_per_s=2e6)
Packets = list[tuple[int, int]]
"""How long after the one before each is put, in ms, and its bytes."""

packets = st.lists(st.tuples(st.integers(0, 200), st.integers(20, 1_500)), min_size=1, max_size=60)


@cache
@st.composite
def conditions(draw: st.DrawFn) -> PathConditions:
    return PathConditions(
        rate_bits_per_s=draw(st.sampled_from([2e4, 2e6, 1e9])),
        queue_bytes=draw(st.integers(0, 20_000)),
        delay_ms=draw(st.floats(0, 300)),
        jitter_ms=draw(st.floats(0, 100)),
        loss=draw(st.just(0.0) | st.floats(0, 1)),
        loss_run_packets=draw(st.floats(1, 10)),
        reordered=draw(st.just(0.0) | st.floats(0, 1)),
        duplicated=draw(st.just(0.0) | st.floats(0, 1)),
        mtu_bytes=draw(st.sampled_from([1_280, 1_500])),
    )


def times(sent: Packets) -> list[int]:
    """When each is put."""
    now_ns, found = 0, list[int]()
    for after_ms, _ in sent:
        now_ns += after_ms * MS
        found.append(now_ns)
    return found


def put_all(path: EmulatedPath[int], sent: Packets) -> list[tuple[int, int]]:
    """The numbers of all that arrives, with the time, as a driver that is never late sees it."""
    arrived = list[tuple[int, int]]()

    def take_until(end_ns: int) -> None:
        while (wake_ns := path.wake_ns) is not None and wake_ns <= end_ns:
            arrived.extend((number, wake_ns) for number in path.take(wake_ns))

    for number, (at_ns, (_, size_bytes)) in enumerate(zip(times(sent), sent, strict=True)):
        take_until(at_ns)
        path.put(number, size_bytes, at_ns)
    take_until(END_NS)
    return arrived


@given(conditions(), packets, st.integers(0, 99))
def test_each_packet_arrives_or_is_counted_and_none_is_made(
    given_conditions: PathConditions, sent: Packets, seed: int
) -> None:
    path = EmulatedPath[int](given_conditions, seed)
    arrived = put_all(path, sent)
    counts = path.counts
    times_arrived = Counter(number for number, _ in arrived)
    assert set(times_arrived) <= set(range(len(sent)))
    assert sum(count - 1 for count in times_arrived.values()) == counts.duplicated
    assert len(times_arrived) + counts.lost + counts.overflowed + counts.too_large == len(sent)
    assert counts.arrived_bytes == sum(sent[number][1] for number, _ in arrived)


@given(conditions(), packets, st.integers(0, 99))
def test_a_seed_has_the_same_packets_arrive_at_the_same_times(
    given_conditions: PathConditions, sent: Packets, seed: int
) -> None:
    first, second = (put_all(EmulatedPath[int](given_conditions, seed), sent) for _ in range(2))
    assert first == second


@given(conditions(), packets, st.integers(0, 99))
def test_packets_that_are_not_out_of_order_come_one_after_the_other_within_delay_and_jitter(
    given_conditions: PathConditions, sent: Packets, seed: int
) -> None:
    held = replace(given_conditions, reordered=0.0, duplicated=0.0)
    arrived = put_all(EmulatedPath[int](held, seed), sent)
    numbers = [number for number, _ in arrived]
    assert numbers == sorted(numbers)
    queue_ms = held.queue_bytes * 8e3 / held.rate_bits_per_s
    for number, at_ns in arrived:
        took_ms = (at_ns - times(sent)[number]) / MS
        assert held.delay_ms - held.jitter_ms <= took_ms + 1e-3
        assert took_ms <= held.delay_ms + held.jitter_ms + queue_ms + 1e-3


@given(packets)
def test_a_path_that_loses_nothing_is_a_queue_before_a_sender(sent: Packets) -> None:
    free_ns, expected = 0.0, list[tuple[int, int]]()
    for number, (at_ns, (_, size_bytes)) in enumerate(zip(times(sent), sent, strict=True)):
        free_ns = max(free_ns, at_ns) + size_bytes * 8e9 / 2e6
        expected.append((number, round(free_ns + 5 * MS)))
    path = EmulatedPath[int](replace(TWO_MBIT, queue_bytes=10**6, delay_ms=5))
    assert put_all(path, sent) == expected


@pytest.mark.parametrize(
    ("loss", "run_packets"), [(0.02, 3.0), (0.03, 1.0), (0.05, 8.0), (0.08, 3.0), (0.5, 1.0)]
)
def test_the_share_that_is_lost_is_lost_in_runs(loss: float, run_packets: float) -> None:
    path = EmulatedPath[int](PathConditions(rate_bits_per_s=1e9, loss=loss, loss_run_packets=run_packets))
    count = 50_000
    for number in range(count):
        path.put(number, 100, number * MS)
    there = set(path.take(END_NS))
    runs = [len([*run]) for is_there, run in groupby(n in there for n in range(count)) if not is_there]
    assert sum(runs) / count == pytest.approx(loss, rel=0.15)
    assert sum(runs) / len(runs) == pytest.approx(max(run_packets, 1 / (1 - loss)), rel=0.15)


def test_what_waits_goes_at_the_new_rate_once_it_changes() -> None:
    path = EmulatedPath[int](replace(TWO_MBIT, rate_bits_per_s=8e6))
    # They take 1 ms each, and one and a half have gone when the rate falls to a tenth.
    for number in range(3):
        path.put(number, 1_000, 0)
    path.change(replace(TWO_MBIT, rate_bits_per_s=0.8e6), 1_500_000)
    assert path.take(1_500_000) == [0]
    assert path.wake_ns == 6_500_000
    assert path.take(16_499_999) == [1]
    assert path.take(16_500_000) == [2]


def test_at_rate_0_packets_wait_for_the_link_and_in_a_dead_spot_they_are_lost() -> None:
    path = EmulatedPath[int](replace(TWO_MBIT, rate_bits_per_s=0.0))
    path.put(0, 250, 0)
    assert path.wake_ns is None
    path.change(TWO_MBIT, 5 * S)
    assert path.wake_ns == 5 * S + MS
    assert path.take(6 * S) == [0]
    path.change(replace(TWO_MBIT, loss=1.0), 6 * S)
    path.put(1, 250, 6 * S)
    assert path.take(7 * S) == []
    assert path.counts == PathCounts(arrived=1, arrived_bytes=250, lost=1)


def test_a_firewall_takes_udp_alone_and_a_tunnel_no_large_packet() -> None:
    path = EmulatedPath[str](replace(TWO_MBIT, blocks_udp=True, mtu_bytes=1_280))
    path.put("datagram", 100, 0, is_udp=True)
    path.put("large", 1_281, 0)
    path.put("stream", 1_280, 0)
    assert path.take(S) == ["stream"]
    assert path.counts == PathCounts(arrived=1, arrived_bytes=1_280, blocked=1, too_large=1)
