# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Bounds within a budget: they count what they were measured to need, and are widened where rates are cut."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from loop.loop_driver import rule_set_of
from optimizer.instances import accuracy_tiers
from optimizer.naive import small_kb_per_s
from pacing.reckoning.ros_messages import ODOMETRY
from replays.replay_runs import ReplayRun, replay_content
from replays.test_replay_bounds import driven, recorded
from smarttestudo.domain.decision import Decision, PlannedRate, Reason
from smarttestudo.domain.profile import AccuracyTiers, LevelledProperty, Profile, TopicProfile, rounded_up
from smarttestudo.domain.rate import Rate
from smarttestudo.language.evaluator import RequestedRate
from smarttestudo.loop.knowledge.link_use import LinkUse

MEASURED = AccuracyTiers(bounds=(0.5, 0.25, 0.1, 0.05, 0.02, 0.01), needs_hz=(1, 2, 5, 10, 25, 50))
KB = 0.72


def planned(
    profile: Profile, within: Mapping[str, float], rate: Rate, budget: float
) -> dict[str, PlannedRate]:
    """What the planner makes of one request for each topic of ``profile``, all with the same bounds."""
    sets = "".join(f"SetFrequency {topic} Full\n" for topic in profile.topics)
    link = LinkUse(rule_set_of(f"begin\n{sets}end"), profile, budget)
    for topic, entry in profile.topics.items():
        link.record(topic, 0, round(1000 * (entry.message_kb or 0)))
    request = RequestedRate(planned=PlannedRate(rate=rate, reason=Reason.DEFAULT, within=within), block=None)
    link.update(dict.fromkeys(profile.topics, request), 0, requests_changed=True)
    return {topic: link.within(topic, request).planned for topic in profile.topics}


def odometry_profile(tiers: AccuracyTiers = MEASURED, min_hz: float | None = None) -> Profile:
    entry = TopicProfile(
        message_kb=1.0, source_hz=50.0, min_hz=min_hz, accuracies={LevelledProperty.POSITION: tiers}
    )
    return Profile(topics={"/odom": entry})


@pytest.mark.parametrize(
    ("budget", "bound"), [(10.0, 0.05), (7.5, 0.075), (5.0, 0.1), (1.5, 0.375), (1.0, 0.5), (0.5, 0.5)]
)
def test_a_bound_counts_its_need_and_is_widened_to_what_the_budget_keeps(budget: float, bound: float) -> None:
    after = planned(odometry_profile(), {"position": 0.05}, Rate.full(), budget)["/odom"]
    assert (after.rate, dict(after.within)) == (Rate.full(), {"position": bound})
    assert after.reason is (Reason.DEFAULT if budget >= 10 else Reason.BUDGET)


def test_no_bound_is_widened_below_the_rate_of_a_floor() -> None:
    after = planned(odometry_profile(min_hz=5.0), {"position": 0.05}, Rate.full(), 1.0)["/odom"]
    assert dict(after.within) == {"position": 0.1}


def test_a_ceiling_below_the_need_is_what_a_bound_takes() -> None:
    after = planned(odometry_profile(), {"position": 0.05}, Rate(5.0), 5.0)["/odom"]
    assert (after.rate, dict(after.within), after.reason) == (Rate(5.0), {"position": 0.05}, Reason.DEFAULT)


@pytest.mark.parametrize(
    "within", [{"position": 0.05, "pose_x": 0.1}, {"position": 0.0}, {"orientation": 3.0}]
)
def test_a_topic_with_a_bound_of_unknown_need_counts_its_ceiling_and_loses_rate(
    within: Mapping[str, float],
) -> None:
    after = planned(odometry_profile(), within, Rate(40.0), 10.0)["/odom"]
    assert (after.rate, after.within, after.reason) == (Rate(10.0), within, Reason.BUDGET)


def test_a_bound_tighter_than_what_was_measured_counts_the_ceiling_and_is_widened() -> None:
    assert dict(planned(odometry_profile(), {"position": 0.001}, Rate(60.0), 50.0)["/odom"].within) == {
        "position": 0.001
    }
    assert dict(planned(odometry_profile(), {"position": 0.001}, Rate(60.0), 25.0)["/odom"].within) == {
        "position": 0.02
    }


def test_a_bound_is_brought_to_the_tightest_that_was_measured_whatever_floats_make_of_the_factor() -> None:
    tightest = 2.7943001780957153
    assert 0.01 * (tightest / 0.01) < tightest
    tiers = AccuracyTiers(bounds=(6.0, 5.0, 4.0, 3.5, 3.0, tightest), needs_hz=(0.5,) * 6)
    after = planned(odometry_profile(tiers), {"position": 0.01}, Rate.full(), 0.75)["/odom"]
    assert dict(after.within) == {"position": 2.795}


_WITHIN = {"position": st.sampled_from([0.01, 0.1]) | st.floats(1e-3, 10), "orientation": st.floats(1e-3, 10)}


@cache
@st.composite
def bound_entries(draw: st.DrawFn) -> TopicProfile:
    return TopicProfile(
        message_kb=draw(st.sampled_from([0.1, 1.0, 420.0])),
        source_hz=draw(st.floats(1, 300)),
        priority=draw(st.sampled_from([0.5, 1.0, 2.0])),
        min_hz=draw(st.sampled_from([None, 0.5, 5.0])),
        accuracies={
            LevelledProperty.POSITION: draw(accuracy_tiers(distinct=True)),
            LevelledProperty.ORIENTATION: draw(accuracy_tiers(distinct=True)),
        },
    )


def naive_need_hz(entry: TopicProfile, within: Mapping[str, float]) -> float:
    """By numpy's interpolation."""
    needs = 0.0
    for one, tiers in entry.accuracies.items():
        bound = within.get(one.value, math.inf)
        if one.value in within and tiers.needs_hz is not None:
            known = bound >= tiers.bounds[-1]
            line = float(np.interp(bound, tiers.bounds[::-1], tiers.needs_hz[::-1]))
            needs += line if known else math.inf
    return needs


def naive_bounds(entry: TopicProfile, within: Mapping[str, float], rate_hz: float) -> dict[str, float]:
    """By bisection of the common factor."""
    limits = {
        one.value: max(tiers.bounds[0], within.get(one.value, 0.0)) for one, tiers in entry.accuracies.items()
    }

    def at(factor: float) -> dict[str, float]:
        return {name: min(factor * bound, limits[name]) for name, bound in within.items()}

    low, high = 1.0, max(limits[name] / bound for name, bound in within.items())
    if naive_need_hz(entry, within) <= rate_hz:
        return dict(within)
    if naive_need_hz(entry, at(high)) > rate_hz:
        return at(high)
    for _ in range(200):
        middle = (low + high) / 2
        low, high = (low, middle) if naive_need_hz(entry, at(middle)) <= rate_hz else (middle, high)
    return at(high)


def naive_rates_hz(
    profile: Profile, within: Mapping[str, float], budget: float
) -> dict[str, tuple[float, float]]:
    """What is given and what was wanted: by priority, of one what is small last, equals by one share."""
    wanted, least = {}, {}
    for topic, entry in profile.topics.items():
        floor_hz, source_hz = entry.min_hz or 0.0, entry.source_hz or 0.0
        loosest = naive_bounds(entry, within, -1.0)
        wanted[topic] = min(max(naive_need_hz(entry, within), floor_hz), source_hz)
        least[topic] = min(max(naive_need_hz(entry, loosest), floor_hz), wanted[topic])

    def kb_per_s(topics: list[str], rate_of: Callable[[str], float]) -> float:
        return math.fsum((profile.topics[topic].message_kb or 0.0) * rate_of(topic) for topic in topics)

    excess = kb_per_s([*wanted], lambda topic: wanted[topic]) - budget
    rates = dict(wanted)
    for priority in sorted({entry.priority for entry in profile.topics.values()}):
        group = [topic for topic, entry in profile.topics.items() if entry.priority == priority]
        small = small_kb_per_s([kb_per_s([topic], lambda one: wanted[one]) for topic in group], budget)
        kept = {
            topic: max(least[topic], kb / (profile.topics[topic].message_kb or math.inf))
            for topic, kb in zip(group, small, strict=True)
        }
        for low in (kept, least):
            slack = kb_per_s(group, lambda topic: rates[topic] - low[topic])  # noqa: B023 - called at once
            share = min(1.0, max(0.0, excess) / slack) if slack > 0 else 0.0
            rates.update({topic: rates[topic] - share * (rates[topic] - low[topic]) for topic in group})
            excess -= share * slack
    return {topic: (rates[topic], wanted[topic]) for topic in rates}


@given(
    data=st.data(),
    share=st.floats(0.0, 1.1),
    names=st.sampled_from([("position",), ("position", "orientation")]),
)
@settings(max_examples=300)
def test_the_planned_bounds_are_those_of_a_naive_planner(
    data: st.DataObject, share: float, names: tuple[str, ...]
) -> None:
    entries = data.draw(st.lists(bound_entries(), min_size=1, max_size=4))
    profile = Profile(topics={f"/t{number}": entry for number, entry in enumerate(entries)})
    within = {name: data.draw(_WITHIN[name]) for name in names}
    wanted = math.fsum(
        (one.message_kb or 0) * min(naive_need_hz(one, within), one.source_hz or 0) for one in entries
    )
    budget = share * wanted
    rates_hz = naive_rates_hz(profile, within, budget)
    for topic, after in planned(profile, within, Rate.full(), budget).items():
        entry = profile.topics[topic]
        assert after.rate == Rate.full()
        # Rates are planned in steps of 0.001 Hz, bounds in four digits.
        given_hz, wanted_hz = rates_hz[topic]
        noise_hz = 1e-6 * max(1.0, given_hz)
        tightest = (
            within if given_hz + noise_hz >= wanted_hz else naive_bounds(entry, within, given_hz + noise_hz)
        )
        loosest = (
            within if given_hz == wanted_hz else naive_bounds(entry, within, given_hz - 0.001 - noise_hz)
        )
        for name, bound in after.within.items():
            assert (
                tightest[name] * (1 - 1e-9)
                <= bound
                <= max(rounded_up(loosest[name]), loosest[name]) * (1 + 1e-9)
            )


def profile_of_circle() -> Profile:
    """What the circle of ``driven`` needs with hold: its messages at 0.5 m/s, a heartbeat at least."""
    tiers = AccuracyTiers(bounds=(1.0, 0.5, 0.2, 0.1, 0.05, 0.02), needs_hz=(0.5, 1.0, 2.5, 5.0, 10.0, 25.0))
    entry = TopicProfile(
        type_name=ODOMETRY, message_kb=KB, source_hz=50.0, accuracies={LevelledProperty.POSITION: tiers}
    )
    return Profile(topics={"/odom": entry}, settle_s=0.0)


def replayed(tmp_path: Path, budget: float) -> ReplayRun:
    content = recorded("/odom", ODOMETRY, 50, 20, driven)
    rules = """SetFrequency /odom Full
Rule "near" If CheckValue /odom pose_y < 20 Then KeepWithin /odom position 0.05"""
    return replay_content(content, rules, tmp_path, profile=profile_of_circle(), budget_kb_per_s=budget)


def test_a_replay_within_a_budget_widens_the_bound_keeps_it_and_says_why(tmp_path: Path) -> None:
    size_kb = len(driven(0, 0.0)) / 1000
    run = replayed(tmp_path, 5 * size_kb)
    last = [one for one in run.decisions if one.topic == "/odom"][-1]
    assert (last.planned.reason, last.planned.rule, last.planned.rate) == (Reason.BUDGET, "near", Rate.full())
    assert last.planned.within == {"position": pytest.approx(0.1, rel=0.01)}
    assert all(one.broken == 0 for one in run.outcome.topics["/odom"].bounds["position"])
    assert 90 <= len(run.on("/odom")) <= 110
    assert Decision.from_json(last.to_json()) == replace(last, values=dict(last.values))


def test_a_replay_within_an_ample_budget_leaves_the_bound_as_it_is(tmp_path: Path) -> None:
    run = replayed(tmp_path, 100.0)
    assert {one.planned.reason for one in run.decisions} <= {Reason.DEFAULT, Reason.BLOCK, Reason.UNKNOWN}
    # At 50 Hz and 0.5 m/s every sixth message is more than 5 cm off.
    assert 164 <= len(run.on("/odom")) <= 170
