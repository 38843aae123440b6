# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The best fixed rates carry the bytes that were carried, and are worth the most."""

from __future__ import annotations

import math

from hypothesis import given
from hypothesis import strategies as st

from smarttestudo.accuracy.arms import Source, best_fixed_rates
from smarttestudo.domain.profile import TopicProfile

TIERS = TopicProfile(tiers_hz=(1, 2, 3, 4, 5, 10))


def source(topic: str, size_bytes: int, mean_hz: float | None, entry: TopicProfile = TIERS) -> Source:
    return Source(topic=topic, size_bytes=size_bytes, mean_hz=mean_hz, entry=entry)


def test_equal_topics_share_the_bytes_equally() -> None:
    rates = best_fixed_rates([source("/a", 1000, 10), source("/b", 1000, 10)], 400)
    assert rates == {"/a": 2, "/b": 2}


def test_priority_decides_who_comes_first() -> None:
    urgent = TopicProfile(tiers_hz=TIERS.tiers_hz, priority=2.0)
    rates = best_fixed_rates([source("/a", 1000, 10), source("/b", 1000, 10, urgent)], 700)
    assert rates == {"/a": 2, "/b": 5}


def test_small_messages_come_before_large_ones() -> None:
    rates = best_fixed_rates([source("/image", 1_000_000, 10), source("/odom", 1000, 10)], 200_500)
    assert rates == {"/image": 2, "/odom": 5}


def test_what_is_left_at_saturation_raises_topics_to_their_source() -> None:
    rates = best_fixed_rates([source("/image", 1_000_000, 10), source("/odom", 1000, 10)], 701_000)
    assert rates == {"/image": 7, "/odom": math.inf}


def test_without_a_profile_the_tiers_are_shares_of_the_source() -> None:
    rates = best_fixed_rates([source("/a", 1000, 10, TopicProfile())], 250)
    assert rates == {"/a": 2.5}


def test_a_topic_of_one_message_is_passed_whole_and_paid_for() -> None:
    rates = best_fixed_rates([source("/map", 600, None), source("/a", 1000, 10)], 800)
    assert rates == {"/map": math.inf, "/a": 2}


def test_nothing_carried_is_nothing_passed() -> None:
    assert best_fixed_rates([source("/a", 1000, 10)], 0) == {"/a": 0}


@given(
    sizes=st.lists(
        st.tuples(st.integers(1, 10**9), st.floats(0.01, 1000), st.booleans()), min_size=1, max_size=6
    ),
    share=st.floats(0, 1),
)
def test_fixed_rates_carry_the_bytes_they_are_given(
    sizes: list[tuple[int, float, bool]], share: float
) -> None:
    sources = [
        source(f"/t{number}", size, hz, TIERS if has_tiers else TopicProfile())
        for number, (size, hz, has_tiers) in enumerate(sizes)
    ]
    budget = share * sum(size for size, _, _ in sizes)
    rates = best_fixed_rates(sources, budget)
    carried = sum(one.size_bytes * min(1, rates[one.topic] / (one.mean_hz or 1)) for one in sources)
    rounding = sum(one.size_bytes * 0.001 / (one.mean_hz or 1) for one in sources)
    assert carried <= budget * (1 + 1e-6) + 1e-3
    assert carried >= budget * (1 - 1e-6) - rounding
    assert all(rate >= 0 for rate in rates.values())


@given(st.lists(st.tuples(st.integers(1, 10**9), st.floats(0.01, 1000)), min_size=1, max_size=6))
def test_who_may_carry_everything_does(sizes: list[tuple[int, float]]) -> None:
    sources = [source(f"/t{number}", size, hz) for number, (size, hz) in enumerate(sizes)]
    rates = best_fixed_rates(sources, sum(size for size, _ in sizes))
    assert set(rates.values()) == {math.inf}
