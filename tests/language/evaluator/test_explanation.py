# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What would change a rate is what does: the borders agree with a naive reading of the text."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from language.evaluator.naive_rules import naive_request
from language.evaluator.random_rules import rule_files
from language.evaluator.test_evaluator import BORDERS, SIGNALS, values
from smarttestudo.domain.rate import Rate
from smarttestudo.domain.signal import Signal
from smarttestudo.language.evaluator import ExplainedValue, RateExplanation, explain, explain_block
from smarttestudo.language.normal_form import region_text
from smarttestudo.language.parser import parse
from smarttestudo.language.rule_set import RuleSet, compile_rules
from smarttestudo.language.syntax import RuleFile

NEAR = (-9.0, -1.5, -1.0, -0.5, 0.0, 0.5, 1.0, 1.5, 2.0, 2.25, 2.5, 9.0)
"""A number at each border, and one between two."""
TIMED = """begin
  SetFrequency /a 10
  Rule "Low" If (CheckValue /b level < 20) For 5 s Then SetFrequency /a 2 EndIf
  Rule "Turn" If (CheckValue /c x > 2 Until < 1 AND CheckValue /c y > 0 Within 3 s)
  Then SetFrequency /a 30 EndIf
end"""
LEVEL, X, Y = Signal("/b", "level"), Signal("/c", "x"), Signal("/c", "y")
LOW_HELD, Y_LOST = Signal("/b level < 20", "held_s"), Signal("/c y <= 0", "held_s")
TURN_SEEN = Signal("/c x > 2 Until < 1", "last_seen")
CALM = {LEVEL: 50.0, X: 0.0, Y: -1.0, LOW_HELD: 0.0, Y_LOST: 60.0, TURN_SEEN: 0.0}


def compiled(*files: RuleFile) -> RuleSet:
    return compile_rules(files, lambda name: name)


@settings(max_examples=200)
@given(rule_files(SIGNALS, BORDERS, max_blocks=4), st.fixed_dictionaries(dict.fromkeys(SIGNALS, values)))
def test_borders_are_the_nearest_at_which_the_rate_changes_and_what_it_is_beyond(
    files: list[RuleFile], now: dict[Signal, float | None]
) -> None:
    known = {signal: None if value is None or math.isnan(value) else value for signal, value in now.items()}
    rules = compiled(*files)
    for topic in rules.relayed:
        explanation = explain(rules, topic, known)
        before = naive_request(files, topic, known)
        assert explanation.request.rate.hz == before.hz
        read = {
            signal
            for block in rules.blocks
            if topic in block.topics
            for signal in compiled_reads(rules, block.order)
        }
        assert {one.signal for one in explanation.values} == read
        for one in explanation.values:
            rates = {x: naive_request(files, topic, {**known, one.signal: x}) for x in NEAR}
            changing = {x for x in NEAR if (rates[x].hz, rates[x].off) != (before.hz, before.off)}
            assert_nearest(one, changing, {x: rates[x].hz for x in NEAR})


def compiled_reads(rules: RuleSet, order: int) -> set[Signal]:
    return set(RuleSet(defaults={}, default_lines={}, floors_hz={}, blocks=(rules.blocks[order],)).signals)


def assert_nearest(one: ExplainedValue, changing: set[float], rates_hz: dict[float, float]) -> None:
    """Each border has the nearest of the ``changing`` numbers of its side, and their rate."""
    if one.value is None:
        within = {x for border in one.borders for x in NEAR if border.where.contains(x)}
        assert within <= changing
        assert {rates_hz[x] for x in within} == {rates_hz[x] for x in changing} or len(one.borders) == 4
        return
    assert isinstance(one.value, float)
    above = sorted(x for x in changing if x > one.value)
    below = sorted((x for x in changing if x < one.value), reverse=True)
    nearest = [side[0] for side in (below, above) if side]
    assert len(one.borders) == len(nearest)
    for border, x in zip(one.borders, nearest, strict=True):
        assert not border.is_lasting
        assert border.where.contains(x)
        assert border.request.rate.hz == rates_hz[x]
        between = [other for other in NEAR if min(one.value, x) < other < max(one.value, x)]
        assert not any(border.where.contains(other) for other in between)


def borders(explanation: RateExplanation, signal: Signal) -> list[tuple[str, str, bool]]:
    (found,) = (one for one in explanation.values if one.signal == signal)
    return [(region_text(one.where), str(one.request.rate), one.is_lasting) for one in found.borders]


@pytest.mark.parametrize(
    ("changed", "rate", "signal", "found"),
    [
        # Not yet low: it would have to last.
        ({}, "10 Hz", LEVEL, [("< 20", "2 Hz", True)]),
        # Low, but not for long enough: time alone changes the rate.
        ({LEVEL: 18.0, LOW_HELD: 3.2}, "10 Hz", LOW_HELD, [(">= 5", "2 Hz", False)]),
        ({LEVEL: 18.0, LOW_HELD: 3.2}, "10 Hz", LEVEL, []),
        ({LEVEL: 18.0, LOW_HELD: 7.0}, "2 Hz", LEVEL, [(">= 20", "10 Hz", False)]),
        ({LEVEL: 18.0, LOW_HELD: 7.0}, "2 Hz", LOW_HELD, []),
        # What an Until remembers, and a Within that still counts.
        ({X: 1.5, TURN_SEEN: 0.0, Y: 1.0, Y_LOST: 0.0}, "10 Hz", X, [("> 2", "30 Hz", False)]),
        ({X: 1.5, TURN_SEEN: 1.0, Y: 1.0, Y_LOST: 0.0}, "30 Hz", X, [("< 1", "10 Hz", False)]),
        ({X: 1.5, TURN_SEEN: 1.0, Y: 1.0, Y_LOST: 0.0}, "30 Hz", Y, [("<= 0", "10 Hz", True)]),
        ({X: 1.5, TURN_SEEN: 1.0, Y: -1.0, Y_LOST: 2.0}, "30 Hz", Y_LOST, [(">= 3", "10 Hz", False)]),
    ],
)
def test_time_and_memory_are_part_of_what_would_change_a_rate(
    changed: dict[Signal, float], rate: str, signal: Signal, found: list[tuple[str, str, bool]]
) -> None:
    explanation = explain(compiled(parse(TIMED, "rules.adirf").file), "/a", {**CALM, **changed})
    assert str(explanation.request.rate) == rate
    assert borders(explanation, signal) == found
    assert TURN_SEEN not in {one.signal for one in explanation.values}


def test_a_field_called_as_our_own_signals_is_a_value_like_any_other() -> None:
    condition = "CheckValue /b held_s > 3 OR CheckValue /b last_seen > 3"
    text = f"begin SetFrequency /a 1 If ({condition}) Then SetFrequency /a 2 end"
    explanation = explain(
        compiled(parse(text, "rules.adirf").file),
        "/a",
        {Signal("/b", "held_s"): 5.0, Signal("/b", "last_seen"): 1.0},
    )
    assert borders(explanation, Signal("/b", "held_s")) == [("<= 3", "1 Hz", False)]
    assert {one.signal.property for one in explanation.values} == {"held_s", "last_seen"}


def test_of_a_decision_the_borders_are_those_of_its_own_rule() -> None:
    rules = compiled(parse(TIMED, "rules.adirf").file)
    found = explain_block(rules, "Low", 3, {LEVEL: 18.0})
    (level,) = (one for one in found if one.signal == LEVEL)
    assert [(region_text(one.where), one.request.rate == Rate.off()) for one in level.borders] == [
        (">= 20", True)
    ]
    assert explain_block(rules, "Low", 4, {}) == ()
