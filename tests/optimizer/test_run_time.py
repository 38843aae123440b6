# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Cuts to a budget while running: by priority, never below floors, and not too often."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from optimizer.naive import small_kb_per_s
from smarttestudo.optimizer.problem import fits, used_kb_per_s
from smarttestudo.optimizer.run_time import SMALL_SHARE, BudgetKeeper, TopicRequest, plan_within

S = 1_000_000_000


def load(
    topic: str,
    requested_hz: float,
    *,
    size_kb: float = 1.0,
    floor_hz: float = 0.0,
    priority: float = 1.0,
    source_hz: float = 1000.0,
) -> TopicRequest:
    return TopicRequest(topic, requested_hz, floor_hz, priority, size_kb, source_hz)


loads = st.lists(
    st.builds(
        TopicRequest,
        topic=st.uuids().map(str),
        requested_hz=st.sampled_from([0.0, math.inf]) | st.floats(0, 200),
        floor_hz=st.sampled_from([0.0, 1.0]) | st.floats(0, 20),
        priority=st.sampled_from([0.5, 1.0, 2.0]),
        size_kb=st.floats(0.01, 1000),
        source_hz=st.floats(0, 200),
    ),
    max_size=8,
)


@given(topics=loads, share=st.floats(0, 1.2))
@settings(max_examples=300)
def test_the_budget_holds_unless_the_floors_alone_break_it(topics: list[TopicRequest], share: float) -> None:
    budget = share * used_kb_per_s((one.size_kb, one.wanted_hz) for one in topics)
    plan = plan_within(topics, budget)
    rates = {one.topic: plan.cut_hz.get(one.topic, one.wanted_hz) for one in topics}
    used = used_kb_per_s((one.size_kb, rates[one.topic]) for one in topics)
    assert fits(used, budget) == plan.floors_fit or not plan.floors_fit
    for one in topics:
        assert min(one.floor_hz, one.wanted_hz) <= rates[one.topic] <= one.wanted_hz
    for cut in topics:
        for other in topics:
            if cut.priority > other.priority and rates[cut.topic] < cut.wanted_hz:
                assert rates[other.topic] <= min(other.floor_hz, other.wanted_hz) + 1e-6


def given_hz(topics: list[TopicRequest], budget: float) -> dict[str, float]:
    plan = plan_within(topics, budget)
    return {one.topic: plan.cut_hz.get(one.topic, one.wanted_hz) for one in topics}


@given(topics=loads, share=st.floats(0, 1.2))
@settings(max_examples=300)
def test_small_topics_together_keep_their_rates_while_a_larger_one_of_their_priority_has_something_to_give(
    topics: list[TopicRequest], share: float
) -> None:
    budget = share * used_kb_per_s((one.size_kb, one.wanted_hz) for one in topics)
    rates = given_hz(topics, budget)
    for priority in {one.priority for one in topics}:
        equals = sorted(
            (one for one in topics if one.priority == priority), key=lambda one: one.size_kb * one.wanted_hz
        )
        for count in range(1, len(equals)):
            small, larger = equals[:count], equals[count:]
            if used_kb_per_s((one.size_kb, one.wanted_hz) for one in small) > SMALL_SHARE * budget:
                break
            can_give = any(rates[one.topic] > min(one.floor_hz, one.wanted_hz) + 1e-3 for one in larger)
            assert not can_give or all(rates[one.topic] == one.wanted_hz for one in small)


@given(topics=loads, share=st.floats(0, 1.2), more=st.floats(1, 1.5))
@settings(max_examples=300)
def test_a_larger_budget_lowers_no_rate(topics: list[TopicRequest], share: float, more: float) -> None:
    budget = share * used_kb_per_s((one.size_kb, one.wanted_hz) for one in topics)
    less, greater = given_hz(topics, budget), given_hz(topics, more * budget)
    for topic, rate_hz in less.items():
        # Rates are given in steps of 0.001 Hz.
        assert greater[topic] >= rate_hz - 1e-3 - 1e-9 * rate_hz


@given(topics=loads, share=st.floats(0, 1.2), data=st.data())
def test_neither_names_nor_order_decide(
    topics: list[TopicRequest], share: float, data: st.DataObject
) -> None:
    budget = share * used_kb_per_s((one.size_kb, one.wanted_hz) for one in topics)
    shuffled = data.draw(st.permutations(topics))
    assert given_hz(shuffled, budget) == pytest.approx(given_hz(topics, budget), abs=1e-3, rel=1e-9)


def poured_hz(topics: list[TopicRequest], budget: float) -> list[float]:
    """The rates of a budget poured out in drops: floors, then by priority what is small, and the rest."""
    full = [one.size_kb * one.wanted_hz for one in topics]
    given_kb = [min(one.floor_hz, one.wanted_hz) * one.size_kb for one in topics]
    left, drop = budget - sum(given_kb), budget / 20_000
    for priority in sorted({one.priority for one in topics}, reverse=True):
        equals = [index for index, one in enumerate(topics) if one.priority == priority]
        kept = dict(zip(equals, small_kb_per_s([full[index] for index in equals], budget), strict=True))
        for goals in (kept, {index: full[index] for index in equals}):
            lacks = {index: max(0.0, goal - given_kb[index]) for index, goal in goals.items()}
            total = sum(lacks.values())
            poured = 0.0
            while poured < total and left > 0:
                amount = min(drop, left, total - poured)
                for index, lack in lacks.items():
                    given_kb[index] += amount * lack / total
                poured, left = poured + amount, left - amount
    return [size / one.size_kb for size, one in zip(given_kb, topics, strict=True)]


@given(topics=loads, share=st.floats(0.01, 1.2))
@settings(max_examples=50)
def test_rates_are_those_of_a_budget_that_is_poured_out(topics: list[TopicRequest], share: float) -> None:
    budget = share * used_kb_per_s((one.size_kb, one.wanted_hz) for one in topics)
    if plan_within(topics, budget).floors_fit:
        rates = list(given_hz(topics, budget).values())
        assert rates == pytest.approx(poured_hz(topics, budget), abs=1.1e-3, rel=1e-3)


def test_a_stop_button_keeps_its_rate_beside_a_camera_of_its_priority() -> None:
    plan = plan_within([load("/estop", 10, size_kb=0.05), load("/camera", 15, size_kb=921.6)], 100)
    assert plan.cut_hz == {"/camera": 0.107}


def test_nothing_is_cut_that_fits_exactly() -> None:
    assert plan_within([load("/a", 3.0, size_kb=0.1), load("/b", 3.0, size_kb=0.2)], 0.9).cut_hz == {}


def test_the_lower_priority_gives_way_first() -> None:
    plan = plan_within([load("/teleop", 20, priority=5), load("/map", 20, floor_hz=1)], 25)
    assert plan.cut_hz == {"/map": 5}


def test_equal_priorities_lose_the_same_share_of_what_lies_above_their_floors() -> None:
    plan = plan_within([load("/a", 10, size_kb=100), load("/b", 50, floor_hz=10)], 530)
    assert plan.cut_hz == {"/a": pytest.approx(5), "/b": pytest.approx(30)}


def test_floors_win_over_the_budget_and_that_is_said() -> None:
    plan = plan_within([load("/estop", 20, floor_hz=10), load("/map", 5)], 8)
    assert plan.cut_hz == {"/estop": 10, "/map": 0}
    assert not plan.floors_fit


def test_full_costs_what_its_source_sends() -> None:
    assert plan_within([load("/scan", math.inf, source_hz=5)], 5).cut_hz == {}
    assert plan_within([load("/scan", math.inf, source_hz=5)], 4).cut_hz == {"/scan": 4}


def test_a_written_off_stays_off_whatever_its_floor() -> None:
    assert plan_within([load("/scan", 0, floor_hz=2)], 100).cut_hz == {}


def test_a_change_of_wishes_is_planned_at_once() -> None:
    keeper = BudgetKeeper(10.0)
    assert keeper.update([load("/a", 20)], 0, requests_changed=True).cut_hz == {"/a": 10}
    assert keeper.update([load("/a", 5)], 1, requests_changed=True).cut_hz == {}


def test_a_grown_message_is_noticed_within_a_second_and_not_earlier() -> None:
    keeper = BudgetKeeper(10.0)
    keeper.update([load("/a", 20)], 0, requests_changed=True)
    grown = [load("/a", 20, size_kb=2)]
    assert keeper.update(grown, S - 1, requests_changed=False).cut_hz == {"/a": 10}
    assert keeper.next_check_ns == S
    assert keeper.update(grown, S, requests_changed=False).cut_hz == {"/a": 5}


@pytest.mark.parametrize(("size_kb", "rate_hz"), [(0.95, 10), (0.9, 10), (0.89, 11.235)])
def test_between_90_and_100_percent_the_plan_stays(size_kb: float, rate_hz: float) -> None:
    keeper = BudgetKeeper(10.0)
    keeper.update([load("/a", 20)], 0, requests_changed=True)
    assert keeper.update([load("/a", 20, size_kb=size_kb)], S, requests_changed=False).cut_hz == {
        "/a": rate_hz
    }


def test_the_budget_may_change_while_running() -> None:
    keeper = BudgetKeeper(10.0)
    keeper.update([load("/a", 20)], 0, requests_changed=True)
    keeper.budget_kb_per_s = 4.0
    assert keeper.update([load("/a", 20)], 1, requests_changed=False).cut_hz == {"/a": 4}
