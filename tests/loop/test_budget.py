# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Running within a budget, by the sizes that are really measured."""

from __future__ import annotations

import math
from collections.abc import Mapping

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from loop.loop_driver import SECOND, LoopDriver
from smarttestudo.domain.decision import Reason
from smarttestudo.domain.observation import Arrival
from smarttestudo.domain.profile import UNLIMITED_KB_PER_S, Profile, TopicProfile
from smarttestudo.loop.knowledge.knowledge import Knowledge
from smarttestudo.loop.knowledge.link_use import SourceLoad
from smarttestudo.loop.step import meter, step

RULES = """\
begin
    SetFrequency /image Full
    SetFrequency /scan 10
    {floor}
    Rule "near" If (CheckValue /odom pose_x < 3) Then SetFrequency /scan 40 EndIf
end
"""


def profile(**priorities: float) -> Profile:
    topics = {f"/{name}": TopicProfile(priority=priority) for name, priority in priorities.items()}
    return Profile(topics=topics, settle_s=0.0)


def driver(budget: float, *, floor: str = "", known: Profile | None = None) -> LoopDriver:
    return LoopDriver(RULES.format(floor=floor), known or profile(), budget_kb_per_s=budget)


def stream(robot: LoopDriver, sizes: Mapping[str, int], start_s: int, end_s: int, *, hz: int = 50) -> None:
    """Messages of every topic at ``hz``, interleaved."""
    for number in range(start_s * hz, end_s * hz):
        for topic, size_bytes in sizes.items():
            robot.send(topic, number * SECOND // hz, size_bytes=size_bytes)


def kb_per_s(robot: LoopDriver, start_s: int, end_s: int) -> float:
    inside = [one for one in robot.relayed if start_s * SECOND <= one.stamp_ns < end_s * SECOND]
    return sum(one.size_bytes for one in inside) / 1000 / (end_s - start_s)


def test_what_is_relayed_stays_within_the_budget_once_sizes_are_measured() -> None:
    robot = driver(100.0)
    stream(robot, {"/image": 10_000, "/scan": 1000}, 0, 12)
    assert 90 <= kb_per_s(robot, 2, 12) <= 102


def test_nothing_is_cut_while_everything_fits() -> None:
    robot = driver(1000.0)
    robot.drive(0, 5.0, 0.0)
    stream(robot, {"/image": 10_000, "/scan": 1000}, 0, 5)
    assert robot.rates() == {"/image": None, "/scan": 10}
    assert all(one.planned.reason is not Reason.BUDGET for one in robot.decisions)


def test_every_cut_is_a_decision_that_still_names_the_block() -> None:
    robot = driver(20.0, known=profile(image=2, scan=1))
    robot.drive(0, 1.0, 0.0)
    stream(robot, {"/scan": 1000}, 0, 3)
    cut = robot.decisions[-1]
    assert (cut.topic, cut.planned.reason, cut.planned.rule) == ("/scan", Reason.BUDGET, "near")
    assert cut.planned.rate.hz == pytest.approx(20, rel=0.03)
    assert cut.to_json()["reason"] == "budget"


def test_the_lower_priority_is_cut_to_its_floor_before_the_higher_one_is_touched() -> None:
    robot = driver(42.0, floor="KeepAtLeast /scan 2", known=profile(image=1, scan=5))
    robot.drive(0, 1.0, 0.0)
    stream(robot, {"/image": 10_000, "/scan": 1000}, 0, 4)
    rates = robot.rates()
    assert rates["/scan"] == 40
    assert rates["/image"] == pytest.approx(0.2, abs=0.01)


def test_floors_win_over_the_budget_and_that_is_known() -> None:
    robot = driver(1.0, floor="KeepAtLeast /scan 8")
    robot.drive(0, 5.0, 0.0)
    stream(robot, {"/image": 10_000, "/scan": 1000}, 0, 3)
    assert robot.rates() == {"/image": 0, "/scan": 8}
    assert robot.loop.knowledge.floors_broke_budget


def test_the_profile_s_sizes_count_from_the_first_message_on() -> None:
    known = Profile(topics={"/scan": TopicProfile(message_kb=1.0, source_hz=50.0)}, settle_s=0.0)
    robot = driver(5.0, known=known)
    assert robot.rates()["/scan"] == 40
    robot.send("/scan", SECOND, size_bytes=1000)
    assert robot.rates()["/scan"] == 5
    assert robot.decisions[-1].t_s == 1.0, "not at the next look"


def test_a_topic_that_nobody_publishes_takes_nothing_of_the_budget() -> None:
    known = Profile(topics={"/image": TopicProfile(message_kb=6220, source_hz=29)}, settle_s=0.0)
    robot = driver(400.0, known=known)
    robot.drive(0, 5.0, 0.0)
    stream(robot, {"/scan": 3000}, 0, 5)
    assert robot.rates() == {"/image": None, "/scan": 10}
    robot.send("/image", 5 * SECOND, size_bytes=6_220_000)
    assert robot.rates()["/image"] == pytest.approx(400 / 6250, rel=0.2), "it came, and room was made"


def test_a_topic_that_nobody_listens_to_takes_nothing_of_the_budget() -> None:
    robot = driver(100.0)
    robot.drive(0, 5.0, 0.0)
    robot.listeners("/image", are_there=False)
    stream(robot, {"/image": 20_000, "/scan": 3000}, 0, 5)
    assert robot.rates() == {"/image": None, "/scan": 10}
    robot.listeners("/image", are_there=True)
    stream(robot, {"/image": 20_000, "/scan": 3000}, 5, 8)
    assert (robot.rates()["/scan"] or 0) < 3
    robot.listeners("/image", are_there=False)
    assert robot.rates() == {"/image": None, "/scan": 10}


def test_a_source_whose_publisher_left_gives_its_share_back_at_once() -> None:
    robot = driver(100.0)
    robot.drive(0, 5.0, 0.0)
    stream(robot, {"/image": 20_000, "/scan": 3000}, 0, 5)
    robot.source("/image", publishers=0)
    assert robot.rates()["/scan"] == 10


def test_a_source_that_comes_back_has_the_place_that_it_had_with_its_first_message() -> None:
    robot = driver(100.0)
    robot.drive(0, 5.0, 0.0)
    stream(robot, {"/image": 20_000, "/scan": 3000}, 0, 5)
    cut = robot.rates()
    stream(robot, {"/scan": 3000}, 5, 9)
    assert robot.rates()["/scan"] == 10
    robot.send("/image", 9 * SECOND, size_bytes=20_000)
    for topic in cut:
        assert robot.rates()[topic] == pytest.approx(cut[topic], rel=0.05)


def test_while_nobody_sends_anything_nothing_wakes_the_loop() -> None:
    robot = driver(100.0)
    stream(robot, {"/image": 20_000, "/scan": 3000}, 0, 5)
    robot.wait_until(20 * SECOND)
    assert robot.loop.next_wake_ns is None


HZ = {"/a": 5, "/b": 20, "/c": 50}
REQUESTED_HZ = {"/a": 4.0, "/b": math.inf, "/c": 30.0}
SIZES_KB = {"/a": 40, "/b": 3, "/c": 1}
THREE = "begin SetFrequency /a 4 SetFrequency /b Full SetFrequency /c 30 end"


@settings(max_examples=40, deadline=None)
@given(
    budget=st.floats(1, 400),
    priorities=st.lists(st.sampled_from([0.5, 1.0, 2.0]), min_size=3, max_size=3),
    is_known=st.booleans(),
    spells=st.lists(
        st.tuples(st.sets(st.sampled_from(sorted(HZ))), st.sets(st.sampled_from(sorted(HZ)))), max_size=4
    ),
)
def test_what_is_used_and_what_no_topic_asks_for_is_the_budget(
    budget: float, priorities: list[float], is_known: bool, spells: list[tuple[set[str], set[str]]]
) -> None:
    """Each spell has other topics published and heard; they have their place a second after that is known."""
    topics = {
        topic: TopicProfile(
            priority=priority,
            message_kb=2.0 * SIZES_KB[topic] if is_known else None,
            source_hz=30.0 if is_known else None,
        )
        for topic, priority in zip(HZ, priorities, strict=True)
    }
    robot = LoopDriver(THREE, Profile(topics=topics, settle_s=0.0), budget_kb_per_s=budget)
    for number, (published, heard) in enumerate(spells):
        start_ns = number * 6 * SECOND
        robot.wait_until(start_ns)
        for topic in HZ:
            robot.listeners(topic, are_there=topic in heard)
        for tick in range(6 * 100):
            for topic in published:
                if tick % (100 // HZ[topic]) == 0:
                    robot.send(topic, start_ns + tick * SECOND // 100, size_bytes=1000 * SIZES_KB[topic])
            robot.wait_until(start_ns + tick * SECOND // 100)
            # Two seconds of silence say that a source fell silent.
            if tick >= (100 if number == 0 else 301):
                assert_is_the_budget(robot, budget, published & heard)


def assert_is_the_budget(robot: LoopDriver, budget: float, asking: set[str]) -> None:
    asked = {topic: min(REQUESTED_HZ[topic], HZ[topic]) for topic in asking}
    rates = {topic: planned.rate.hz for topic, planned in robot.loop.knowledge.plan.items()}
    used = sum(SIZES_KB[topic] * min(rates[topic], hz) for topic, hz in asked.items())
    assert used == pytest.approx(
        min(budget, sum(SIZES_KB[topic] * hz for topic, hz in asked.items())), rel=1e-3, abs=0.05
    )
    assert all(rates[topic] == REQUESTED_HZ[topic] for topic in HZ.keys() - asking)


def test_grown_messages_are_noticed_with_at_most_one_decision_of_a_topic_a_second() -> None:
    robot = driver(20.0)
    robot.drive(0, 1.0, 0.0)
    stream(robot, {"/scan": 1000}, 0, 10)
    before = len(robot.decisions)
    stream(robot, {"/scan": 2000}, 10, 25)
    assert robot.rates()["/scan"] == pytest.approx(10, rel=0.05)
    assert len(robot.decisions) - before <= 15


def test_a_raised_budget_gives_rates_back_and_a_lowered_one_takes_them_at_once() -> None:
    robot = driver(20.0)
    robot.drive(0, 1.0, 0.0)
    stream(robot, {"/scan": 1000}, 0, 5)
    robot.budget(100.0)
    assert robot.log()[-1][1:] == ("/scan", 40, "block", "near")
    robot.budget(10.0)
    assert robot.rates()["/scan"] == pytest.approx(10, rel=0.03)


def test_a_budget_can_be_set_on_a_loop_that_had_none() -> None:
    robot = LoopDriver(RULES.format(floor=""), profile())
    robot.budget(10.0)
    stream(robot, {"/scan": 1000}, 0, 3)
    assert robot.rates()["/scan"] == pytest.approx(10, rel=0.05)


def assert_scan_has(robot: LoopDriver, rate_hz: float, reason: Reason) -> None:
    planned = robot.loop.knowledge.plan["/scan"]
    assert planned.reason is reason
    assert planned.rate.hz == pytest.approx(rate_hz, rel=0.03)


def test_what_a_link_was_measured_to_carry_cuts_and_says_so() -> None:
    robot = LoopDriver(RULES.format(floor=""), profile())
    robot.drive(0, 1.0, 0.0)
    robot.budget(20.0, is_measured=True)
    stream(robot, {"/scan": 1000}, 0, 3)
    assert_scan_has(robot, 20, Reason.LINK)
    cut = robot.decisions[-1]
    assert (cut.topic, cut.planned.rule, cut.to_json()["reason"]) == ("/scan", "near", "link")


def test_a_budget_that_was_set_stays_the_ceiling_of_a_link_that_carries_more() -> None:
    robot = driver(20.0)
    robot.drive(0, 1.0, 0.0)
    stream(robot, {"/scan": 1000}, 0, 3)
    robot.budget(1000.0, is_measured=True)
    assert robot.loop.knowledge.budget_kb_per_s == 20
    assert_scan_has(robot, 20, Reason.BUDGET)


def test_the_lesser_of_what_is_set_and_measured_holds_and_is_the_reason() -> None:
    robot = driver(20.0)
    robot.drive(0, 1.0, 0.0)
    stream(robot, {"/scan": 1000}, 0, 3)
    robot.budget(10.0, is_measured=True)
    assert_scan_has(robot, 10, Reason.LINK)
    robot.budget(5.0)
    assert_scan_has(robot, 5, Reason.BUDGET)
    robot.budget(1000.0)
    assert_scan_has(robot, 10, Reason.LINK)
    robot.budget(1000.0, is_measured=True)
    assert_scan_has(robot, 40, Reason.BLOCK)


def test_a_source_that_falls_silent_leaves_its_share_to_the_others() -> None:
    robot = driver(100.0)
    robot.drive(0, 5.0, 0.0)
    stream(robot, {"/image": 10_000, "/scan": 1000}, 0, 5)
    assert (robot.rates()["/scan"] or 0) < 10
    stream(robot, {"/scan": 1000}, 5, 20)
    assert robot.rates()["/scan"] == 10


def test_after_three_intervals_a_source_is_silent_after_five_of_their_length() -> None:
    load = SourceLoad()
    for seconds in (1, 2, 3):
        load.record(seconds * SECOND, 100)
    assert not load.is_silent(9 * SECOND), "two intervals do not say how often it comes"
    load.record(4 * SECOND, 100)
    assert not load.is_silent(9 * SECOND)
    assert load.is_silent(9 * SECOND + 1)


@given(
    image_bytes=st.integers(100, 50_000),
    scan_bytes=st.integers(100, 50_000),
    budget=st.floats(5, 500),
    image_priority=st.sampled_from([0.5, 1.0, 3.0]),
)
@settings(max_examples=20)
def test_a_steady_stream_never_takes_more_than_the_budget_and_two_messages_of_each_topic(
    image_bytes: int, scan_bytes: int, budget: float, image_priority: float
) -> None:
    robot = driver(budget, known=profile(image=image_priority))
    stream(robot, {"/image": image_bytes, "/scan": scan_bytes}, 0, 10)
    burst_kb = 2 * (image_bytes + scan_bytes) / 1000
    assert kb_per_s(robot, 2, 10) <= budget * 1.02 + burst_kb / 8


@settings(max_examples=60)
@given(
    budget=st.sampled_from([5.0, 60.0, 500.0]),
    messages=st.lists(
        st.tuples(st.sampled_from(["/image", "/scan"]), st.integers(0, SECOND), st.integers(0, 20_000)),
        max_size=60,
    ),
)
def test_what_no_check_reads_is_metered_with_the_decisions_of_a_step_for_each_message(
    budget: float, messages: list[tuple[str, int, int]]
) -> None:
    rule_set = driver(budget).rule_set
    metered, stepped = (Knowledge(rule_set, profile(), 0, budget) for _ in range(2))
    decisions = [list(step(knowledge, (), 0).decisions) for knowledge in (metered, stepped)]
    now_ns = 0
    for topic, pause_ns, size_bytes in messages:
        now_ns += pause_ns
        arrival = Arrival(topic=topic, size_bytes=size_bytes)
        meter(metered, topic, size_bytes, now_ns)
        wake_ns = metered.next_wake_ns
        if wake_ns is not None and wake_ns <= now_ns:
            decisions[0] += step(metered, (), now_ns).decisions
        decisions[1] += step(stepped, (arrival,), now_ns).decisions
        assert decisions[0] == decisions[1]


def test_a_link_that_is_no_limit_is_no_budget_but_one_that_was_set_is() -> None:
    robot = LoopDriver("begin SetFrequency /a 10 end", Profile())
    assert robot.loop.knowledge.budget_kb_per_s is None
    robot.budget(2 * UNLIMITED_KB_PER_S, is_measured=False)
    assert robot.loop.knowledge.budget_kb_per_s == 2 * UNLIMITED_KB_PER_S
    robot.budget(UNLIMITED_KB_PER_S, is_measured=True)
    assert robot.loop.knowledge.budget_kb_per_s is None
    robot.budget(500.0, is_measured=False)
    assert robot.loop.knowledge.budget_kb_per_s == 500.0
    robot.budget(200.0, is_measured=True)
    assert robot.loop.knowledge.budget_kb_per_s == 200.0
