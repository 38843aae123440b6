# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Conditions with time are what their definition says, at the exact nanosecond, whenever the loop steps."""

from __future__ import annotations

from dataclasses import replace
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from language.evaluator.naive_time import Sample, duration, random_condition, truths
from language.evaluator.random_rules import SPAN, block, check, rule_file, set_frequency
from smarttestudo.domain.signal import Signal, Truth
from smarttestudo.language.evaluator import Evaluator
from smarttestudo.language.rule_set import RecordRequest, compile_rules
from smarttestudo.language.syntax import And, Condition, Operator, Timed, TimeWord

SIGNALS = [Signal("/p", "x"), Signal("/p", "y"), Signal("/q", "z")]
BORDERS = [0.0, 1.0, 2.0]
VALUES = [None, -1.0, 0.0, 0.5, 1.0, 1.5, 2.0, 3.0]
TRUTHS = {False: Truth.FALSE, None: Truth.UNKNOWN, True: Truth.TRUE}
CASES_AN_EXAMPLE = 50

Values = dict[Signal, float | None]


def evaluator_of(*conditions: Condition, start_ns: int = 0) -> Evaluator:
    blocks = [block(condition, [set_frequency("/a", 1.0)]) for condition in conditions]
    return Evaluator(compile_rules([rule_file(blocks)], lambda name: name), start_ns)


class Watched:
    """An evaluator beside the history of all it was told; ``check`` compares the two."""

    def __init__(self, condition: Condition) -> None:
        self.condition = condition
        self.evaluator = evaluator_of(condition)
        self.history: list[Sample] = []
        self.values: Values = dict.fromkeys(SIGNALS)
        self.step(0, {})

    def step(self, now_ns: int, changes: Values) -> None:
        self.values = {**self.values, **changes}
        # Time alone passed until now: every instant counts as a sample of its own.
        last_ns = self.history[-1].t_ns if self.history else now_ns
        self.history += [Sample(t_ns, self.history[-1].values) for t_ns in range(last_ns + 1, now_ns)]
        self.history.append(Sample(now_ns, self.values))
        self.evaluator.advance(now_ns)
        for signal, value in changes.items():
            self.evaluator.set(signal, value)
        self.evaluator.take_changed_topics()
        assert self.evaluator.truth(0) is TRUTHS[truths(self.condition, self.history)[-1]]

    def pass_time_to(self, end_ns: int, random: Random) -> None:
        """Wake at alarms, of which some are missed, as where the next message comes in place of a wake."""
        while (alarm_ns := self.evaluator.next_alarm_ns) is not None and alarm_ns <= end_ns:
            self.assert_nothing_changes_before(alarm_ns)
            if random.random() < 0.3:
                return
            self.step(alarm_ns, {})
        self.assert_nothing_changes_before(end_ns)

    def assert_nothing_changes_before(self, end_ns: int) -> None:
        last = self.history[-1]
        silence = [Sample(t_ns, last.values) for t_ns in range(last.t_ns + 1, end_ns)]
        found = truths(self.condition, [*self.history, *silence])[len(self.history) - 1 :]
        assert set(found) == {found[0]}


@given(st.integers(0, 2**32))
@settings(max_examples=200, deadline=None)
def test_a_condition_is_at_every_instant_what_its_definition_says(seed: int) -> None:
    for case in range(CASES_AN_EXAMPLE):
        random = Random(f"{seed} {case}")
        watched = Watched(random_condition(random, SIGNALS, BORDERS, depth=random.randint(1, 3)))
        now_ns = 0
        for _ in range(random.randint(2, 7)):
            now_ns += random.choice((0, 1, 1, 2, 3, 5))
            watched.pass_time_to(now_ns, random)
            changed = random.sample(SIGNALS, random.randint(1, 2))
            watched.step(now_ns, {signal: random.choice(VALUES) for signal in changed})
        watched.pass_time_to(now_ns + 15, random)


@given(st.integers(0, 2**32))
@settings(max_examples=100, deadline=None)
def test_a_condition_that_is_carried_on_goes_on_as_if_nothing_had_happened(seed: int) -> None:
    random = Random(seed)
    kept = random_condition(random, SIGNALS, BORDERS)
    other = random_condition(random, SIGNALS, BORDERS)
    before, straight = evaluator_of(kept), evaluator_of(kept)
    values: Values = dict.fromkeys(SIGNALS)
    now_ns, reload_at, after = 0, random.randint(0, 5), None
    for step in range(8):
        now_ns += random.choice((0, 1, 2, 4))
        values = {**values, random.choice(SIGNALS): random.choice(VALUES)}
        if step == reload_at:
            for one in (before, straight):
                one.advance(now_ns)
                one.take_changed_topics()
            after = evaluator_of(other, kept, start_ns=now_ns)
            after.restore_history(before)
        for one in (straight, after or before):
            one.advance(now_ns)
            for signal, value in values.items():
                one.set(signal, value)
            one.take_changed_topics()
        assert straight.truth(0) is (before.truth(0) if after is None else after.truth(1))
    assert after is not None
    for later_ns in range(now_ns + 1, now_ns + 15):
        for one in (straight, after):
            one.advance(later_ns)
            one.take_changed_topics()
        assert straight.truth(0) is after.truth(1)


@given(st.integers(0, 2**32))
@settings(max_examples=100, deadline=None)
def test_what_was_foreseen_of_values_changes_nothing_whether_they_come_or_not(seed: int) -> None:
    for case in range(CASES_AN_EXAMPLE):
        assert_foreseeing_changes_nothing(Random(f"{seed} {case}"))


def assert_foreseeing_changes_nothing(random: Random) -> None:
    """Exchange the rules of an evaluator for others, made at once and made and computed beforehand."""
    kept, other, old = (random_condition(random, SIGNALS, BORDERS, depth=random.randint(1, 3)) for _ in "abc")
    record = RecordRequest(name="seen", line=1, topics=("/a",), before_ns=0, after_ns=0)
    before = evaluator_of(kept, old)
    blocks = [block(condition, [set_frequency("/a", 1.0)]) for condition in (other, kept)]
    rule_set = compile_rules([rule_file(blocks)], lambda name: name)
    rule_set = replace(
        rule_set, blocks=(replace(rule_set.blocks[0], recordings=(record,)), rule_set.blocks[1])
    )
    values: Values = dict.fromkeys(SIGNALS)
    foreseen_at, now_ns, reload_at = random.randint(0, 3), 0, random.randint(3, 5)
    both: list[Evaluator] = []
    for step in range(9):
        now_ns += random.choice((0, 1, 2, 4))
        values = {**values, random.choice(SIGNALS): random.choice(VALUES)}
        if step == foreseen_at:
            prepared = Evaluator(rule_set)
            prepared.foresee(before.values)
        if step == reload_at:
            before.advance(now_ns)
            prepared.start(now_ns)
            both = [Evaluator(rule_set, now_ns), prepared]
            for one in both:
                one.restore_history(before)
        for one in both or [before]:
            one.advance(now_ns)
            for signal, value in values.items():
                one.set(signal, value)
            one.take_changed_topics()
        if both:
            assert seen_of(both[0]) == seen_of(both[1])


def seen_of(evaluator: Evaluator) -> object:
    """All that a loop asks of an evaluator with two blocks."""
    orders = (0, 1)
    return (
        [(evaluator.truth(order), evaluator.changed_ns(order)) for order in orders],
        evaluator.decide("/a"),
        evaluator.next_alarm_ns,
        evaluator.take_turned_acting(),
        evaluator.values,
    )


def held(border: float, seconds: float) -> Timed:
    return Timed(
        operand=check(SIGNALS[0], Operator.GREATER, border),
        word=TimeWord.FOR,
        duration=duration(round(seconds * 1e9)),
        span=SPAN,
    )


@pytest.mark.full
def test_a_crossing_costs_the_same_beside_ten_and_ten_thousand_timed_rules() -> None:
    def cost(rules: int) -> int:
        evaluator = evaluator_of(*(held(float(border), 5.0) for border in range(rules)))
        evaluator.set(SIGNALS[0], 3.5)
        evaluator.take_changed_topics()
        evaluator.advance(10_000_000_000)
        evaluator.take_changed_topics()
        touched = evaluator.touched
        evaluator.set(SIGNALS[0], 4.5)
        evaluator.take_changed_topics()
        evaluator.advance(15_000_000_000)
        evaluator.take_changed_topics()
        assert evaluator.truth(4) is Truth.TRUE
        return evaluator.touched - touched

    assert cost(10_000) == cost(10)


def test_for_turns_at_the_very_nanosecond_and_not_before() -> None:
    evaluator = evaluator_of(held(1.0, 5.0))
    evaluator.advance(100)
    evaluator.set(SIGNALS[0], 2.0)
    evaluator.take_changed_topics()
    assert evaluator.next_alarm_ns == 5_000_000_100
    evaluator.advance(5_000_000_099)
    assert evaluator.truth(0) is Truth.UNKNOWN
    evaluator.advance(5_000_000_100)
    assert evaluator.truth(0) is Truth.TRUE
    assert evaluator.next_alarm_ns is None


def test_time_counts_inside_a_conjunction_with_what_does_not_wait() -> None:
    both = And(operands=(held(1.0, 5.0), check(SIGNALS[1], Operator.LESS, 0.0)), span=SPAN)
    evaluator = evaluator_of(both)
    evaluator.set(SIGNALS[0], 2.0)
    evaluator.set(SIGNALS[1], 1.0)
    assert evaluator.truth(0) is Truth.FALSE
    evaluator.advance(5_000_000_000)
    evaluator.set(SIGNALS[1], -1.0)
    assert evaluator.truth(0) is Truth.TRUE
