# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Statements, tiers, checks and times found in a syntax tree."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import chain

from smarttestudo.domain.finding import Span
from smarttestudo.domain.names import is_source
from smarttestudo.domain.rate import Tier
from smarttestudo.language.syntax import (
    Act,
    Action,
    And,
    Block,
    Check,
    Condition,
    Group,
    KeepAtLeast,
    KeepWithin,
    Margin,
    Not,
    Or,
    RecordIncident,
    SetFrequency,
    Statement,
    Timed,
    TopicName,
)


def sets_in(actions: Iterable[Action]) -> tuple[SetFrequency, ...]:
    """The rates among ``actions``, in their order."""
    return tuple(action for action in actions if isinstance(action, SetFrequency))


def bounds_in(actions: Iterable[Action]) -> tuple[KeepWithin, ...]:
    """The bounds among ``actions``, in their order."""
    return tuple(action for action in actions if isinstance(action, KeepWithin))


def bound_span(statement: KeepWithin) -> Span:
    """Where the bound of a parsed statement is written: its last word."""
    bound, whole = statement.bound, statement.span
    length = len(bound.value if isinstance(bound, Tier) else statement.text)
    return Span(
        line=whole.end_line,
        column=whole.end_column - length,
        end_line=whole.end_line,
        end_column=whole.end_column,
    )


def records_in(actions: Iterable[Action]) -> tuple[RecordIncident, ...]:
    """The recordings among ``actions``, in their order."""
    return tuple(action for action in actions if isinstance(action, RecordIncident))


def acts_in(actions: Iterable[Action]) -> tuple[Act, ...]:
    """The parameters to set, services to call and notes to send among ``actions``, in their order."""
    return tuple(action for action in actions if isinstance(action, Act))


def tiers_in(statement: Statement) -> Iterator[tuple[Span, Tier]]:
    """The tiers that a statement names, each with its place, in their order."""
    actions = (*statement.then, *statement.otherwise) if isinstance(statement, Block) else (statement,)
    for action in actions:
        match action:
            case SetFrequency():
                yield from ((rate.span, rate.value) for rate in action.ends if isinstance(rate.value, Tier))
            case KeepWithin(bound=Tier() as tier):
                yield bound_span(action), tier
            case _:
                pass


def conditions_in(condition: Condition) -> Iterator[Condition]:
    """``condition`` and every condition inside it, in the order of the text."""
    pending = [condition]
    while pending:
        current = pending.pop()
        yield current
        match current:
            case And() | Or():
                pending.extend(reversed(current.operands))
            case Not() | Group() | Timed():
                pending.append(current.operand)
            case Check():
                pass


def times_in(condition: Condition) -> Iterator[Timed]:
    """The times of a condition, in the order in which they end."""
    match condition:
        case Check():
            return
        case Group() | Not():
            yield from times_in(condition.operand)
        case Timed():
            yield from times_in(condition.operand)
            yield condition
        case And() | Or():
            for operand in condition.operands:
                yield from times_in(operand)


def checks_in(condition: Condition) -> Iterator[Check]:
    """The checks of a condition, in their order."""
    return (part for part in conditions_in(condition) if isinstance(part, Check))


def topic_names_in(statement: Statement) -> Iterator[TopicName]:
    """The topics that a statement names, without patterns, machine and link; of a block its checks first."""
    names: Iterable[TopicName] = _named_by(statement)
    if isinstance(statement, Block):
        names = [check.topic for check in checks_in(statement.condition)]
        for side in (statement.then, statement.otherwise):
            by_kind: Iterable[Action] = (*sets_in(side), *bounds_in(side), *records_in(side))
            names += chain.from_iterable(map(_named_by, side if statement.is_disabled else by_kind))
    return (name for name in names if not (name.is_pattern or is_source(name.text)))


def _named_by(action: Statement | Action) -> tuple[TopicName, ...]:
    match action:
        case SetFrequency(margin=Margin() as margin):
            return action.topic, margin.topic
        case SetFrequency() | KeepAtLeast() | KeepWithin():
            return (action.topic,)
        case RecordIncident():
            return action.topics
        case _:
            return ()
