# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""One publisher sends several things in bursts, in turn or in lumps: none starves, and the mean is exact."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Sequence
from itertools import pairwise

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from pacing.scenarios import EPOCH_NS, S, relay, samples_at, seeds
from smarttestudo.pacing.topic_pacer import TopicPacer

periods_s = st.one_of(st.sampled_from([0.1, 0.5, 1.0, 1.5]), st.floats(0.05, 1.9))


def passed(times_ns: Sequence[int], target_hz: float, *, drain: bool = False) -> list[int]:
    """The indices of the arrivals that pass."""
    arrivals = samples_at(times_ns)
    index_of = {offered: index for index, (_, offered) in enumerate(arrivals)}
    pacer = TopicPacer()
    pacer.set_rate(target_hz, times_ns[0])
    return [index_of[r.sample] for r in relay(pacer, arrivals, drain=drain)]


def bursts(parts: int, period_s: float, spread: float, count: int, late: Sequence[float] = (0,)) -> list[int]:
    """So many bursts, each within ``spread`` of the period, ``late`` by one of these shares of it in turn."""
    return [
        EPOCH_NS + round(S * period_s * (burst + late[burst % len(late)] + spread * part / parts))
        for burst in range(count)
        for part in range(parts)
    ]


def longest_wait(indices: Sequence[int], parts: int) -> float:
    """In how many passes, for each part of it, the part that waits longest comes at the latest."""
    waits = [0]
    for part in range(parts):
        at = [-1, *(place for place, index in enumerate(indices) if index % parts == part), len(indices)]
        waits += [after - before for before, after in pairwise(at)]
    return max(waits) / parts


@pytest.mark.parametrize("start_s", range(0, 90, 5))
@pytest.mark.parametrize("late", [(0,), (0, 0.03, 0.01, 0.02, 0, 0.03)])
def test_each_of_ten_parts_of_a_burst_passes_in_any_thirty_seconds_at_one_hertz(
    start_s: int, late: tuple[float, ...]
) -> None:
    times_ns = bursts(10, 1, 0.02, 120, late)
    at = [
        index for index in passed(times_ns, 1) if start_s <= (times_ns[index] - EPOCH_NS) / S < start_s + 30
    ]
    assert {index % 10 for index in at} == set(range(10))
    assert 29 <= len(at) <= 31


@given(st.integers(2, 10), periods_s, st.floats(0, 0.5), st.floats(0.05, 0.9), seeds)
@example(10, 1.0, 0.02, 0.2, 0)
@example(10, 1.5, 0.02, 1 / 15, 0)
def test_no_part_of_a_burst_starves_and_the_mean_is_exact(
    parts: int, period_s: float, spread: float, share: float, seed: int
) -> None:
    target_hz = share * parts / period_s
    count = round(40 / share)
    rng = random.Random(seed)
    times_ns = bursts(parts, period_s, spread, count, [rng.uniform(0, 0.02) for _ in range(count)])
    indices = passed(times_ns, target_hz)
    seconds = (times_ns[indices[-1]] - times_ns[0]) / S
    assert abs(len(indices) - 1 - target_hz * seconds) <= 2 + target_hz * period_s
    assert longest_wait(indices, parts) <= 15


@given(
    st.lists(st.tuples(st.floats(0, 0.9), st.integers(1, 9)), min_size=1, max_size=4),
    st.floats(0.2, 1.5),
    st.floats(0.05, 0.9),
)
@example([(0, 1), (0.5, 9)], 1.0, 0.4)
@example([(0, 1), (0.5, 9)], 1.0, 0.6)
@example([(0, 2), (0.5, 5)], 1.0, 5 / 7)
def test_the_mean_is_exact_where_bursts_of_a_period_differ(
    parts: list[tuple[float, int]], period_s: float, share: float
) -> None:
    period = [(offset, i) for offset, count in sorted(parts) for i in range(count)]
    times_ns = [
        EPOCH_NS + round(S * period_s * (number + offset)) + i * 1000
        for number in range(200)
        for offset, i in period
    ]
    target_hz = share * len(period) / period_s
    indices = passed(sorted(times_ns), target_hz)
    assert abs(len(indices) - target_hz * 200 * period_s) <= 3 + 2 * target_hz * period_s


def bursts_of_a_second(parts: Sequence[tuple[float, int]], jitter_s: float, seconds: int) -> list[int]:
    """Bursts of so many messages, each at its share of every second, and late by up to ``jitter_s``."""
    rng = random.Random(0)
    return [
        EPOCH_NS + round(S * (second + offset + late_s)) + i * S // 1000
        for second in range(seconds)
        for offset, count in parts
        for late_s in [rng.uniform(0, jitter_s)]
        for i in range(count)
    ]


@pytest.mark.parametrize("jitter_s", [0, 0.01, 0.03])
@pytest.mark.parametrize("target_hz", [0.5, 1, 1.5, 2, 3, 4, 5, 6])
@pytest.mark.parametrize(
    "parts",
    [
        [(0, 1), (0.5, 9)],
        [(0, 3), (0.6, 7)],
        [(0, 1), (0.3, 5), (0.57, 1)],
        [(0, 1), (0.28, 8), (0.55, 6)],
        [(0, 1), (0.25, 1), (0.5, 8)],
        [(0, 5), (0.25, 1), (0.52, 4), (0.75, 3)],
        [(0, 6), (0.22, 4), (0.5, 7), (0.67, 2)],
    ],
)
def test_no_part_starves_where_bursts_of_a_second_differ(
    parts: list[tuple[float, int]], target_hz: float, jitter_s: float
) -> None:
    count = sum(one for _, one in parts)
    times_ns = bursts_of_a_second(parts, jitter_s, 300)
    indices = passed(times_ns, target_hz)
    assert longest_wait(indices, count) <= 20
    assert abs(len(indices) - target_hz * 300) <= 3 + 2 * target_hz


@pytest.mark.parametrize("parts", [3, 10, 15, 30])
@pytest.mark.parametrize("spread", [0.02, 0.6, 0.7, 0.9])
@pytest.mark.parametrize("target_hz", [0.5, 1, 2, 5])
def test_no_part_starves_however_far_a_burst_is_spread(parts: int, spread: float, target_hz: float) -> None:
    target_hz = min(target_hz, 0.9 * parts)
    seconds = round(25 * parts / target_hz)
    indices = passed(bursts(parts, 1, spread, seconds), target_hz)
    assert longest_wait(indices, parts) <= 20
    assert abs(len(indices) - target_hz * seconds) <= 3 + 2 * target_hz


@given(
    st.integers(2, 10),
    st.floats(1, 100),
    st.one_of(st.sampled_from([1 / n for n in range(2, 11)]), st.floats(0.05, 0.9)),
)
def test_no_turn_starves_at_any_rate(turns: int, source_hz: float, share: float) -> None:
    times_ns = [EPOCH_NS + round(i * S / source_hz) for i in range(round(40 * turns / share))]
    indices = passed(times_ns, source_hz * share)
    assert longest_wait(indices, turns) <= 15
    seconds = (times_ns[indices[-1]] - times_ns[0]) / S
    assert abs(len(indices) - 1 - source_hz * share * seconds) <= 1


@given(st.floats(0.26, 1.9), st.integers(2, 100), st.floats(0.01, 0.95))
@example(0.5, 45, 1 / 9)
def test_the_mean_of_lumps_is_that_asked_for(period_s: float, lump: int, share: float) -> None:
    """Once the first two have shown what the lumps are."""
    times_ns = bursts(lump, period_s, 0, round(60 / period_s))
    target_hz = share * lump / period_s
    lumps_passed = Counter(index // lump for index in passed(times_ns, target_hz))
    counted = range(2, round(60 / period_s))
    assert abs(sum(lumps_passed[one] for one in counted) - share * lump * len(counted)) <= 3


@given(st.floats(1, 200), st.one_of(st.integers(2, 20).map(float), st.floats(1, 20)))
@example(30, 3.0)
def test_what_passes_of_a_steady_source_is_evenly_spaced(source_hz: float, ratio: float) -> None:
    """From the second on, to one message of the source where the ratio is whole, else to less than two.

    Where it is at most five, nine in twenty gaps or more are as even as they can be.
    """
    times_ns = [EPOCH_NS + round(i * S / source_hz) for i in range(1000)]
    indices = passed(times_ns, source_hz / ratio)
    most = 1 if ratio == round(ratio) else 1.7
    assert all(abs(after - before - ratio) <= most for before, after in pairwise(indices[1:]))
    if ratio <= 5 and len(indices) > 50:
        even = sum(abs(after - before - ratio) < 1 for before, after in pairwise(indices))
        assert even >= 0.45 * len(indices)


@given(
    st.lists(
        st.one_of(st.just(0), st.integers(0, S // 100), st.integers(0, 2 * S)), min_size=20, max_size=200
    ),
    st.floats(0.2, 100),
)
def test_of_whatever_comes_as_much_passes_as_was_asked_for_or_came(
    gaps_ns: list[int], target_hz: float
) -> None:
    """Where the source has more than that at all times: in lumps of many, as far apart as they like."""
    times_ns = [EPOCH_NS + sum(gaps_ns[:i]) for i in range(len(gaps_ns)) for _ in range(300)]
    indices = passed(times_ns, target_hz)
    seconds = (times_ns[-1] - times_ns[0]) / S
    longest_s = max(max(gaps_ns) / S, 0.01)
    assert len(indices) <= target_hz * (seconds + longest_s) + 2
    assert len(indices) >= target_hz * (seconds - 2 * longest_s) - 3
