# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The syntax tree of a rule file.

Fields that hold comments and blank lines do not count when trees are compared.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from enum import Enum

from smarttestudo.adirf.comments import NO_TRIVIA, Comment, Trivia
from smarttestudo.domain.rate import Tier
from smarttestudo.domain.source import Span


class Operator(Enum):
    """A comparison; the value is its spelling."""

    GREATER = ">"
    LESS = "<"
    GREATER_EQUAL = ">="
    LESS_EQUAL = "<="
    EQUAL = "="
    NOT_EQUAL = "!="


class RateWord(Enum):
    """A rate written as a word."""

    FULL = "Full"
    OFF = "Off"


@dataclass(frozen=True, slots=True, kw_only=True)
class TopicName:
    """A topic as the file writes it, not yet resolved."""

    text: str
    span: Span


@dataclass(frozen=True, slots=True, kw_only=True)
class RateExpression:
    """A written rate: a number in Hz, a tier, or a word. ``text`` is the spelling of a number, else empty.

    ``has_unit`` is whether ``Hz`` is written behind the number.
    """

    value: float | Tier | RateWord
    text: str
    span: Span
    has_unit: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Check:
    """``CheckValue TOPIC PROPERTY op NUMBER``; ``text`` is the number as written."""

    topic: TopicName
    property: str
    property_span: Span
    operator: Operator
    value: float
    text: str
    span: Span
    trivia: Trivia = field(default=NO_TRIVIA, compare=False, repr=False)


@dataclass(frozen=True, slots=True, kw_only=True)
class Not:
    """``Not condition``."""

    operand: Condition
    span: Span
    trivia: Trivia = field(default=NO_TRIVIA, compare=False, repr=False)


@dataclass(frozen=True, slots=True, kw_only=True)
class And:
    """Two or more conditions joined by ``AND``."""

    operands: tuple[Condition, ...]
    span: Span


@dataclass(frozen=True, slots=True, kw_only=True)
class Or:
    """Two or more conditions joined by ``OR``."""

    operands: tuple[Condition, ...]
    span: Span


@dataclass(frozen=True, slots=True, kw_only=True)
class Group:
    """A condition in written parentheses; ``closing`` are the comments before its ``)``."""

    operand: Condition
    span: Span
    trivia: Trivia = field(default=NO_TRIVIA, compare=False, repr=False)
    closing: tuple[Comment, ...] = field(default=(), compare=False, repr=False)


Condition = Check | Not | And | Or | Group


@dataclass(frozen=True, slots=True, kw_only=True)
class SetFrequency:
    """``SetFrequency TOPIC rate``, as a default or inside a block."""

    topic: TopicName
    rate: RateExpression
    span: Span
    trivia: Trivia = field(default=NO_TRIVIA, compare=False, repr=False)


@dataclass(frozen=True, slots=True, kw_only=True)
class KeepAtLeast:
    """``KeepAtLeast TOPIC NUMBER``: a floor in Hz."""

    topic: TopicName
    rate: RateExpression
    span: Span
    trivia: Trivia = field(default=NO_TRIVIA, compare=False, repr=False)


@dataclass(frozen=True, slots=True, kw_only=True)
class Block:
    """``[Rule "name" [Priority n]] If … Then … [Else …] [EndIf]``.

    ``name`` is ``None`` where none is written; ``label`` is what people call the block: its name, else its
    nearest own comment, else ``block at line N``. ``trivia`` is that of its first line, be it ``Rule`` or
    ``If``; ``if_trivia`` that of an ``If`` below a ``Rule``.
    """

    name: str | None
    priority: int | None
    label: str
    condition: Condition
    then: tuple[SetFrequency, ...]
    otherwise: tuple[SetFrequency, ...]
    has_end_if: bool
    span: Span
    trivia: Trivia = field(default=NO_TRIVIA, compare=False, repr=False)
    if_trivia: Trivia = field(default=NO_TRIVIA, compare=False, repr=False)
    then_trivia: Trivia = field(default=NO_TRIVIA, compare=False, repr=False)
    else_trivia: Trivia = field(default=NO_TRIVIA, compare=False, repr=False)
    end_if_trivia: Trivia = field(default=NO_TRIVIA, compare=False, repr=False)


Statement = SetFrequency | KeepAtLeast | Block


@dataclass(frozen=True, slots=True, kw_only=True)
class Collection:
    """``begin … end``; ``trivia`` is that of ``begin``. The comments above ``end`` are in ``end_trivia``."""

    statements: tuple[Statement, ...]
    span: Span
    trivia: Trivia = field(default=NO_TRIVIA, compare=False, repr=False)
    end_trivia: Trivia = field(default=NO_TRIVIA, compare=False, repr=False)


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleFile:
    """One parsed file; ``path`` is how the user named it, ``footer`` the comments after the last ``end``.

    ``glued`` are the words that follow a keyword without a blank between.
    """

    path: str
    collections: tuple[Collection, ...]
    footer: tuple[Comment, ...] = field(default=(), compare=False, repr=False)
    glued: tuple[Span, ...] = field(default=(), compare=False, repr=False)

    @property
    def statements(self) -> tuple[Statement, ...]:
        """The statements of all collections, in the order of the file."""
        return tuple(statement for part in self.collections for statement in part.statements)


def checks_in(condition: Condition) -> Iterator[Check]:
    """The checks of a condition, in their order."""
    match condition:
        case Check():
            yield condition
        case Group() | Not():
            yield from checks_in(condition.operand)
        case And() | Or():
            for operand in condition.operands:
                yield from checks_in(operand)
