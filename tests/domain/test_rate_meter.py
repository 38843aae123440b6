# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How fast a flow is now: measured at looks, at no cost for each message."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from smarttestudo.domain.rate_meter import Flow, FlowMeter, mean_hz

MS = 1_000_000
S = 1_000_000_000


def metered(arrivals_ns: Iterable[int], until_s: int, *, start_s: int = 1, **look: Any) -> FlowMeter:
    """The meter of a flow that was looked at each second up to ``until_s``."""
    waiting = sorted(arrivals_ns)
    flow = Flow()
    meter = FlowMeter(flow)
    for now_ns in range(start_s * S, (until_s + 1) * S, S):
        while waiting and waiting[0] <= now_ns:
            flow.record(waiting.pop(0), 500)
        meter.measure(now_ns, **look)
    return meter


def steady(rate_hz: float, from_s: float, to_s: float) -> list[int]:
    period_ns = round(S / rate_hz)
    return list(range(round(from_s * S), round(to_s * S), period_ns))


@given(rate_hz=st.floats(0.3, 1000), until_s=st.integers(12, 40))
def test_a_steady_flow_has_its_rate(rate_hz: float, until_s: int) -> None:
    meter = metered(steady(rate_hz, 0.3, until_s + 1), until_s)
    assert meter.rate_hz == pytest.approx(S / round(S / rate_hz))


@given(gaps_ms=st.lists(st.integers(1, 1500), min_size=10, max_size=60))
def test_a_rate_lies_between_those_of_the_shortest_and_the_longest_interval(gaps_ms: list[int]) -> None:
    arrivals_ns = [S]
    for gap_ms in gaps_ms:
        arrivals_ns.append(arrivals_ns[-1] + gap_ms * MS)
    meter = metered(arrivals_ns, arrivals_ns[-1] // S + 1)
    if meter.rate_hz:
        assert 1000 / max(gaps_ms) <= meter.rate_hz * (1 + 1e-9)
        assert meter.rate_hz <= 1000 / min(gaps_ms) * (1 + 1e-9)


def test_it_looks_back_ten_seconds() -> None:
    changed = [*steady(100, 0, 20), *steady(10, 20, 40)]
    assert metered(changed, 20).rate_hz == pytest.approx(100, rel=0.01)
    assert 12 < (metered(changed, 29).rate_hz or 0) < 100
    assert metered(changed, 31).rate_hz == pytest.approx(10)


def test_one_message_has_no_rate() -> None:
    assert metered([S], 5).rate_hz is None


def test_rare_messages_are_measured_over_a_longer_time() -> None:
    assert metered([2 * S, 22 * S, 42 * S], 60).rate_hz == pytest.approx(0.05)


def test_a_flow_that_fell_silent_has_no_rate_and_begins_anew_when_it_comes_back() -> None:
    stopped = steady(10, 0, 20)
    assert not metered(stopped, 21).is_silent
    silent = metered(stopped, 60)
    assert (silent.is_silent, silent.rate_hz, silent.kb_per_s) == (True, 0.0, 0.0)
    back = metered([*stopped, *steady(10, 60, 70)], 63)
    assert not back.is_silent
    assert back.rate_hz == pytest.approx(10)


def test_an_event_now_and_then_is_no_silence() -> None:
    assert not metered([S, 2 * S, 3 * S], 60).is_silent
    assert not metered(steady(10, 0, 20), 60, transient_local=True).is_silent


def test_a_profile_says_when_a_topic_counts_as_silent() -> None:
    assert metered([S], 7, stale_after_ns=5 * S).is_silent
    assert not metered(steady(10, 0, 20), 60, stale_after_ns=60 * S).is_silent


def test_bandwidth_is_that_of_ten_seconds() -> None:
    assert metered(steady(20, 0, 40), 30).kb_per_s == pytest.approx(10, rel=0.01)
    assert metered(steady(20, 0, 20), 21).kb_per_s == pytest.approx(9, rel=0.03)


def test_a_clock_that_jumps_back_begins_the_measure_anew() -> None:
    flow = Flow()
    meter = FlowMeter(flow)
    for now_s in (100, 101, 102, 3, 4, 5, 6):
        for tenth in range(10):
            flow.record(now_s * S - S + tenth * S // 10, 500)
        meter.measure(now_s * S)
    assert meter.rate_hz == pytest.approx(10)
    assert not meter.is_silent


def test_two_messages_or_more_have_a_mean_rate_unless_all_came_at_once() -> None:
    assert mean_hz(3, S) == 2.0
    assert mean_hz(1, 0) is None
    assert mean_hz(0, 0) is None
    assert mean_hz(5, 0) is None


@given(gaps_ns=st.lists(st.integers(0, 3 * S), min_size=1, max_size=30))
def test_a_flow_counted_one_by_one_has_the_mean_rate_of_its_ends(gaps_ns: list[int]) -> None:
    flow, now_ns = Flow(), 5 * S
    for gap_ns in (0, *gaps_ns):
        now_ns += gap_ns
        flow.record(now_ns, 10)
    assert flow.mean_hz == mean_hz(len(gaps_ns) + 1, now_ns - 5 * S)
    assert flow.size_bytes == 10 * flow.messages
