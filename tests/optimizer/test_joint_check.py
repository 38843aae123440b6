# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Situations that break the budget: those that brute force finds, no more and no less."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from pathlib import Path
from typing import cast

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from smarttestudo.domain.names import resolve_topic
from smarttestudo.domain.rate import Rate
from smarttestudo.domain.signal import Signal
from smarttestudo.language.normal_form import holds
from smarttestudo.language.parser import parse
from smarttestudo.language.region import Region
from smarttestudo.language.rule_set import RuleSet, compile_rules
from smarttestudo.optimizer.joint import JointCheck, Loads, check_together
from smarttestudo.optimizer.problem import fits
from smarttestudo.rules.profile_file import parse_profile

TOPICS = ("/a", "/b", "/c")
SIGNALS = ("/x p", "/x q", "/y p")
PROFILE = parse_profile(
    """
[topics."/b"]
tiers_m = [0.5, 0.2, 0.1, 0.05, 0.02, 0.01]
tiers_m_need_hz = [0.1, 1, 2, 5, 10, 20]
""",
    Path("profile.toml"),
)
SIZE_KB = {"/a": 0.1, "/b": 1.0, "/c": 30.0}
SOURCE_HZ = {"/a": 200.0, "/b": 30.0, "/c": 25.0}

checks = st.builds(
    "CheckValue {} {} {}".format,
    st.sampled_from(SIGNALS),
    st.sampled_from([">", "<", ">=", "<=", "=", "!="]),
    st.integers(-2, 2),
)
conditions = st.recursive(
    checks,
    lambda inner: (
        st.builds("({} {} {})".format, inner, st.sampled_from(["AND", "OR"]), inner)
        | st.builds("Not {}".format, inner)
    ),
    max_leaves=4,
)
bounds = st.sampled_from(["0.5", "0.2", "0.05", "0.01"]).map("KeepWithin /b position {}".format)
rates = st.sampled_from(["0", "1", "2.5", "10", "Full", "Off"])
sets = st.dictionaries(st.sampled_from(TOPICS), rates, min_size=1).map(
    lambda chosen: " ".join(f"SetFrequency {topic} {rate}" for topic, rate in chosen.items())
)
blocks = st.builds(
    'Rule "r" Priority {} If {} Then {} {} {} EndIf'.format,
    st.integers(0, 1),
    conditions,
    sets,
    st.just("") | bounds,
    st.just("") | sets.map("Else {}".format),
)
files = st.builds(
    "begin {} {} {} {} end".format,
    sets,
    st.sampled_from(["", "KeepAtLeast /b 2", "KeepAtLeast /b 8"]),
    st.just("") | bounds,
    st.lists(blocks, max_size=4).map(" ".join),
)


def compiled(text: str) -> RuleSet:
    result = parse(text, "rules.adirf")
    assert result.findings == ()
    return compile_rules([result.file], resolve_topic)


def loads(rule_set: RuleSet) -> Loads:
    return Loads(size_kb=SIZE_KB, source_hz=SOURCE_HZ, floors_hz=rule_set.floors_hz, profile=PROFILE)


def checked(text: str, budget: float) -> JointCheck:
    rule_set = compiled(text)
    return check_together(
        rule_set, loads(rule_set), budget, lambda _: Region.everything(), max_situations=10_000
    )


def naive_load(rule_set: RuleSet, holding: frozenset[int]) -> float:
    total = 0.0
    for topic in rule_set.relayed:
        setting = [block for block in rule_set.blocks if block.order in holding and topic in block.rates]
        request = max(((one.priority, one.rates[topic]) for one in setting), default=None)
        rate = rule_set.defaults.get(topic, Rate.full()) if request is None else request[1]
        rate = rate.at_least(rule_set.floors_hz.get(topic, 0.0))
        rate_hz = SOURCE_HZ[topic] if rate.is_full else rate.hz
        total += SIZE_KB[topic] * min(rate_hz, naive_needed_hz(rule_set, holding, topic))
    return total


def naive_needed_hz(rule_set: RuleSet, holding: frozenset[int], topic: str) -> float:
    """What the bound of a topic's position needs, at least its floor, or one message in two seconds."""
    setting = [block for block in rule_set.blocks if block.order in holding and topic in block.bounds]
    bound = rule_set.bounds.get(topic, {}).get("position")
    if setting:
        bound = min((-one.priority, one.bounds[topic]["position"]) for one in setting)[1]
    tiers = PROFILE.topic(topic).accuracy("position")
    if bound is None or tiers is None:
        return math.inf
    return max(tiers.needed_hz(bound), rule_set.floors_hz.get(topic, 0.5))


def every_state(rule_set: RuleSet) -> Iterator[dict[Signal, float]]:
    """Every threshold, the midpoints between, and beyond: thresholds are whole numbers from -2 to 2."""
    signals = sorted(rule_set.signals)
    values = [half / 2 for half in range(-6, 7)]
    for chosen in itertools.product(values, repeat=len(signals)):
        yield dict(zip(signals, chosen, strict=True))


def holding_in(rule_set: RuleSet, state: dict[Signal, float]) -> frozenset[int]:
    return frozenset(block.order for block in rule_set.blocks if holds(block.form, state))


@given(text=files, budget=st.sampled_from([0.0, 10.0, 50.0, 100.0, 330.0, 760.0, 800.0]))
@settings(max_examples=300)
def test_the_breaking_situations_are_those_that_brute_force_finds(text: str, budget: float) -> None:
    rule_set, result = compiled(text), checked(text, budget)
    possible = {holding_in(rule_set, state) for state in every_state(rule_set)}
    expected = {one for one in possible if not fits(naive_load(rule_set, one), budget)}
    found = {frozenset(block.order for block in one.blocks) for one in result.breaking}
    assert found == expected
    assert len(found) == len(result.breaking)
    assert result.worst.kb_per_s == pytest.approx(max(naive_load(rule_set, one) for one in possible))
    for situation in result.breaking:
        holding = holding_in(rule_set, cast("dict[Signal, float]", situation.state))
        assert holding == {block.order for block in situation.blocks}
        assert situation.kb_per_s == pytest.approx(naive_load(rule_set, holding))


@given(text=files)
@settings(max_examples=50)
def test_no_situation_takes_more_than_the_start_up(text: str) -> None:
    result = checked(text, 0.0)
    assert result.start_up_kb_per_s >= result.worst.kb_per_s - 1e-9


TWO_ZONES = """\
begin
  SetFrequency /a 1 SetFrequency /b 1
  Rule "near" If (CheckValue /x p > 1) Then SetFrequency /a 100 EndIf
  Rule "far" If (CheckValue /x p < {far}) Then SetFrequency /b 10 EndIf
end
"""


def test_a_bound_topic_takes_at_least_its_floor() -> None:
    text = "begin KeepAtLeast /b 8 KeepWithin /b position 0.2 end"
    (situation,) = checked(text, 5.0).breaking
    assert situation.kb_per_s == pytest.approx(8.0)


def test_a_bound_topic_without_a_floor_takes_at_least_its_heartbeat() -> None:
    assert checked("begin KeepWithin /b position 0.5 end", 5.0).worst.kb_per_s == pytest.approx(0.5)


def test_blocks_that_fit_alone_but_not_together_are_found_with_a_state() -> None:
    (situation,) = checked(TWO_ZONES.format(far=3), 15.0).breaking
    assert [block.label for block in situation.blocks] == ["near", "far"]
    assert situation.state == {Signal("/x", "p"): 2.0}
    assert situation.kb_per_s == pytest.approx(20.0)


def test_blocks_that_exclude_each_other_are_not_added_up() -> None:
    result = checked(TWO_ZONES.format(far=1), 15.0)
    assert result.breaking == ()
    assert result.worst.kb_per_s == pytest.approx(11.0)


def test_blocks_over_different_signals_add_up() -> None:
    (situation,) = checked(TWO_ZONES.format(far=1).replace("/x p <", "/y p <"), 15.0).breaking
    assert [block.label for block in situation.blocks] == ["near", "far"]


def test_a_possible_value_is_needed() -> None:
    text = "begin SetFrequency /a 1 If CheckValue /x p > 120 Then SetFrequency /a 100 EndIf end"
    percent = Region.between(0, 100)
    rule_set = compiled(text)
    result = check_together(rule_set, loads(rule_set), 5.0, lambda _: percent)
    assert result.breaking == ()


def test_more_than_100000_cells_are_not_searched() -> None:
    bounds = " AND ".join(f"Not CheckValue {signal} = {value}" for signal in SIGNALS for value in range(24))
    text = f"begin SetFrequency /a 1 If ({bounds}) Then SetFrequency /a 2 EndIf end"
    result = checked(text, 1e9)
    assert [(one.cells, len(one.blocks)) for one in result.unproven] == [(49**3, 1)]


def test_the_one_zone_of_hundreds_that_takes_too_much_is_found() -> None:
    zones = " ".join(
        f"If (CheckValue /x p > {x} AND CheckValue /x p < {x + 1} AND CheckValue /x q > {y} "
        f"AND CheckValue /x q < {y + 1}) Then SetFrequency /a {x + y} EndIf"
        for x in range(30)
        for y in range(30)
    )
    result = checked(f"begin SetFrequency /a 1 {zones} end", 5.7)
    assert [one.kb_per_s for one in result.breaking] == pytest.approx([5.8])
