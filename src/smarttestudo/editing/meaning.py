# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The meaning of a statement, without its layout."""

from __future__ import annotations

from smarttestudo.language.syntax import (
    Action,
    And,
    Block,
    Check,
    Condition,
    Group,
    KeepAtLeast,
    KeepWithin,
    Not,
    Or,
    RecordIncident,
    SetFrequency,
    Statement,
    Timed,
)

Meaning = tuple[object, ...]
"""Nested tuples; two statements mean the same when these are equal."""


def meaning(statement: Statement | Action) -> Meaning:
    """Words and numbers of a statement: no places, comments, spellings or parentheses."""
    match statement:
        case Block():
            return (
                statement.name,
                statement.priority or 0,
                statement.is_disabled,
                condition_meaning(statement.condition),
                tuple(map(meaning, statement.then)),
                tuple(map(meaning, statement.otherwise)),
            )
        case RecordIncident():
            topics = tuple(topic.text for topic in statement.topics)
            return ("record", statement.name, topics, statement.before.ns, statement.after.ns)
        case KeepAtLeast():
            return ("keep", statement.topic.text, statement.rate.value)
        case KeepWithin():
            return ("within", statement.topic.text, statement.property, statement.bound)
        case SetFrequency():
            return ("set", statement.topic.text, statement.rate.value)


def condition_meaning(condition: Condition) -> Meaning:
    """The checks of a condition and how they are joined."""
    match condition:
        case Check():
            until = condition.until and (condition.until.operator, condition.until.value)
            return (condition.topic.text, condition.property, condition.operator, condition.value, until)
        case Group():
            return condition_meaning(condition.operand)
        case Not():
            return (Not, condition_meaning(condition.operand))
        case Timed():
            return (condition.word, condition.duration.ns, condition_meaning(condition.operand))
        case And() | Or():
            return (type(condition), *map(condition_meaning, condition.operands))
