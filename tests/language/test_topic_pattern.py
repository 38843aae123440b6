# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Patterns of topics: what they match, and what they come to beside full names."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from itertools import product

import pytest
from hypothesis import given
from hypothesis import strategies as st

from smarttestudo.domain.names import resolve_topic
from smarttestudo.language.known_types import KnownTypes
from smarttestudo.language.parser import parse
from smarttestudo.language.rule_set import RuleSet, compile_rules
from smarttestudo.language.topic_pattern import matching, may_overlap

NAMES = ("a", "b", "camera")
PARTS = (*NAMES, "*", "**")


def matched(pattern: str, *topics: str) -> list[str]:
    return matching(pattern, topics)


def test_a_star_is_one_name_and_two_are_any_number() -> None:
    topics = ("/camera", "/camera/a", "/camera/a/info", "/cameras/a", "/robot/camera/a", "/status")
    assert matched("/camera/*", *topics) == ["/camera/a"]
    assert matched("/camera/**", *topics) == ["/camera", "/camera/a", "/camera/a/info"]
    assert matched("/*/a", *topics) == ["/camera/a", "/cameras/a"]
    assert matched("/**/a", *topics) == ["/camera/a", "/cameras/a", "/robot/camera/a"]
    assert matched("/**/status", "/status", "/arm/status", "/arm/status/x") == ["/arm/status", "/status"]


def test_what_is_not_for_operators_is_never_matched() -> None:
    hidden = (
        "/_x",
        "/arm/_action/status",
        "/rosout",
        "/parameter_events",
        "/testudo/odom",
        "/testudo/status",
    )
    assert matched("/**", "/odom", *hidden) == ["/odom"]
    assert matched("/testudo/*", *hidden) == []
    assert matched("/arm/_action/*", *hidden) == []


def test_many_stars_take_no_time() -> None:
    name = "/a" * 120
    assert matched("/**/a" * 60, name) == [name]
    assert matched("/**/a" * 60 + "/b", name) == []
    assert may_overlap("/**/a" * 40, "/**/b" * 40 + "/**")
    assert not may_overlap("/**/a" * 40, "/**/b" * 40)


@cache
def patterns() -> st.SearchStrategy[tuple[str, ...]]:
    return st.lists(st.sampled_from(PARTS), min_size=1, max_size=5).map(tuple)


@cache
def topics() -> st.SearchStrategy[tuple[str, ...]]:
    return st.lists(st.sampled_from(NAMES), min_size=1, max_size=6).map(tuple)


def naive_match(parts: Sequence[str], names: Sequence[str]) -> bool:
    if not parts:
        return not names
    if parts[0] == "**":
        return any(naive_match(parts[1:], names[taken:]) for taken in range(len(names) + 1))
    return bool(names) and parts[0] in ("*", names[0]) and naive_match(parts[1:], names[1:])


def full(parts: Sequence[str]) -> str:
    return "".join(f"/{part}" for part in parts)


@given(patterns(), st.lists(topics(), max_size=8))
def test_matches_are_those_of_a_naive_matcher(parts: tuple[str, ...], names: list[tuple[str, ...]]) -> None:
    expected = sorted({full(name) for name in names if naive_match(parts, name)})
    assert matching(full(parts), {full(name) for name in names}) == expected


@pytest.mark.parametrize("length", [1, 2, 3])
def test_overlaps_are_those_that_a_name_shows(length: int) -> None:
    parts = ("a", "b", "*", "**")
    names = [name for size in range(1, 6) for name in product("ab", repeat=size)]
    shown = {
        pattern: frozenset(name for name in names if naive_match(pattern, name))
        for size in range(1, length + 1)
        for pattern in product(parts, repeat=size)
    }
    for one, other in product(shown, repeat=2):
        assert may_overlap(full(one), full(other)) is not shown[one].isdisjoint(shown[other]), (one, other)


def rules(text: str, *there: str) -> RuleSet:
    result = parse(f"begin\n{text}\nend\n", "rules.adirf")
    assert result.is_valid, result.findings
    return compile_rules([result.file], resolve_topic, None, KnownTypes(topics=dict.fromkeys(there, "")))


def defaults_hz(rule_set: RuleSet) -> Mapping[str, float]:
    return {topic: rate.hz for topic, rate in rule_set.defaults.items()}


def test_a_full_name_beats_a_pattern_and_a_longer_beginning_a_shorter_one() -> None:
    text = "SetFrequency /camera/b 7 SetFrequency /camera/* 5 SetFrequency /** 1"
    found = rules(text, "/camera/a", "/camera/b", "/odom")
    assert defaults_hz(found) == {"/camera/b": 7, "/camera/a": 5, "/odom": 1}


def test_of_equal_patterns_the_last_counts_as_of_two_defaults() -> None:
    assert defaults_hz(rules("SetFrequency /a/* 1 SetFrequency /a/** 2", "/a/b")) == {"/a/b": 2}
    assert defaults_hz(rules("SetFrequency /a/** 2 SetFrequency /a/* 1", "/a/b")) == {"/a/b": 1}


def test_floors_and_bounds_are_decided_alike() -> None:
    floors = rules("KeepAtLeast /** 3 KeepAtLeast /a/b 1 KeepAtLeast /a/* 2", "/a/b", "/a/c", "/d")
    assert floors.floors_hz == {"/d": 3, "/a/b": 1, "/a/c": 2}
    bounds = rules("KeepWithin /** yaw 5 KeepWithin /a yaw 9 KeepWithin /** speed 1", "/a", "/b")
    assert bounds.bounds == {"/a": {"yaw": 9, "speed": 1}, "/b": {"yaw": 5, "speed": 1}}


def test_a_block_sets_what_is_there_and_what_is_relayed_by_name() -> None:
    text = """
        SetFrequency /camera/later 1
        If (CheckValue /odom pose_x > 0) Then SetFrequency /camera/* 10 SetFrequency /camera/a 2
        Else SetFrequency /** 4 EndIf
    """
    then, otherwise = rules(text, "/camera/a", "/camera/b", "/odom").blocks
    assert {topic: rate.hz for topic, rate in then.rates.items()} == {
        "/camera/a": 2,
        "/camera/b": 10,
        "/camera/later": 10,
    }
    assert set(otherwise.rates) == {"/camera/a", "/camera/b", "/camera/later", "/odom"}


def test_a_recording_of_a_pattern_that_matches_nothing_keeps_nothing() -> None:
    text = """
        SetFrequency /odom 1
        If (CheckValue /odom pose_x > 0) Then
          Record "some" /camera/* /odom Before 1 s After 1 s
          Record "none" /radar/* Before 1 s After 1 s
          Record "all" Before 1 s After 1 s
        EndIf
    """
    (block,) = rules(text, "/camera/a", "/odom").blocks
    kept = {record.name: record.topics for record in block.recordings}
    assert kept == {"some": ("/camera/a", "/odom"), "none": (), "all": ("/odom", "/camera/a")}


def test_rules_say_whether_what_appears_may_change_them() -> None:
    assert rules("SetFrequency /odom 1").patterns == ()
    assert rules("SetFrequency /odom 1").typed == frozenset()
    named = rules(
        "If (CheckValue /battery_state power_supply_status = POWER_SUPPLY_STATUS_FULL) "
        "Then SetFrequency /camera/* 1 EndIf"
    )
    assert named.patterns == ("/camera/*",)
    assert named.typed == {("/battery_state", "")}


@cache
def statements() -> st.SearchStrategy[tuple[str, str, int]]:
    """A keyword, a name or pattern, and a rate."""
    names = st.one_of(topics(), patterns()).map(full)
    return st.tuples(st.sampled_from(["SetFrequency", "KeepAtLeast"]), names, st.integers(1, 9))


def naive_rates(
    written: Sequence[tuple[str, int]], universe: set[str], *, is_floor: bool
) -> Mapping[str, int]:
    rates = {}
    for topic in universe:
        found = [
            ("*" not in name, len(name.split("*")[0]) if "*" in name else 0, hz if is_floor else place, hz)
            for place, (name, hz) in enumerate(written)
            if name == topic or ("*" in name and naive_match(name.split("/")[1:], topic.split("/")[1:]))
        ]
        if found:
            rates[topic] = max(found)[-1]
    return rates


@given(st.lists(statements(), max_size=6), st.lists(statements(), max_size=4), st.lists(topics(), max_size=6))
def test_rules_with_patterns_are_those_of_the_names_written_out(
    outside: list[tuple[str, str, int]], inside: list[tuple[str, str, int]], there: list[tuple[str, ...]]
) -> None:
    sets = [(name, hz) for keyword, name, hz in outside if keyword == "SetFrequency"]
    floors = [(name, hz) for keyword, name, hz in outside if keyword == "KeepAtLeast"]
    in_block = [*{name: (name, hz) for _, name, hz in inside}.values()]
    text = " ".join(f"{keyword} {name} {hz}" for keyword, name, hz in outside)
    if in_block:
        then = " ".join(f"SetFrequency {name} {hz}" for name, hz in in_block)
        text += f" If (CheckValue /odom pose_x > 0) Then {then} EndIf"
    rule_set = rules(text, *map(full, there))
    named = {name for name, _ in (*sets, *floors, *in_block) if "*" not in name}
    universe = {*map(full, there), *named}
    assert defaults_hz(rule_set) == naive_rates(sets, universe, is_floor=False)
    assert rule_set.floors_hz == naive_rates(floors, universe, is_floor=True)
    for block in rule_set.blocks:
        rates = {topic: rate.hz for topic, rate in block.rates.items()}
        assert rates == naive_rates(in_block, universe, is_floor=False)
