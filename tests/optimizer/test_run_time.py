# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Cuts to a budget while running: by priority, never below floors, and not too often."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from smarttestudo.optimizer.problem import fits, used_kb_per_s
from smarttestudo.optimizer.run_time import BudgetKeeper, TopicRequest, plan_within

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
