# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rule files with full topic names, before levels have values: what compiler, checker and optimizer read."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from itertools import accumulate, chain, islice
from operator import attrgetter, lt
from typing import Any

from smarttestudo.domain.dataclass import dataclass
from smarttestudo.domain.rate import Rate
from smarttestudo.domain.signal import Signal
from smarttestudo.domain.source import Span
from smarttestudo.language.normal_form import Form, Resolve, negation, normal_form
from smarttestudo.language.recall import Recall
from smarttestudo.language.syntax import (
    Action,
    Block,
    KeepAtLeast,
    KeepWithin,
    RecordIncident,
    RuleFile,
    SetFrequency,
    Statement,
    bounds_in,
    records_in,
    sets_in,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class ResolvedRate:
    """A SetFrequency; ``rate`` is ``None`` for a tier."""

    path: str
    topic: str
    statement: SetFrequency
    rate: Rate | None

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
class ResolvedBlock:
    """A block; ``order`` grows from block to block, ``file`` numbers its file, ``form`` is its condition."""

    order: int
    file: int
    path: str
    block: Block
    form: Form

    @property
    def priority(self) -> int:
        """The written priority, else 0."""
        return self.block.priority or 0


@dataclass(frozen=True, slots=True, kw_only=True)
class Branch:
    """The Then or the Else of a block, with at least one statement, and the condition under which it applies.

    ``order`` grows from branch to branch; ``written`` are its rates, and ``settings`` the same by topic.
    """

    order: int
    block: ResolvedBlock
    is_else: bool
    form: Form
    written: tuple[ResolvedRate, ...]
    settings: Mapping[str, ResolvedRate]
    bounds: tuple[ResolvedBound, ...]
    records: tuple[ResolvedRecord, ...]

    @property
    def label(self) -> str:
        """The block's label, for an Else with that word."""
        return f"{self.block.block.label} (Else)" if self.is_else else self.block.block.label

    def rate(self, topic: str) -> Rate | None:
        """The rate that it sets ``topic`` to, ``None`` for a tier."""
        return self.settings[topic].rate


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
        return {one.topic: one for one in self.written_defaults}

    @property
    def floors_hz(self) -> Mapping[str, float]:
        """The floors in Hz."""
        return {topic: one.rate.hz for topic, one in self.floors.items()}

    @property
    def always_bounds(self) -> Sequence[ResolvedBound]:
        """The bounds outside blocks, which always hold."""
        return [one for one in self.bounds if one.branch is None]


def resolve_rules(
    files: Sequence[RuleFile], resolve: Resolve, *, disabled: bool = False, recall: Recall | None = None
) -> ResolvedRules:
    """The statements of ``files`` that count, or the ``disabled`` blocks, with full topic names.

    ``recall`` has blocks of the same files that stand where they stood, with names resolved by ``resolve``.
    """
    recall = recall or Recall()
    read: list[_ReadStatement] = []
    for number, file in enumerate(files):
        counted = [one for one in file.statements if (isinstance(one, Block) and one.is_disabled) is disabled]
        orders = _orders(recall.each(("places", number, disabled), partial(_order, number), counted))
        reader = _Reader(resolve, number, file.path)
        read += recall.each(("read", number, disabled), reader.read, counted, orders)
    outside = _all(read, "outside")
    floors: dict[str, ResolvedFloor] = {}
    for one in outside:
        if isinstance(one, ResolvedFloor) and floors.setdefault(one.topic, one).rate < one.rate:
            floors[one.topic] = one
    return ResolvedRules(
        rates=_all(read, "rates"),
        bounds=_all(read, "bounds"),
        written_defaults=tuple(one for one in outside if isinstance(one, ResolvedRate)),
        floors=floors,
        blocks=_all(read, "blocks"),
        branches=_all(read, "branches"),
    )


def _order(file: int, statement: Statement) -> int:
    """An even number that grows with the place of a statement."""
    return (file << 96) + (statement.span.line << 32) + (statement.span.column << 1)


def _orders(places: Sequence[int]) -> Sequence[int]:
    """Numbers that grow by two or more, and stay as they are while other statements come and go."""
    if all(map(lt, places, islice(places, 1, None))):
        return places
    return list(accumulate(places, lambda last, place: max(last + 2, place)))


@dataclass(frozen=True, slots=True, kw_only=True)
class _ReadStatement:
    """The blocks and branches of a statement, all rates and bounds in it, and its rate outside blocks."""

    blocks: tuple[ResolvedBlock, ...] = ()
    branches: tuple[Branch, ...] = ()
    rates: tuple[ResolvedRate | ResolvedFloor, ...] = ()
    bounds: tuple[ResolvedBound, ...] = ()
    outside: tuple[ResolvedRate | ResolvedFloor, ...] = ()


def _all(read: Sequence[_ReadStatement], kind: str) -> tuple[Any, ...]:
    return tuple(chain.from_iterable(map(attrgetter(kind), read)))


class _Reader:
    """Reads the statements of one file."""

    def __init__(self, resolve: Resolve, file: int, path: str) -> None:
        self._full_name = resolve
        self._file = file
        self._path = path

    def read(self, statement: Statement, order: int) -> _ReadStatement:
        """A statement that has ``order`` among all."""
        match statement:
            case SetFrequency():
                rate = self._rate(statement)
                return _ReadStatement(rates=(rate,), outside=(rate,))
            case KeepAtLeast():
                floor = self._floor(statement)
                return _ReadStatement(rates=(floor,), outside=(floor,))
            case KeepWithin():
                return _ReadStatement(bounds=(self._bound(statement, None),))
            case Block():
                return self._block(statement, order)

    def _block(self, statement: Block, order: int) -> _ReadStatement:
        form = normal_form(statement.condition, self._full_name)
        block = ResolvedBlock(order=order, file=self._file, path=self._path, block=statement, form=form)
        sides = [(statement.then, False), (statement.otherwise, True)]
        branches = tuple(
            self._branch(block, actions, is_else=is_else) for actions, is_else in sides if actions
        )
        return _ReadStatement(
            blocks=(block,),
            branches=branches,
            rates=tuple(rate for branch in branches for rate in branch.written),
            bounds=tuple(bound for branch in branches for bound in branch.bounds),
        )

    def _branch(self, block: ResolvedBlock, actions: Sequence[Action], *, is_else: bool) -> Branch:
        written = tuple(self._rate(one) for one in sets_in(actions))
        return Branch(
            order=block.order + is_else,
            block=block,
            is_else=is_else,
            form=negation(block.form) if is_else else block.form,
            written=written,
            settings={one.topic: one for one in written},
            bounds=tuple(self._bound(one, (block.order, is_else)) for one in bounds_in(actions)),
            records=tuple(self._record(one) for one in records_in(actions)),
        )

    def _floor(self, statement: KeepAtLeast) -> ResolvedFloor:
        topic = self._full_name(statement.topic.text)
        rate = statement.rate.rate or Rate(0.0)
        return ResolvedFloor(path=self._path, topic=topic, statement=statement, rate=rate)

    def _rate(self, statement: SetFrequency) -> ResolvedRate:
        topic = self._full_name(statement.topic.text)
        return ResolvedRate(path=self._path, topic=topic, statement=statement, rate=statement.rate.rate)

    def _bound(self, statement: KeepWithin, branch: tuple[int, bool] | None) -> ResolvedBound:
        topic = self._full_name(statement.topic.text)
        return ResolvedBound(path=self._path, topic=topic, statement=statement, branch=branch)

    def _record(self, record: RecordIncident) -> ResolvedRecord:
        topics = tuple(self._full_name(name.text) for name in record.topics)
        return ResolvedRecord(path=self._path, topics=topics, statement=record)
