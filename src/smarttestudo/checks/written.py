# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Statements with their place and their full topic names."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from smarttestudo.domain.rate import Rate, Tier
from smarttestudo.domain.signal import Signal, Truth
from smarttestudo.domain.source import Span
from smarttestudo.language.normal_form import Form, LastSeen
from smarttestudo.language.properties import PropertySpec
from smarttestudo.language.syntax import (
    And,
    Block,
    Check,
    Condition,
    Group,
    KeepAtLeast,
    KeepWithin,
    Not,
    Or,
    RateExpression,
    RateWord,
    RecordIncident,
    SetFrequency,
    Timed,
    TopicName,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class WrittenRate:
    """A SetFrequency or KeepAtLeast; ``rate`` is ``None`` for a tier."""

    path: str
    topic: str
    statement: SetFrequency | KeepAtLeast
    rate: Rate | None

    @property
    def span(self) -> Span:
        """The whole statement."""
        return self.statement.span


@dataclass(frozen=True, slots=True, kw_only=True)
class WrittenBound:
    """A KeepWithin; ``branch`` is its block's place and whether in its Else, ``None`` outside blocks."""

    path: str
    topic: str
    statement: KeepWithin
    branch: tuple[int, bool] | None

    @property
    def signal(self) -> Signal:
        """The property that it bounds."""
        return Signal(self.topic, self.statement.property)


@dataclass(frozen=True, slots=True, kw_only=True)
class Mention:
    """A topic's name in a file."""

    path: str
    name: TopicName


@dataclass(frozen=True, slots=True, kw_only=True)
class CheckSite:
    """A CheckValue; ``spec`` is what is known about its property.

    ``truth`` says whether it holds for none (FALSE), all (TRUE) or some of the values of its property,
    ``latch`` is what a check with an ``Until`` remembers.
    """

    path: str
    signal: Signal
    spec: PropertySpec | None
    truth: Truth
    check: Check
    latch: LastSeen | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class BlockSite:
    """A block; ``order`` is its place among all blocks of the set, ``form`` its (merged) condition."""

    order: int
    path: str
    block: Block
    form: Form

    @property
    def priority(self) -> int:
        """The written priority, else 0."""
        return self.block.priority or 0

    @property
    def is_one_check(self) -> bool:
        """Whether the condition compares once."""
        return sum(isinstance(part, Check) for part in conditions_in(self.block.condition)) == 1

    @property
    def line(self) -> int:
        """Where the block begins."""
        return self.block.span.line


@dataclass(frozen=True, slots=True, kw_only=True)
class Branch:
    """The Then or the Else of a block, with the condition under which it applies.

    ``order`` is its place among all branches, ``written`` its statements and ``settings`` the same by topic.
    """

    order: int
    block: BlockSite
    is_else: bool
    form: Form
    written: tuple[WrittenRate, ...]
    settings: Mapping[str, WrittenRate]

    def rate(self, topic: str) -> Rate | None:
        """The rate that it sets ``topic`` to, ``None`` for a tier."""
        return self.settings[topic].rate


@dataclass(frozen=True, slots=True, kw_only=True)
class WrittenRecord:
    """A Record with its block and the full names of its topics; none stands for all that the rules name."""

    block: BlockSite
    record: RecordIncident
    topics: tuple[str, ...]
    is_else: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class DisabledBlock:
    """A block that is switched off."""

    path: str
    block: Block


@dataclass(frozen=True, slots=True, kw_only=True)
class DisabledParts:
    """The disabled blocks with their checks and bounds, of which only names are checked."""

    blocks: tuple[DisabledBlock, ...]
    checks: tuple[CheckSite, ...]
    bounds: tuple[WrittenBound, ...]


def rate_of(expression: RateExpression) -> Rate | None:
    """The rate as written, ``None`` for a tier."""
    if isinstance(expression.value, Tier):
        return None
    if isinstance(expression.value, RateWord):
        return Rate.full() if expression.value is RateWord.FULL else Rate.off()
    return Rate(expression.value)


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


def times_in(blocks: Iterable[BlockSite]) -> Iterator[tuple[BlockSite, Timed]]:
    """Every ``For`` and ``Within``, with its block."""
    for block in blocks:
        for part in conditions_in(block.block.condition):
            if isinstance(part, Timed):
                yield block, part
