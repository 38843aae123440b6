# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rule files with full topic names, before levels have values: what compiler, checker and optimizer read."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from smarttestudo.domain.finding import Span
from smarttestudo.domain.rate import Rate
from smarttestudo.domain.signal import Signal
from smarttestudo.language.known_types import NO_TYPES, KnownTypes
from smarttestudo.language.normal_form import (
    Form,
    LastSeen,
    Resolve,
    margin_signal,
    negation,
    normal_form,
    read_check,
)
from smarttestudo.language.syntax import (
    Act,
    Action,
    Block,
    Check,
    KeepAtLeast,
    KeepWithin,
    RecordIncident,
    RuleFile,
    SetFrequency,
    Statement,
)
from smarttestudo.language.syntax_walks import (
    acts_in,
    bounds_in,
    checks_in,
    records_in,
    sets_in,
)
from smarttestudo.language.text_region import SetOfValues


@dataclass(frozen=True, slots=True, kw_only=True)
class ResolvedRate:
    """A SetFrequency; ``rate`` is ``None`` for a tier, of one with a ``margin`` the higher end.

    ``margin`` is the signal that it goes by.
    """

    path: str
    topic: str
    statement: SetFrequency
    rate: Rate | None
    margin: Signal | None = None

    @property
    def span(self) -> Span:
        """The whole statement."""
        return self.statement.span


@dataclass(frozen=True, slots=True, kw_only=True)
class ResolvedFloor:
    """A KeepAtLeast, whose rate is a number."""

    path: str
    topic: str
    statement: KeepAtLeast
    rate: Rate

    @property
    def span(self) -> Span:
        """The whole statement."""
        return self.statement.span


@dataclass(frozen=True, slots=True, kw_only=True)
class ResolvedBound:
    """A KeepWithin; ``branch`` is its block's order and whether in its Else, ``None`` outside blocks."""

    path: str
    topic: str
    statement: KeepWithin
    branch: tuple[int, bool] | None

    @property
    def signal(self) -> Signal:
        """The property that it bounds."""
        return Signal(self.topic, self.statement.property)


@dataclass(frozen=True, slots=True, kw_only=True)
class ResolvedRecord:
    """A Record; no topics stand for all that the rules name."""

    path: str
    topics: tuple[str, ...]
    statement: RecordIncident


@dataclass(frozen=True, slots=True, kw_only=True)
class ResolvedCheck:
    """A CheckValue: alone it is true in ``region``; ``latch`` is what one with an ``Until`` remembers."""

    path: str
    signal: Signal
    syntax: Check
    region: SetOfValues
    latch: LastSeen | None


@dataclass(frozen=True, slots=True, kw_only=True)
class ResolvedBlock:
    """A block; ``order`` is its place among all, ``file`` the number of its file.

    ``form`` is its condition, ``checks`` are those in it.
    """

    order: int
    file: int
    path: str
    block: Block
    form: Form
    checks: tuple[ResolvedCheck, ...]

    @property
    def priority(self) -> int:
        """The written priority, else 0."""
        return self.block.priority or 0


@dataclass(frozen=True, slots=True, kw_only=True)
class Branch:
    """The Then or the Else of a block, with at least one statement, and the condition under which it applies.

    ``order`` is its place among all branches, ``written`` its rates, and ``settings`` the same by topic.
    """

    order: int
    block: ResolvedBlock
    is_else: bool
    form: Form
    written: tuple[ResolvedRate, ...]
    settings: Mapping[str, ResolvedRate]
    bounds: tuple[ResolvedBound, ...]
    records: tuple[ResolvedRecord, ...]
    acts: tuple[Act, ...] = ()

    @property
    def label(self) -> str:
        """The block's label, for an Else with that word."""
        return f"{self.block.block.label} (Else)" if self.is_else else self.block.block.label

    def rate(self, topic: str) -> Rate | None:
        """The rate that it sets ``topic`` to, ``None`` for a tier or one that goes by a margin."""
        setting = self.settings[topic]
        return None if setting.margin is not None else setting.rate


@dataclass(frozen=True, slots=True, kw_only=True)
class ResolvedRules:
    """Statements of a set of files in the order of the text.

    ``rates`` is every SetFrequency and KeepAtLeast, ``bounds`` every KeepWithin; ``written_defaults`` are the
    SetFrequency outside blocks, ``floors`` the KeepAtLeast that count, the highest of each topic.
    """

    rates: tuple[ResolvedRate | ResolvedFloor, ...]
    bounds: tuple[ResolvedBound, ...]
    written_defaults: tuple[ResolvedRate, ...]
    floors: Mapping[str, ResolvedFloor]
    blocks: tuple[ResolvedBlock, ...]
    branches: tuple[Branch, ...]

    @property
    def defaults(self) -> Mapping[str, ResolvedRate]:
        """The defaults that count, the last of each topic."""
        return {default.topic: default for default in self.written_defaults}

    @property
    def floors_hz(self) -> Mapping[str, float]:
        """The floors in Hz."""
        return {topic: floor.rate.hz for topic, floor in self.floors.items()}

    @property
    def always_bounds(self) -> Sequence[ResolvedBound]:
        """The bounds outside blocks, which always hold."""
        return [bound for bound in self.bounds if bound.branch is None]


def resolve_rules(
    files: Sequence[RuleFile], resolve: Resolve, types: KnownTypes = NO_TYPES, *, disabled: bool = False
) -> ResolvedRules:
    """The statements of ``files`` that count, or the ``disabled`` blocks, with full topic names."""
    reader = _Reader(resolve, types)
    for number, file in enumerate(files):
        for statement in file.statements:
            if (isinstance(statement, Block) and statement.is_disabled) is disabled:
                reader.add(number, file.path, statement)
    return ResolvedRules(
        rates=tuple(reader.rates),
        bounds=tuple(reader.bounds),
        written_defaults=tuple(reader.defaults),
        floors=reader.floors,
        blocks=tuple(reader.blocks),
        branches=tuple(reader.branches),
    )


class _Reader:
    def __init__(self, resolve: Resolve, types: KnownTypes) -> None:
        self._full_name = resolve
        self._types = types
        self.rates: list[ResolvedRate | ResolvedFloor] = []
        self.bounds: list[ResolvedBound] = []
        self.defaults: list[ResolvedRate] = []
        self.floors: dict[str, ResolvedFloor] = {}
        self.blocks: list[ResolvedBlock] = []
        self.branches: list[Branch] = []

    def add(self, file: int, path: str, statement: Statement) -> None:
        match statement:
            case SetFrequency():
                self.defaults.append(self._rate(path, statement))
            case KeepAtLeast():
                self._add_floor(path, statement)
            case KeepWithin():
                self._bound(path, statement, None)
            case Block():
                block = ResolvedBlock(
                    order=len(self.blocks),
                    file=file,
                    path=path,
                    block=statement,
                    form=normal_form(statement.condition, self._full_name, self._types),
                    checks=tuple(self._check(path, check) for check in checks_in(statement.condition)),
                )
                self.blocks.append(block)
                self._add_branch(block, statement.then, is_else=False)
                self._add_branch(block, statement.otherwise, is_else=True)

    def _check(self, path: str, check: Check) -> ResolvedCheck:
        read = read_check(check, self._full_name, self._types)
        return ResolvedCheck(
            path=path, signal=read.signal, syntax=check, region=read.region, latch=read.latch
        )

    def _add_branch(self, block: ResolvedBlock, actions: Sequence[Action], *, is_else: bool) -> None:
        if not actions:
            return
        written = tuple(self._rate(block.path, rate) for rate in sets_in(actions))
        branch = Branch(
            order=len(self.branches),
            block=block,
            is_else=is_else,
            form=negation(block.form) if is_else else block.form,
            written=written,
            settings={rate.topic: rate for rate in written},
            bounds=tuple(
                self._bound(block.path, bound, (block.order, is_else)) for bound in bounds_in(actions)
            ),
            records=tuple(self._record(block.path, record) for record in records_in(actions)),
            acts=acts_in(actions),
        )
        self.branches.append(branch)

    def _add_floor(self, path: str, statement: KeepAtLeast) -> None:
        topic = self._full_name(statement.topic.text)
        rate = statement.rate.rate or Rate(0.0)
        floor = ResolvedFloor(path=path, topic=topic, statement=statement, rate=rate)
        self.rates.append(floor)
        if self.floors.setdefault(topic, floor).rate < rate:
            self.floors[topic] = floor

    def _rate(self, path: str, statement: SetFrequency) -> ResolvedRate:
        topic = self._full_name(statement.topic.text)
        rate = ResolvedRate(
            path=path,
            topic=topic,
            statement=statement,
            rate=statement.highest.rate,
            margin=None if statement.margin is None else margin_signal(statement.margin, self._full_name),
        )
        self.rates.append(rate)
        return rate

    def _bound(self, path: str, statement: KeepWithin, branch: tuple[int, bool] | None) -> ResolvedBound:
        topic = self._full_name(statement.topic.text)
        bound = ResolvedBound(path=path, topic=topic, statement=statement, branch=branch)
        self.bounds.append(bound)
        return bound

    def _record(self, path: str, record: RecordIncident) -> ResolvedRecord:
        topics = tuple(self._full_name(name.text) for name in record.topics)
        return ResolvedRecord(path=path, topics=topics, statement=record)
