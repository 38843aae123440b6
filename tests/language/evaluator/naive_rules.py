# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A second opinion on what rules mean: plain recursion over the syntax tree, everything anew each time."""

from __future__ import annotations

import math
import operator
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from smarttestudo.domain.signal import Signal, SignalKind, Value
from smarttestudo.domain.signal import Values as SignalValues
from smarttestudo.domain.type_definition import TypeDefinition
from smarttestudo.language.known_types import KnownTypes
from smarttestudo.language.syntax import (
    And,
    Block,
    Check,
    Compared,
    Condition,
    Constant,
    Group,
    KeepAtLeast,
    Not,
    Operator,
    Or,
    RateExpression,
    RateWord,
    RuleFile,
    SetFrequency,
    Timed,
)
from smarttestudo.language.syntax_walks import (
    sets_in,
)

Values = Mapping[Signal, SignalValues | None]
"""A missing signal, ``None`` and NaN are unknown; of all elements there are several values."""

CONSTANTS: Mapping[str, Value] = {"ONE": 1.0, "DOCK": "dock"}
"""Those of the type of ``/p``; all others are of no known type."""
TYPES = KnownTypes(
    topics={"/p": "own/msg/Own"}, definitions={"own/msg/Own": TypeDefinition(constants=CONSTANTS)}
)

COMPARISONS = {
    Operator.GREATER: operator.gt,
    Operator.LESS: operator.lt,
    Operator.GREATER_EQUAL: operator.ge,
    Operator.LESS_EQUAL: operator.le,
    Operator.EQUAL: operator.eq,
    Operator.NOT_EQUAL: operator.ne,
}


def naive_truth(condition: Condition, values: Values) -> bool | None:
    """True, false, or ``None`` for unknown, of a condition without time (see ``naive_time``)."""
    match condition:
        case Timed():
            raise TypeError(condition)
        case Check():
            value = values.get(naive_signal(condition))
            if isinstance(value, tuple):
                return any(naive_holds(condition, each) for each in value)
            if value is None or (isinstance(value, float) and math.isnan(value)):
                return None
            return naive_holds(condition, value)
        case Group():
            return naive_truth(condition.operand, values)
        case Not():
            inner = naive_truth(condition.operand, values)
            return None if inner is None else not inner
        case And():
            parts = [naive_truth(part, values) for part in condition.operands]
            return False if False in parts else None if None in parts else True
        case Or():
            parts = [naive_truth(part, values) for part in condition.operands]
            return True if True in parts else None if None in parts else False


def naive_compared(one: Check) -> Compared | None:
    """What a check compares with; ``None`` for a constant that nobody knows."""
    if not isinstance(one.value, Constant):
        return one.value
    return CONSTANTS.get(one.value.name) if one.topic.text == "/p" else None


def naive_holds(one: Check, value: Value) -> bool:
    """Whether a comparison holds for a value of its sort."""
    compared: Any = naive_compared(one)
    return bool(COMPARISONS[one.operator](value, compared))


def naive_signal(one: Check) -> Signal:
    topic, compared = one.topic.text, naive_compared(one)
    if compared is None:
        return Signal(topic, f"{one.property} {one.value}", SignalKind.UNRESOLVED)
    if isinstance(compared, str):
        return Signal(topic, one.property, SignalKind.TEXT)
    is_word = isinstance(one.value, bool | Constant)
    return Signal(topic, one.property, SignalKind.STATE if is_word else SignalKind.NUMBER)


def naive_checks(condition: Condition) -> Iterator[Check]:
    match condition:
        case Check():
            yield condition
        case Group() | Not() | Timed():
            yield from naive_checks(condition.operand)
        case And() | Or():
            for part in condition.operands:
                yield from naive_checks(part)


def naive_shown(condition: Condition, signal: Signal, value: SignalValues | None) -> Value | None:
    """The value that a decision shows: of several the first that is compared with, else the first."""
    if not isinstance(value, tuple):
        return value
    checks = [one for one in naive_checks(condition) if naive_signal(one) == signal]
    return next((each for each in value if any(naive_holds(one, each) for one in checks)), [*value, None][0])


def naive_signals(condition: Condition) -> set[Signal]:
    match condition:
        case Check():
            return {naive_signal(condition)}
        case Group() | Not() | Timed():
            return naive_signals(condition.operand)
        case And() | Or():
            return {signal for part in condition.operands for signal in naive_signals(part)}


@dataclass(frozen=True, slots=True, kw_only=True)
class NaiveRequest:
    """``hz`` is infinite for Full; ``off`` tells a written Off from a plain 0."""

    hz: float
    off: bool
    reason: str
    rule: str | None
    place: int | None
    """The deciding block's place among all blocks, Else counted."""

    @property
    def height(self) -> tuple[float, bool]:
        return self.hz, not self.off


@dataclass(frozen=True, slots=True, kw_only=True)
class NaiveBlock:
    place: int
    label: str
    priority: int
    condition: Condition
    negated: bool
    rates: Mapping[str, tuple[float, bool]]

    def truth(self, values: Values) -> bool | None:
        inner = naive_truth(self.condition, values)
        return inner if inner is None else inner != self.negated


def naive_height(rate: RateExpression) -> tuple[float, bool]:
    if rate.value is RateWord.FULL:
        return math.inf, True
    if rate.value is RateWord.OFF:
        return 0.0, False
    assert isinstance(rate.value, int | float)
    return float(rate.value), True


def naive_blocks(files: Sequence[RuleFile]) -> list[NaiveBlock]:
    def sides() -> Iterator[tuple[Block, str, bool, tuple[SetFrequency, ...]]]:
        for file in files:
            for block in (one for one in file.statements if isinstance(one, Block)):
                yield block, block.label, False, sets_in(block.then)
                if block.otherwise:
                    yield block, f"{block.label} (Else)", True, sets_in(block.otherwise)

    return [
        NaiveBlock(
            place=place,
            label=label,
            priority=block.priority or 0,
            condition=block.condition,
            negated=negated,
            rates={one.topic.text: naive_height(one.rate) for one in statements},
        )
        for place, (block, label, negated, statements) in enumerate(sides())
    ]


def naive_request(files: Sequence[RuleFile], topic: str, values: Values) -> NaiveRequest:
    """Rules 3 to 6, read aloud."""
    statements = [statement for file in files for statement in file.statements]
    blocks = [block for block in naive_blocks(files) if topic in block.rates]
    true = [block for block in blocks if block.truth(values) is True]
    unknown = [block for block in blocks if block.truth(values) is None]

    height, reason, decider = (math.inf, True), "default", None
    for one in statements:
        if isinstance(one, SetFrequency) and one.topic.text == topic:
            height = naive_height(one.rate)
    if true:
        highest = max(block.priority for block in true)
        height = max(block.rates[topic] for block in true if block.priority == highest)
        decider = next(b for b in true if b.priority == highest and b.rates[topic] == height)
        reason = "block"
    feared = [b for b in unknown if decider is None or b.priority >= decider.priority]
    if feared and (most := max(block.rates[topic] for block in feared)) > height:
        height, reason = most, "unknown"
        decider = next(block for block in feared if block.rates[topic] == most)
    floors = [
        naive_height(one.rate)[0]
        for one in statements
        if isinstance(one, KeepAtLeast) and one.topic.text == topic
    ]
    if floors and height != (0.0, False) and height[0] < max(floors):
        height, reason = (max(floors), True), "floor"
    return NaiveRequest(
        hz=height[0],
        off=not height[1],
        reason=reason,
        rule=decider.label if decider else None,
        place=decider.place if decider else None,
    )
