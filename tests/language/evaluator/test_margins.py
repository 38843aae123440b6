# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rates that go by a value: never below the straight line, in five steps, and against other blocks."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from loop.loop_driver import SECOND, LoopDriver
from smarttestudo.domain.decision import Reason
from smarttestudo.domain.signal import Signal
from smarttestudo.language.evaluator import Evaluator, explain
from smarttestudo.language.normal_form import region_text
from smarttestudo.language.parser import parse
from smarttestudo.language.rule_set import RuleSet, compile_rules

ZONE, GAP = Signal("/p", "x"), Signal("/q", "gap")


class Ends(NamedTuple):
    """From ``first`` Hz at ``first_at`` to ``second`` Hz at ``second_at``."""

    first: float
    second: float
    first_at: float
    second_at: float

    def naive_hz(self, value: float | None) -> float:
        low, high = sorted([(self.first, self.first_at), (self.second, self.second_at)])
        if value is None:
            return high[0]
        share = min(max((value - low[1]) / (high[1] - low[1]), 0.0), 1.0)
        step = math.ceil(round(share * 5, 9))
        return low[0] + (high[0] - low[0]) * step / 5

    def __str__(self) -> str:
        return f"{self.first} .. {self.second} By /q gap {self.first_at} .. {self.second_at}"


class Rule(NamedTuple):
    """A block that sets ``/t`` where ``/p x`` is above ``border``."""

    border: float
    priority: int
    rate: float | Ends


def rules_of(default: float | Ends, rules: Sequence[Rule]) -> RuleSet:
    blocks = "".join(
        f'Rule "r{place}" Priority {rule.priority} If CheckValue /p x > {rule.border} '
        f"Then SetFrequency /t {rule.rate} EndIf\n"
        for place, rule in enumerate(rules)
    )
    result = parse(f"begin SetFrequency /t {default}\n{blocks}end", "x.adirf")
    assert result.is_valid, result.findings
    return compile_rules([result.file], lambda name: name)


def naive_request(
    default: float | Ends, rules: Sequence[Rule], zone: float | None, gap: float | None
) -> tuple[float, str | None]:
    """The rate, and the rule that decides it, by all blocks in turn."""

    def hz(rate: float | Ends) -> float:
        return rate.naive_hz(gap) if isinstance(rate, Ends) else rate

    named = [(rule, f"r{place}") for place, rule in enumerate(rules)]
    found: tuple[float, str | None] = (hz(default), None)
    holding = [] if zone is None else [one for one in named if zone > one[0].border]
    if holding:
        top = max(rule.priority for rule, _ in holding)
        best = max((one for one in holding if one[0].priority == top), key=lambda one: hz(one[0].rate))
        found = hz(best[0].rate), best[1]
    if zone is None and named:
        doubt = max(named, key=lambda one: hz(one[0].rate))
        if hz(doubt[0].rate) > found[0]:
            found = hz(doubt[0].rate), doubt[1]
    return found


numbers = st.sampled_from([0.0, 1.0, 2.0, 2.5, 5.0, 10.0, 20.0])
places = st.sampled_from([-1.0, 0.0, 0.5, 3.0, 100.0])
ends = st.builds(Ends, numbers, numbers, places, places).filter(
    lambda one: one.first != one.second and one.first_at != one.second_at
)
rates = st.one_of(numbers, ends)
rule_lists = st.lists(st.builds(Rule, st.sampled_from([0.0, 1.0]), st.integers(0, 2), rates), max_size=5)
values = st.one_of(st.none(), st.integers(-200, 10_100).map(lambda number: number / 100), places)


@settings(max_examples=300)
@given(rates, rule_lists, st.lists(st.tuples(values, values), min_size=1, max_size=8))
def test_a_margin_counts_with_its_present_rate_as_a_naive_reading_says(
    default: float | Ends, rules: list[Rule], steps: list[tuple[float | None, float | None]]
) -> None:
    evaluator = Evaluator(rules_of(default, rules))
    for zone, gap in steps:
        before = evaluator.request("/t")
        evaluator.take_changed_topics()
        evaluator.set(ZONE, zone)
        evaluator.set(GAP, gap)
        changed = evaluator.take_changed_topics()
        request = evaluator.request("/t")
        hz, rule = naive_request(default, rules, zone, gap)
        assert request.rate.hz == pytest.approx(hz)
        assert request.rule == rule
        assert request == before or "/t" in changed


@given(ends, st.floats(-10, 110))
def test_a_margin_is_never_below_the_straight_line_nor_a_step_above_it(one: Ends, value: float) -> None:
    evaluator = Evaluator(rules_of(one, []))
    evaluator.set(GAP, value)
    share = min(max((value - one.first_at) / (one.second_at - one.first_at), 0.0), 1.0)
    line_hz = one.first + (one.second - one.first) * share
    hz = evaluator.request("/t").rate.hz
    assert line_hz - 1e-9 <= hz <= line_hz + abs(one.second - one.first) / 5 + 1e-9


def test_an_unknown_value_asks_for_the_higher_rate_and_says_that_it_is_in_doubt() -> None:
    evaluator = Evaluator(rules_of(Ends(2, 20, 3, 0.5), []))
    request = evaluator.request("/t")
    assert (request.rate.hz, request.reason) == (20, Reason.UNKNOWN)
    evaluator.set(GAP, 3.0)
    assert (evaluator.request("/t").rate.hz, evaluator.request("/t").reason) == (2, Reason.DEFAULT)


def test_an_explanation_names_the_values_at_which_the_rate_changes() -> None:
    rule_set = rules_of(Ends(2, 20, 3, 0.5), [])
    explained = explain(rule_set, "/t", {GAP: 2.2})
    (value,) = explained.values
    assert (value.signal, explained.request.rate.hz) == (GAP, 9.2)
    borders = [(region_text(border.where), round(border.request.rate.hz, 3)) for border in value.borders]
    assert borders == [("< 2", 12.8), (">= 2.5", 5.6)]


def test_each_step_is_a_decision_raised_at_once_and_lowered_when_it_has_settled() -> None:
    driver = LoopDriver("begin SetFrequency /scan 2 .. 20 By /odom pose_x 10 .. 0 end")
    for second, x in enumerate([20.0, 20.0, 5.0, 0.0, 20.0, 20.0]):
        driver.drive(second * SECOND, x, 0.0)
    driver.wait_until(8 * SECOND)
    decisions = driver.decisions
    rates_hz = [(one.t_s, round(one.planned.rate.hz, 3)) for one in decisions if one.topic == "/scan"]
    assert [hz for _, hz in rates_hz] == [20, 2, 12.8, 20, 2]
    assert rates_hz[-1][0] > 4.0
