# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What one or more rule files mean together, ready for the evaluator."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from smarttestudo.adirf.normal_form import Form, Resolve, normal_form, signals_of
from smarttestudo.adirf.region import Region
from smarttestudo.adirf.syntax import (
    Block,
    KeepAtLeast,
    RateExpression,
    RateWord,
    RuleFile,
    SetFrequency,
    checks_in,
)
from smarttestudo.domain.decision import Reason
from smarttestudo.domain.errors import RuleFileError
from smarttestudo.domain.rate import Rate, Tier
from smarttestudo.domain.signal import Signal


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleBlock:
    """A condition with the rates it sets; an ``Else`` is one of its own with the negated condition.

    ``order`` is its place among all blocks of the rule set, ``line`` that in its file.
    """

    order: int
    label: str
    line: int
    path: str
    priority: int
    form: Form
    rates: Mapping[str, Rate]


@dataclass(frozen=True, slots=True, kw_only=True)
class WrittenCheck:
    """One check where it is written: true while its signal lies in ``region``, whatever is around it."""

    line: int
    column: int
    signal: Signal
    region: Region


@dataclass(frozen=True, slots=True, kw_only=True)
class WrittenBlock:
    """An If where it is written, in file number ``file``, with its checks in their order.

    ``order`` is that of the block of its Then.
    """

    file: int
    line: int
    column: int
    order: int
    checks: tuple[WrittenCheck, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleSet:
    """Defaults, floors in Hz and blocks; topics by full name.

    ``default_reason`` is what decisions give as the reason of a default. ``written`` are the blocks as the
    files have them, an If and its Else once.
    """

    defaults: Mapping[str, Rate]
    default_lines: Mapping[str, int]
    floors_hz: Mapping[str, float]
    blocks: tuple[RuleBlock, ...]
    default_reason: Reason = Reason.DEFAULT
    written: tuple[WrittenBlock, ...] = ()

    @property
    def relayed(self) -> tuple[str, ...]:
        """The topics that are relayed, in order of first mention among defaults, floors, blocks."""
        names = dict.fromkeys([*self.defaults, *self.floors_hz])
        for block in self.blocks:
            names.update(dict.fromkeys(block.rates))
        return tuple(names)

    @property
    def signals(self) -> frozenset[Signal]:
        """Everything that checks read."""
        return frozenset().union(*(signals_of(block.form) for block in self.blocks))


def fallback_rules(topics: Iterable[str]) -> RuleSet:
    """What holds while there are no rules: every message of ``topics`` passes."""
    return RuleSet(
        defaults={topic: Rate.full() for topic in topics},
        default_lines={},
        floors_hz={},
        blocks=(),
        default_reason=Reason.FALLBACK,
    )


TierRates = Callable[[SetFrequency, str], Rate]
"""The rate that the optimizer gave one statement, from the statement and its file's path."""


def refuse_tier(statement: SetFrequency, path: str) -> Rate:
    """The ``TierRates`` of a set-up without an optimizer: every tier is an error."""
    value = statement.rate.value
    raise RuleFileError(
        f"{value.value if isinstance(value, Tier) else value} has no rate without a profile",
        place=f"{path}:{statement.span.line}:{statement.span.column}",
        remedy="give a number, or a profile with --profile",
    )


def compile_rules(
    files: Sequence[RuleFile], resolve: Resolve, tier_rates: TierRates = refuse_tier
) -> RuleSet:
    """The meaning of ``files`` as one set; expects files without errors."""
    compiler = _Compiler(resolve=resolve, tier_rates=tier_rates)
    for file in files:
        compiler.add(file)
    return compiler.rule_set()


class _Compiler:
    def __init__(self, *, resolve: Resolve, tier_rates: TierRates) -> None:
        self._resolve = resolve
        self._tier_rates = tier_rates
        self._defaults: dict[str, Rate] = {}
        self._default_lines: dict[str, int] = {}
        self._floors_hz: dict[str, float] = {}
        self._blocks: list[RuleBlock] = []
        self._written: list[WrittenBlock] = []
        self._files = 0

    def add(self, file: RuleFile) -> None:
        self._files += 1
        for statement in file.statements:
            topic = "" if isinstance(statement, Block) else self._resolve(statement.topic.text)
            match statement:
                case SetFrequency():
                    self._defaults[topic] = self._rate(statement, file.path)
                    self._default_lines[topic] = statement.span.line
                case KeepAtLeast():
                    floor_hz = _number(statement.rate)
                    self._floors_hz[topic] = max(floor_hz, self._floors_hz.get(topic, 0.0))
                case Block():
                    self._written.append(self._as_written(statement))
                    self._blocks.extend(self._blocks_of(statement, file.path))

    def rule_set(self) -> RuleSet:
        return RuleSet(
            defaults=self._defaults,
            default_lines=self._default_lines,
            floors_hz=self._floors_hz,
            blocks=tuple(self._blocks),
            written=tuple(self._written),
        )

    def _as_written(self, block: Block) -> WrittenBlock:
        return WrittenBlock(
            file=self._files - 1,
            line=block.span.line,
            column=block.span.column,
            order=len(self._blocks),
            checks=tuple(
                WrittenCheck(
                    line=check.span.line,
                    column=check.span.column,
                    signal=Signal(self._resolve(check.topic.text), check.property),
                    region=Region.where(check.operator, check.value),
                )
                for check in checks_in(block.condition)
            ),
        )

    def _blocks_of(self, block: Block, path: str) -> Iterator[RuleBlock]:
        order = len(self._blocks)
        sides = ((block.then, False, block.label), (block.otherwise, True, f"{block.label} (Else)"))
        for offset, (statements, negated, label) in enumerate(sides):
            if statements:
                yield RuleBlock(
                    order=order + offset,
                    label=label,
                    line=block.span.line,
                    path=path,
                    priority=block.priority or 0,
                    form=normal_form(block.condition, self._resolve, negated=negated),
                    rates={self._resolve(one.topic.text): self._rate(one, path) for one in statements},
                )

    def _rate(self, statement: SetFrequency, path: str) -> Rate:
        value = statement.rate.value
        if isinstance(value, Tier):
            return self._tier_rates(statement, path)
        if isinstance(value, RateWord):
            return Rate.full() if value is RateWord.FULL else Rate.off()
        return Rate(value)


def _number(rate: RateExpression) -> float:
    return float(rate.value) if isinstance(rate.value, int | float) else math.nan
