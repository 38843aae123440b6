# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The syntax tree of a rule file, with the comments and blank lines in it.

Fields that hold comments and blank lines do not count when trees are compared.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import Enum
from itertools import chain

from smarttestudo.domain.finding import Span
from smarttestudo.domain.rate import Rate, Tier

COMMENT_START = "//"
_DECORATION = "/-=*#_~ \t"


@dataclass(frozen=True, slots=True, kw_only=True)
class Comment:
    """One comment; ``text`` starts with ``//`` and ends before the blanks at the line's end.

    ``own_line`` is whether nothing stands before it on its line, ``blank_above`` whether the file has an
    empty line between it and what is above.
    """

    text: str
    span: Span
    own_line: bool
    blank_above: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Trivia:
    """The comments of a statement, condition or keyword, and whether an empty line stands before it.

    ``above`` stands on lines of its own before it, ``beside`` at the end of its last line; ``blank_above``
    is an empty line between ``above`` and it.
    """

    above: tuple[Comment, ...] = ()
    beside: Comment | None = None
    blank_above: bool = False


NO_TRIVIA = Trivia()


def label_in(comments: Sequence[Comment]) -> str | None:
    """The words of the last comment that has any; a ruler such as ``// -----`` has none."""
    for comment in reversed(comments):
        words = comment.text.strip(_DECORATION)
        if words:
            return words
    return None


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
    """A topic as the file writes it, not yet resolved, or a pattern of topics."""

    text: str
    span: Span

    @property
    def is_pattern(self) -> bool:
        """Whether it stands for all topics of a kind, as ``/camera/*``."""
        return "*" in self.text


@dataclass(frozen=True, slots=True, kw_only=True)
class Constant:
    """A constant of a message type: ``NAME``, or ``TYPE.NAME`` with the type's name as written."""

    type_name: str
    name: str

    def __str__(self) -> str:
        """As a rule file writes it."""
        return f"{self.type_name}.{self.name}" if self.type_name else self.name


Compared = float | bool | str | Constant
"""The right side of a comparison: a number, true or false, a text, or a constant."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RateExpression:
    """A written rate: a number in Hz, a tier, or a word. ``text`` is the spelling of a number, else empty.

    ``has_unit`` is whether ``Hz`` is written behind the number.
    """

    value: float | Tier | RateWord
    text: str
    span: Span
    has_unit: bool = False

    @property
    def rate(self) -> Rate | None:
        """The rate as written, ``None`` for a tier."""
        if isinstance(self.value, Tier):
            return None
        if isinstance(self.value, RateWord):
            return Rate.full() if self.value is RateWord.FULL else Rate.off()
        return Rate(self.value)


def _height(rate: RateExpression) -> float:
    """Ranks rates, or levels, among each other."""
    if isinstance(rate.value, Tier):
        return rate.value.level
    return math.inf if rate.value is RateWord.FULL else rate.rate.hz if rate.rate else 0.0


class TimeWord(Enum):
    """How a condition is taken over the time before; the value is its spelling."""

    FOR = "For"
    """At every instant of it."""
    WITHIN = "Within"
    """At some instant of it."""


class DurationUnit(Enum):
    """A unit of time; the value is its spelling."""

    MILLISECONDS = "ms"
    SECONDS = "s"
    MINUTES = "min"


@dataclass(frozen=True, slots=True, kw_only=True)
class Duration:
    """A number of a unit; ``text`` is the number as written, ``ns`` the nanoseconds nearest to it."""

    text: str
    unit: DurationUnit
    ns: int = field(compare=False)
    span: Span


@dataclass(frozen=True, slots=True, kw_only=True)
class Until:
    """``Until op VALUE`` behind a check; ``text`` is the value as written."""

    operator: Operator
    value: Compared
    text: str
    span: Span


@dataclass(frozen=True, slots=True, kw_only=True)
class Check:
    """``CheckValue TOPIC PROPERTY op VALUE [Until op VALUE]``; ``text`` is the value as written.

    ``span`` is that of all of it.
    """

    topic: TopicName
    property: str
    property_span: Span
    operator: Operator
    value: Compared
    text: str
    span: Span
    until: Until | None = None
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


@dataclass(frozen=True, slots=True, kw_only=True)
class Timed:
    """``condition For DURATION`` or ``condition Within DURATION``.

    Its comments are those of the check or the parentheses in it.
    """

    operand: Condition
    word: TimeWord
    duration: Duration
    span: Span


Condition = Check | Not | And | Or | Group | Timed


@dataclass(frozen=True, slots=True, kw_only=True)
class Margin:
    """``.. rate By TOPIC PROPERTY NUMBER .. NUMBER`` behind a rate.

    The rate goes from the one before it to ``to`` as the property goes from ``from_value`` to ``to_value``;
    the texts are these two as written. ``span`` begins at ``..``.
    """

    to: RateExpression
    topic: TopicName
    property: str
    property_span: Span
    from_value: float
    from_text: str
    to_value: float
    to_text: str
    span: Span


@dataclass(frozen=True, slots=True, kw_only=True)
class SetFrequency:
    """``SetFrequency TOPIC rate``, as a default or inside a block; with a ``margin``, ``rate`` is one end."""

    topic: TopicName
    rate: RateExpression
    span: Span
    margin: Margin | None = None
    trivia: Trivia = field(default=NO_TRIVIA, compare=False, repr=False)

    @property
    def ends(self) -> tuple[RateExpression, ...]:
        """The rates between which it goes, in their order; without a margin the one."""
        return (self.rate,) if self.margin is None else (self.rate, self.margin.to)

    @property
    def highest(self) -> RateExpression:
        """The higher of its ends."""
        return max(self.ends, key=_height)


@dataclass(frozen=True, slots=True, kw_only=True)
class KeepAtLeast:
    """``KeepAtLeast TOPIC NUMBER``: a floor in Hz."""

    topic: TopicName
    rate: RateExpression
    span: Span
    trivia: Trivia = field(default=NO_TRIVIA, compare=False, repr=False)


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordIncident:
    """``Record "name" {TOPIC} Before DURATION After DURATION``; no topics: all that the rules name."""

    name: str
    topics: tuple[TopicName, ...]
    before: Duration
    after: Duration
    span: Span
    trivia: Trivia = field(default=NO_TRIVIA, compare=False, repr=False)


@dataclass(frozen=True, slots=True, kw_only=True)
class KeepWithin:
    """``KeepWithin TOPIC PROPERTY bound``: how far off the receiver's picture of a property may be.

    ``bound`` is a number in the unit of the property, or a tier; ``text`` is the number as written. Outside a
    block it always holds.
    """

    topic: TopicName
    property: str
    property_span: Span
    bound: float | Tier
    text: str
    span: Span
    trivia: Trivia = field(default=NO_TRIVIA, compare=False, repr=False)


@dataclass(frozen=True, slots=True, kw_only=True)
class SetParameter:
    """``SetParameter NODE PARAMETER value``; ``text`` is the value as written: 40 is no 40.0 to a node."""

    node: TopicName
    parameter: str
    parameter_span: Span
    value: float | bool | str
    text: str
    span: Span
    trivia: Trivia = field(default=NO_TRIVIA, compare=False, repr=False)


@dataclass(frozen=True, slots=True, kw_only=True)
class CallService:
    """``Call SERVICE [true | false]``; ``argument`` is ``None`` where none is written."""

    service: TopicName
    argument: bool | None
    span: Span
    trivia: Trivia = field(default=NO_TRIVIA, compare=False, repr=False)


@dataclass(frozen=True, slots=True, kw_only=True)
class Notify:
    """``Notify "text"``."""

    text: str
    span: Span
    trivia: Trivia = field(default=NO_TRIVIA, compare=False, repr=False)


Act = SetParameter | CallService | Notify
"""What a block does beside relaying and recording."""

Action = SetFrequency | KeepWithin | RecordIncident | Act
"""A statement in a Then or Else."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Block:
    """``[Disabled] [Rule "name" [Priority n]] If … Then … [Else …] [EndIf]``.

    A block that ``is_disabled`` is kept and shown, its names are checked, and nothing else comes of it.
    ``name`` is ``None`` where none is written; ``label`` is what people call the block: its name, else its
    nearest own comment, else ``block at line N``. ``trivia`` is that of its first line, be it ``Rule`` or
    ``If``; ``if_trivia`` that of an ``If`` below a ``Rule``.
    """

    name: str | None
    priority: int | None
    label: str
    condition: Condition
    then: tuple[Action, ...]
    otherwise: tuple[Action, ...]
    has_end_if: bool
    span: Span
    is_disabled: bool = False
    trivia: Trivia = field(default=NO_TRIVIA, compare=False, repr=False)
    if_trivia: Trivia = field(default=NO_TRIVIA, compare=False, repr=False)
    then_trivia: Trivia = field(default=NO_TRIVIA, compare=False, repr=False)
    else_trivia: Trivia = field(default=NO_TRIVIA, compare=False, repr=False)
    end_if_trivia: Trivia = field(default=NO_TRIVIA, compare=False, repr=False)

    @property
    def is_unnamed(self) -> bool:
        """Whether only its line tells it from others."""
        return self.name is None and self.label == unnamed_label(self.span.line)


def unnamed_label(line: int) -> str:
    """The label of a block at ``line`` that has neither name nor comment."""
    return f"block at line {line}"


Statement = SetFrequency | KeepAtLeast | KeepWithin | Block


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
        return tuple(chain.from_iterable(part.statements for part in self.collections))

    @property
    def enabled_statements(self) -> tuple[Statement, ...]:
        """The statements that count: all but disabled blocks."""
        return tuple(
            statement
            for statement in self.statements
            if not (isinstance(statement, Block) and statement.is_disabled)
        )
