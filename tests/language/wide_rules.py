# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rule files with all that stands for more than numbers and names: texts, patterns, margins, actions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from random import Random

from hypothesis import strategies as st

from language.rule_strategies import NOWHERE, NUMBER_TEXTS, TOPICS, rule_files
from smarttestudo.domain.rate import Tier
from smarttestudo.language.syntax import (
    Action,
    And,
    Block,
    CallService,
    Check,
    Compared,
    Condition,
    Constant,
    Group,
    KeepAtLeast,
    KeepWithin,
    Margin,
    Not,
    Notify,
    Operator,
    Or,
    RateExpression,
    RateWord,
    RuleFile,
    SetFrequency,
    SetParameter,
    Statement,
    Timed,
    TopicName,
)

PATTERNS = ("/camera/*", "/**", "/*/scan", "/**/status", "robot/*/imu", "/*")
SOURCES = ("@machine", "@link")
ELEMENTS = ('status["lidar front"].level', "status[*].level", "a[-1]", r'a["\"x\\"].b["]"]', "[0]")[:-1]
WORDS: tuple[tuple[str, Compared], ...] = (
    ('"docking"', "docking"),
    (r'"a \"b\" \\ //c"', r'a "b" \ //c'),
    ('""', ""),
    ("true", True),
    ("false", False),
)
CONSTANTS: tuple[tuple[str, Compared], ...] = (
    ("ERROR", Constant(type_name="", name="ERROR")),
    ("DiagnosticStatus.ERROR", Constant(type_name="DiagnosticStatus", name="ERROR")),
    ("sensor_msgs/msg/BatteryState.OK_2", Constant(type_name="sensor_msgs/msg/BatteryState", name="OK_2")),
)
EQUALITIES = (Operator.EQUAL, Operator.NOT_EQUAL)


@cache
@st.composite
def wide_rule_files(draw: st.DrawFn, *, max_statements: int = 5) -> RuleFile:
    """A syntax tree that some text parses to, in which some words are of the later forms."""
    tree = draw(rule_files(max_statements=max_statements))
    widen = _Widening(Random(draw(st.integers(0, 2**32))))
    collections = tuple(
        replace(part, statements=tuple(map(widen.statement, part.statements))) for part in tree.collections
    )
    return replace(tree, collections=collections)


class _Widening:
    def __init__(self, random: Random) -> None:
        self._random = random

    def statement(self, statement: Statement) -> Statement:
        match statement:
            case SetFrequency():
                return self._set(statement)
            case KeepAtLeast() | KeepWithin():
                return replace(statement, topic=self._topics(statement.topic))
            case Block():
                return replace(
                    statement,
                    condition=self._condition(statement.condition),
                    then=self._actions(statement.then),
                    otherwise=self._actions(statement.otherwise) if statement.otherwise else (),
                )

    def _is_rare(self) -> bool:
        return self._random.random() < 0.3

    def _topics(self, topic: TopicName) -> TopicName:
        return replace(topic, text=self._random.choice(PATTERNS)) if self._is_rare() else topic

    def _set(self, statement: SetFrequency) -> SetFrequency:
        statement = replace(statement, topic=self._topics(statement.topic))
        if isinstance(statement.rate.value, RateWord) or not self._is_rare():
            return statement
        random = self._random
        first, second = random.sample(NUMBER_TEXTS, 2)
        is_level = isinstance(statement.rate.value, Tier)
        end = random.choice(
            [RateExpression(value=level, text="", span=NOWHERE) for level in Tier]
            if is_level
            else [
                RateExpression(value=20.0, text="20", span=NOWHERE),
                RateExpression(value=2.75, text="2.75", span=NOWHERE, has_unit=True),
            ]
        )
        margin = Margin(
            to=end,
            topic=TopicName(text=random.choice((*TOPICS, *SOURCES)), span=NOWHERE),
            property=random.choice(("distance", "age", "a.b[2]")),
            property_span=NOWHERE,
            from_value=float(first),
            from_text=first,
            to_value=float(second),
            to_text=second,
            span=NOWHERE,
        )
        is_margin = float(first) != float(second) and end.value != statement.rate.value
        return replace(statement, margin=margin) if is_margin else statement

    def _actions(self, actions: Sequence[Action]) -> tuple[Action, ...]:
        widened: list[Action] = []
        for action in actions:
            match action:
                case SetFrequency():
                    widened.append(self._set(action))
                case KeepWithin():
                    widened.append(replace(action, topic=self._topics(action.topic)))
                case _:
                    widened.append(action)
        return (*widened, *(act for act in self._acts() if self._is_rare()))

    def _acts(self) -> Sequence[Action]:
        text, value = self._random.choice((*WORDS, ("40", 40.0), ("-2.50", -2.5)))
        assert not isinstance(value, Constant)
        name = TopicName(text=self._random.choice(TOPICS), span=NOWHERE)
        return (
            SetParameter(
                node=name,
                parameter=self._random.choice(("jpeg_quality", "FollowPath.max_vel-x", "_a")),
                parameter_span=NOWHERE,
                value=value,
                text=text,
                span=NOWHERE,
            ),
            CallService(service=name, argument=self._random.choice((None, True, False)), span=NOWHERE),
            Notify(text='look "here" \\', span=NOWHERE),
        )

    def _condition(self, condition: Condition) -> Condition:
        match condition:
            case Check():
                return self._check(condition)
            case Not() | Group() | Timed():
                return replace(condition, operand=self._condition(condition.operand))
            case And() | Or():
                return replace(condition, operands=tuple(map(self._condition, condition.operands)))

    def _check(self, check: Check) -> Check:
        if self._is_rare():
            topic = replace(check.topic, text=self._random.choice(SOURCES))
            check = replace(check, topic=topic, property=self._random.choice(("cpu", "age")))
        if self._is_rare():
            check = replace(check, property=self._random.choice(ELEMENTS))
        if "[*]" in check.property:
            check = replace(check, until=None)
        if self._is_rare():
            text, value = self._random.choice(CONSTANTS)
            return replace(check, value=value, text=text)
        if not self._is_rare():
            return check
        text, value = self._random.choice(WORDS)
        until = check.until and replace(
            check.until, operator=self._random.choice(EQUALITIES), value=value, text=text
        )
        return replace(check, operator=self._random.choice(EQUALITIES), value=value, text=text, until=until)
