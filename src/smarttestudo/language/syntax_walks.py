# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Statements, tiers, checks and times found in a syntax tree."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from smarttestudo.domain.finding import Span
from smarttestudo.domain.rate import Tier
from smarttestudo.language.syntax import (
    Act,
    Action,
    And,
    Block,
    Check,
    Condition,
    Group,
    KeepWithin,
    Not,
    Or,
    RecordIncident,
    SetFrequency,
    Statement,
    Timed,
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
