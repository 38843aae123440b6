# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The interval analysis of rules with texts, true and false, against looking at every state."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping
from functools import cache
from itertools import combinations

from hypothesis import given, settings
from hypothesis import strategies as st

from checks.naive_rules import settings_of
from language.evaluator.naive_rules import naive_truth
from smarttestudo.checks import CheckContext
from smarttestudo.checks.analysis.interval_analysis import MAX_CLASHES_SHOWN
from smarttestudo.checks.rule_model import RuleModel, read_rule_model
from smarttestudo.domain.signal import Signal, SignalKind, Truth, Value
from smarttestudo.language.parser import parse
from smarttestudo.language.resolved_rules import Branch

MODE = Signal("/mode", "data", SignalKind.TEXT)
PRESSED = Signal("/estop", "data", SignalKind.STATE)
X = Signal("/odom", "pose_x")
VALUES: Mapping[Signal, tuple[Value, ...]] = {
    MODE: ("docking", "driving", "", "else"),
    PRESSED: (0.0, 1.0, 7.0),
    X: (-0.5, 0.0, 0.5, 1.0, 1.5),
}
State = dict[Signal, Value]


@cache
@st.composite
def checks(draw: st.DrawFn) -> str:
    equality = st.sampled_from(["=", "!="])
    word = st.sampled_from(['/mode data {} "docking"', '/mode data {} "driving"', '/mode data {} ""'])
    truth = st.sampled_from(["/estop data {} true", "/estop data {} false"])
    written = draw(
        st.one_of(
            st.builds(str.format, st.one_of(word, truth), equality),
            st.builds("/odom pose_x {} {}".format, st.sampled_from([">", "<=", "="]), st.sampled_from("01")),
        )
    )
    return f"CheckValue {written}"


def _joined(parts: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    several = st.tuples(st.lists(parts, min_size=2, max_size=3), st.sampled_from([" AND ", " OR "]))
    return several.map(lambda pair: f"({pair[1].join(pair[0])})") | parts.map(lambda part: f"Not {part}")


@cache
@st.composite
def rule_files(draw: st.DrawFn) -> str:
    conditions = st.recursive(checks(), _joined, max_leaves=4)
    headings = st.sampled_from(["", 'Rule "n" Priority 1 '])
    blocks = [
        f"{draw(headings)}If {draw(conditions)} Then {draw(settings_of())}"
        for _ in range(draw(st.integers(1, 4)))
    ]
    return "\n".join(["begin", *blocks, "end"])


def model_of(text: str) -> RuleModel:
    result = parse(text, "rules.adirf")
    assert result.is_valid, result.findings
    return read_rule_model([result.file], CheckContext())


def all_states() -> Iterator[State]:
    for values in itertools.product(*VALUES.values()):
        yield dict(zip(VALUES, values, strict=True))


def applies(branch: Branch, state: State) -> bool:
    return (naive_truth(branch.block.block.condition, state) is True) != branch.is_else


def differ(first: Branch, second: Branch) -> bool:
    shared = first.settings.keys() & second.settings.keys()
    return any(first.settings[topic].rate != second.settings[topic].rate for topic in shared)


@given(rule_files())
@settings(max_examples=400)
def test_a_condition_on_words_is_said_to_hold_never_or_always_exactly_when_it_does(text: str) -> None:
    model = model_of(text)
    for block in model.blocks:
        outcomes = {naive_truth(block.block.condition, state) is True for state in all_states()}
        expected = {frozenset({True}): Truth.TRUE, frozenset({False}): Truth.FALSE}
        assert model.analysis.truths[block.order] is expected.get(frozenset(outcomes), Truth.UNKNOWN)


@given(rule_files())
@settings(max_examples=200)
def test_two_blocks_on_words_clash_exactly_when_some_state_has_both_at_different_rates(text: str) -> None:
    model = model_of(text)
    expected = {
        (first.order, second.order)
        for first, second in combinations(model.branches, 2)
        if first.block.priority == second.block.priority
        and differ(first, second)
        and any(applies(first, state) and applies(second, state) for state in all_states())
    }
    found = {(clash.first.order, clash.second.order) for clash in model.analysis.clashes}
    assert found <= expected
    assert len(found) == len(expected) or len(found) >= MAX_CLASHES_SHOWN
    for clash in model.analysis.clashes:
        state = {**next(all_states()), **clash.state}
        assert applies(clash.first, state)
        assert applies(clash.second, state)
