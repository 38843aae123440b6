# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Random rule files as syntax trees, dense in ties, borders and nesting."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

from hypothesis import strategies as st

from smarttestudo.domain.finding import Span
from smarttestudo.domain.signal import Signal
from smarttestudo.language.syntax import (
    And,
    Block,
    Check,
    Collection,
    Compared,
    Condition,
    Group,
    KeepAtLeast,
    Not,
    Operator,
    Or,
    RateExpression,
    RateWord,
    RuleFile,
    SetFrequency,
    Statement,
    TopicName,
)

SPAN = Span(line=1, column=1, end_line=1, end_column=2)
RELAYED = ("/a", "/b", "/c")


def topic(name: str) -> TopicName:
    return TopicName(text=name, span=SPAN)


def rate(value: float | RateWord) -> RateExpression:
    return RateExpression(value=value, text="", span=SPAN)


def set_frequency(name: str, value: float | RateWord) -> SetFrequency:
    return SetFrequency(topic=topic(name), rate=rate(value), span=SPAN)


def keep_at_least(name: str, floor_hz: float) -> KeepAtLeast:
    return KeepAtLeast(topic=topic(name), rate=rate(floor_hz), span=SPAN)


def check(signal: Signal, operator: Operator, value: Compared) -> Check:
    return Check(
        topic=topic(signal.topic),
        property=signal.property,
        property_span=SPAN,
        operator=operator,
        value=value,
        text=str(value),
        span=SPAN,
    )


def block(
    condition: Condition,
    then: Sequence[SetFrequency],
    otherwise: Sequence[SetFrequency] = (),
    *,
    label: str = "a block",
    priority: int | None = None,
    line: int = 1,
) -> Block:
    return Block(
        name=label,
        priority=priority,
        label=label,
        condition=condition,
        then=tuple(then),
        otherwise=tuple(otherwise),
        has_end_if=True,
        span=SPAN._replace(line=line, end_line=line),
    )


def rule_file(statements: Sequence[Statement], path: str = "rules.adirf") -> RuleFile:
    return RuleFile(path=path, collections=(Collection(statements=tuple(statements), span=SPAN),))


rates = st.one_of(st.sampled_from([0.0, 1.0, 2.0, 3.0, 5.0]), st.sampled_from(RateWord))


@cache
def conditions(
    signals: Sequence[Signal], borders: Sequence[float], words: Sequence[Compared] = ()
) -> st.SearchStrategy[Condition]:
    """Conditions over ``signals`` with borders among a few numbers, or with ``words``, nested at random."""
    checks = st.builds(check, st.sampled_from(signals), st.sampled_from(Operator), st.sampled_from(borders))
    if words:
        equality = st.sampled_from([Operator.EQUAL, Operator.NOT_EQUAL])
        checks |= st.builds(check, st.sampled_from(signals), equality, st.sampled_from(words))

    def nested(inner: st.SearchStrategy[Condition]) -> st.SearchStrategy[Condition]:
        several = st.lists(inner, min_size=2, max_size=4).map(tuple)
        return st.one_of(
            st.builds(And, operands=several, span=st.just(SPAN)),
            st.builds(Or, operands=several, span=st.just(SPAN)),
            st.builds(Not, operand=inner, span=st.just(SPAN)),
            st.builds(Group, operand=inner, span=st.just(SPAN)),
        )

    return st.recursive(checks, nested, max_leaves=8)


@cache
def settings_of_topics(*, at_least: int) -> st.SearchStrategy[tuple[SetFrequency, ...]]:
    return st.dictionaries(st.sampled_from(RELAYED), rates, min_size=at_least, max_size=3).map(
        lambda chosen: tuple(set_frequency(name, value) for name, value in chosen.items())
    )


floors = st.dictionaries(st.sampled_from(RELAYED), st.sampled_from([0.0, 2.0, 4.0]), max_size=2)
priorities = st.sampled_from([None, -1, 0, 1])


@cache
@st.composite
def rule_files(
    draw: st.DrawFn,
    signals: Sequence[Signal],
    borders: Sequence[float],
    max_blocks: int = 8,
    words: Sequence[Compared] = (),
) -> list[RuleFile]:
    """One or two files of defaults, floors and blocks with Else and priorities."""
    conditional = conditions(signals, borders, words)
    statements: list[Statement] = [
        *draw(settings_of_topics(at_least=0)),
        *(keep_at_least(name, floor_hz) for name, floor_hz in draw(floors).items()),
        *(
            block(
                draw(conditional),
                draw(settings_of_topics(at_least=1)),
                draw(settings_of_topics(at_least=0)),
                label=f"block {number}",
                priority=draw(priorities),
                line=number + 1,
            )
            for number in range(draw(st.integers(1, max_blocks)))
        ),
    ]
    cut = draw(st.integers(0, len(statements)))
    return [rule_file(statements[:cut], "first.adirf"), rule_file(statements[cut:], "second.adirf")]
