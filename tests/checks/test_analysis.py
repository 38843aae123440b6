# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The interval analysis against looking at every state."""

from __future__ import annotations

from collections import Counter
from itertools import combinations

from hypothesis import given, settings

from checks.naive_rules import VALUES, all_states, applies, completions, decider, holds, rule_files
from smarttestudo.checks import CheckContext
from smarttestudo.checks.analysis.interval_analysis import MAX_CLASHES_SHOWN
from smarttestudo.checks.rule_model import RuleModel, read_rule_model
from smarttestudo.domain.signal import Truth
from smarttestudo.language.parser import parse
from smarttestudo.language.resolved_rules import Branch

EXAMPLES = 150


def book_of(text: str) -> RuleModel:
    result = parse(text, "rules.adirf")
    assert result.is_valid
    return read_rule_model([result.file], CheckContext())


def differ(first: Branch, second: Branch) -> bool:
    shared = first.settings.keys() & second.settings.keys()
    return any(first.settings[topic].rate != second.settings[topic].rate for topic in shared)


@given(rule_files)
@settings(max_examples=EXAMPLES)
def test_a_condition_is_said_to_hold_never_or_always_exactly_when_it_does(text: str) -> None:
    model = book_of(text)
    states = list(all_states())
    for block in model.blocks:
        outcomes = {holds(block.block.condition, state) for state in states}
        expected = {frozenset({True}): Truth.TRUE, frozenset({False}): Truth.FALSE}
        assert model.analysis.truths[block.order] is expected.get(frozenset(outcomes), Truth.UNKNOWN)


@given(rule_files)
@settings(max_examples=EXAMPLES)
def test_two_blocks_clash_exactly_when_some_state_has_both_at_different_rates(text: str) -> None:
    model = book_of(text)
    states = list(all_states())
    expected = {
        (first.order, second.order)
        for first, second in combinations(model.branches, 2)
        if first.block is not second.block
        and first.block.priority == second.block.priority
        and differ(first, second)
        and any(applies(first, state) and applies(second, state) for state in states)
    }
    found = {(clash.first.order, clash.second.order) for clash in model.analysis.clashes}
    shown = Counter(second for _, second in found)
    assert found <= expected
    assert all(shown[second] == MAX_CLASHES_SHOWN for _, second in expected - found)


@given(rule_files)
@settings(max_examples=EXAMPLES)
def test_in_the_state_that_a_clash_shows_both_blocks_hold_whatever_else_is(text: str) -> None:
    for clash in book_of(text).analysis.clashes:
        for state in completions(clash.state):
            assert applies(clash.first, state)
            assert applies(clash.second, state)


@given(rule_files)
@settings(max_examples=EXAMPLES)
def test_a_block_is_called_shadowed_exactly_when_it_never_decides_a_topic(text: str) -> None:
    model = book_of(text)
    deciding = {
        branch.order
        for state in all_states()
        for topic in ("/a", "/b")
        if (branch := decider(model, topic, state)) is not None
    }
    possible = {
        branch.order for branch in model.branches if any(applies(branch, state) for state in all_states())
    }
    assert {shadow.branch.order for shadow in model.analysis.shadows} == possible - deciding


@given(rule_files)
@settings(max_examples=EXAMPLES)
def test_a_topic_has_a_gap_exactly_when_no_block_sets_it_in_some_state(text: str) -> None:
    model = book_of(text)
    topics = {topic for branch in model.branches for topic in branch.settings}
    expected = {
        topic for topic in topics if any(decider(model, topic, state) is None for state in all_states())
    }
    gaps = {gap.topic: gap.state for gap in model.analysis.gaps}
    assert gaps.keys() == expected
    for topic, part in gaps.items():
        assert part is not None
        assert all(decider(model, topic, state) is None for state in completions(part))


@given(rule_files)
@settings(max_examples=EXAMPLES)
def test_blocks_that_meet_never_hold_together_and_one_step_over_the_border_changes_the_block(
    text: str,
) -> None:
    for shared in book_of(text).analysis.shared_borders:
        first, second = shared.first, shared.second
        assert differ(first, second)
        assert not any(applies(first, state) and applies(second, state) for state in all_states())
        signal, value = shared.border.signal, shared.border.value
        near = [one for one in VALUES[signal] if abs(one - value) <= 0.5]
        others = [dict(state) for state in all_states() if state[signal] == near[0]]
        assert any(
            any(applies(first, {**state, signal: one}) for one in near)
            and any(applies(second, {**state, signal: one}) for one in near)
            for state in others
        )
