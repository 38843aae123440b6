# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a step evaluates does not depend on how many rules with time there are."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from language.evaluator.naive_time import duration
from language.evaluator.random_rules import SPAN, block, check, rule_file, set_frequency
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.signal import Signal
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.language.rule_set import compile_rules
from smarttestudo.language.syntax import (
    And,
    Check,
    Condition,
    Operator,
    Statement,
    Timed,
    TimeWord,
    Until,
)
from smarttestudo.loop import RelayLoop
from smarttestudo.loop.inputs import MessageInput, WakeInput

X = Signal("/odom", "x")
METRES = 8
"""The robot drives so far, and crosses a border each metre."""


def timed(number: int) -> Condition:
    """A zone of one metre with a For, a Within or an Until, by turns."""
    begin = check(X, Operator.GREATER, float(number))
    zone = And(operands=(begin, check(X, Operator.LESS, number + 1.0)), span=SPAN)
    if number % 3 == 2:
        return _until(begin, number + 1.5)
    word = TimeWord.FOR if number % 3 else TimeWord.WITHIN
    return Timed(operand=zone, word=word, duration=duration(NS_PER_S // 5), span=SPAN)


def _until(begin: Check, end: float) -> Check:
    until = Until(operator=Operator.GREATER, value=end, text=str(end), span=SPAN)
    return Check(
        topic=begin.topic,
        property=begin.property,
        property_span=SPAN,
        operator=begin.operator,
        value=begin.value,
        text=begin.text,
        span=SPAN,
        until=until,
    )


def evaluated(rules: int) -> list[int]:
    """How much each step of a drive looks at, alarms included, once all rules know their first past."""
    statements: list[Statement] = [
        set_frequency("/a", 1.0),
        *(
            # An Until whose thresholds were not seen yet is unknown, and must not decide for all others.
            block(timed(number), [set_frequency("/a", 2.0 + number % 5)], priority=int(number % 3 < 2))
            for number in range(rules)
        ),
    ]
    rule_set = compile_rules([rule_file(statements)], lambda name: name)
    loop = RelayLoop(rule_set, Profile(settle_s=0.0), 0)
    evaluator, counts = loop.knowledge.evaluator, []
    loop.handle(MessageInput(0, X.topic, b"", 0, SimpleNamespace(x=0.5)))
    while (wake_ns := loop.next_wake_ns) is not None and wake_ns <= NS_PER_S // 2:
        loop.handle(WakeInput(stamp_ns=wake_ns))
    touched = evaluator.touched
    for metre in range(1, METRES):
        at_ns = metre * NS_PER_S
        while (wake_ns := loop.next_wake_ns) is not None and wake_ns < at_ns:
            loop.handle(WakeInput(stamp_ns=wake_ns))
            counts.append(evaluator.touched - touched)
            touched = evaluator.touched
        loop.handle(MessageInput(at_ns, X.topic, b"", 0, SimpleNamespace(x=metre + 0.5)))
        counts.append(evaluator.touched - touched)
        touched = evaluator.touched
    assert len(loop.take_decisions()) > METRES
    return counts


@pytest.mark.full
def test_a_step_evaluates_as_much_beside_ten_thousand_timed_rules_as_beside_twelve() -> None:
    assert evaluated(10_000) == evaluated(12)
