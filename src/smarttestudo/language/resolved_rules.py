# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rule files with full topic names, before levels have values: what compiler, checker and optimizer read.

A statement with a pattern is one for each topic that it matches, where no other at its place counts more.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import chain
from typing import Protocol, TypeVar

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
    TopicName,
)
from smarttestudo.language.syntax_walks import (
    acts_in,
    bounds_in,
    checks_in,
    records_in,
    sets_in,
)
from smarttestudo.language.text_region import SetOfValues
from smarttestudo.language.topic_pattern import matching, standing


@dataclass(frozen=True, slots=True, kw_only=True)
class ResolvedRate:
    """A SetFrequency; ``rate`` is ``None`` for a tier, of one with a ``margin`` the higher end.

    ``written`` is ``topic``, or the pattern in full; ``margin`` is the signal that it goes by.
    """

    path: str
    topic: str
    written: str
    statement: SetFrequency
    rate: Rate | None
    margin: Signal | None = None

    @property
    def span(self) -> Span:
        """The whole statement."""
        return self.statement.span

    @property
    def is_by_pattern(self) -> bool:
        """Whether the topic is one of several that the statement may mean."""
        return self.topic != self.written


@dataclass(frozen=True, slots=True, kw_only=True)
class ResolvedFloor:
    """A KeepAtLeast, whose rate is a number; ``written`` as of a SetFrequency."""

    path: str
    topic: str
    written: str
    statement: KeepAtLeast
    rate: Rate

    @property
    def span(self) -> Span:
        """The whole statement."""
        return self.statement.span


@dataclass(frozen=True, slots=True, kw_only=True)
class ResolvedBound:
    """A KeepWithin; ``branch`` is its block's order and whether in its Else, ``None`` outside blocks.

    ``written`` is as of a SetFrequency.
    """

    path: str
    topic: str
    written: str
    statement: KeepWithin
    branch: tuple[int, bool] | None

    @property
    def signal(self) -> Signal:
        """The property that it bounds."""
        return Signal(self.topic, self.statement.property)


PatternStatement = SetFrequency | KeepAtLeast | KeepWithin | RecordIncident


@dataclass(frozen=True, slots=True, kw_only=True)
class ResolvedPattern:
    """A pattern in a statement, as it is written and in full, whether or not it matches anything.

    ``branch`` is as of a KeepWithin.
    """

    path: str
    pattern: str
    name: TopicName
    statement: PatternStatement
    branch: tuple[int, bool] | None


@dataclass(frozen=True, slots=True, kw_only=True)
class ResolvedRecord:
    """A Record; all topics that the rules name are meant where the statement names none."""

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
    SetFrequency outside blocks, ``floors`` the KeepAtLeast that count, the highest of each topic. What a
    pattern says of a topic is left out where another statement at its place counts more; ``patterns`` has
    every pattern.
    """

    rates: tuple[ResolvedRate | ResolvedFloor, ...]
    bounds: tuple[ResolvedBound, ...]
    written_defaults: tuple[ResolvedRate, ...]
    floors: Mapping[str, ResolvedFloor]
    blocks: tuple[ResolvedBlock, ...]
    branches: tuple[Branch, ...]
    patterns: tuple[ResolvedPattern, ...] = ()

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
    """The statements of ``files`` that count, or the ``disabled`` blocks, with full topic names.

    Patterns match the topics that are there by ``types``, and those that the statements relay by name.
    """
    statements = [
        (number, file.path, statement)
        for number, file in enumerate(files)
        for statement in file.statements
        if (isinstance(statement, Block) and statement.is_disabled) is disabled
    ]
    reader = _Reader(resolve, types, [statement for _, _, statement in statements])
    for number, path, statement in statements:
        reader.add(number, path, statement)
    return reader.rules()


class _Written(Protocol):
    @property
    def topic(self) -> str: ...

    @property
    def written(self) -> str: ...


_WrittenT = TypeVar("_WrittenT", bound=_Written)


def _standing(one: _Written) -> tuple[bool, int]:
    # Two full names are the same one.
    return (True, 0) if one.topic == one.written else standing(one.written)


class _Reader:
    def __init__(self, resolve: Resolve, types: KnownTypes, statements: Sequence[Statement]) -> None:
        self._full_name = resolve
        self._types = types
        self._statements = statements
        self._matches: dict[str, Sequence[str]] = {}
        self._beaten: set[int] = set()
        """The identities of what others beat."""
        self._patterns: list[ResolvedPattern] = []
        self._rates: list[ResolvedRate | ResolvedFloor] = []
        self._bounds: list[ResolvedBound] = []
        self._defaults: list[ResolvedRate] = []
        self._floors: list[ResolvedFloor] = []
        self._blocks: list[ResolvedBlock] = []
        self._branches: list[Branch] = []

    def rules(self) -> ResolvedRules:
        defaults = self._counting(self._defaults, lambda default: default.topic)
        floors: dict[str, ResolvedFloor] = {}
        for floor in self._counting(self._floors, lambda floor: floor.topic):
            if floors.setdefault(floor.topic, floor).rate < floor.rate:
                floors[floor.topic] = floor
        always = [bound for bound in self._bounds if bound.branch is None]
        self._counting(always, lambda bound: bound.signal)
        return ResolvedRules(
            rates=tuple(rate for rate in self._rates if id(rate) not in self._beaten),
            bounds=tuple(bound for bound in self._bounds if id(bound) not in self._beaten),
            written_defaults=defaults,
            floors=floors,
            blocks=tuple(self._blocks),
            branches=tuple(self._branches),
            patterns=tuple(self._patterns),
        )

    def add(self, file: int, path: str, statement: Statement) -> None:
        match statement:
            case SetFrequency():
                self._defaults += self._rates_of(path, statement, None)
            case KeepAtLeast():
                self._add_floor(path, statement)
            case KeepWithin():
                self._bounds_of(path, statement, None)
            case Block():
                block = ResolvedBlock(
                    order=len(self._blocks),
                    file=file,
                    path=path,
                    block=statement,
                    form=normal_form(statement.condition, self._full_name, self._types),
                    checks=tuple(self._check(path, check) for check in checks_in(statement.condition)),
                )
                self._blocks.append(block)
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
        path, side = block.path, (block.order, is_else)
        rates = [one for rate in sets_in(actions) for one in self._rates_of(path, rate, side)]
        bounds = [one for bound in bounds_in(actions) for one in self._bounds_of(path, bound, side)]
        written = self._counting(rates, lambda rate: rate.topic)
        branch = Branch(
            order=len(self._branches),
            block=block,
            is_else=is_else,
            form=negation(block.form) if is_else else block.form,
            written=written,
            settings={rate.topic: rate for rate in written},
            bounds=self._counting(bounds, lambda bound: bound.signal),
            records=tuple(self._record(path, record, side) for record in records_in(actions)),
            acts=acts_in(actions),
        )
        self._branches.append(branch)

    def _add_floor(self, path: str, statement: KeepAtLeast) -> None:
        written, topics = self._topics_of(path, statement.topic, statement, None)
        rate = statement.rate.rate or Rate(0.0)
        floors = [
            ResolvedFloor(path=path, topic=topic, written=written, statement=statement, rate=rate)
            for topic in topics
        ]
        self._rates += floors
        self._floors += floors

    def _rates_of(
        self, path: str, statement: SetFrequency, side: tuple[int, bool] | None
    ) -> list[ResolvedRate]:
        written, topics = self._topics_of(path, statement.topic, statement, side)
        margin = None if statement.margin is None else margin_signal(statement.margin, self._full_name)
        rates = [
            ResolvedRate(
                path=path,
                topic=topic,
                written=written,
                statement=statement,
                rate=statement.highest.rate,
                margin=margin,
            )
            for topic in topics
        ]
        self._rates += rates
        return rates

    def _bounds_of(
        self, path: str, statement: KeepWithin, side: tuple[int, bool] | None
    ) -> list[ResolvedBound]:
        written, topics = self._topics_of(path, statement.topic, statement, side)
        bounds = [
            ResolvedBound(path=path, topic=topic, written=written, statement=statement, branch=side)
            for topic in topics
        ]
        self._bounds += bounds
        return bounds

    def _record(self, path: str, record: RecordIncident, side: tuple[int, bool]) -> ResolvedRecord:
        named = (self._topics_of(path, name, record, side)[1] for name in record.topics)
        return ResolvedRecord(path=path, topics=tuple(chain.from_iterable(named)), statement=record)

    def _topics_of(
        self, path: str, name: TopicName, statement: PatternStatement, side: tuple[int, bool] | None
    ) -> tuple[str, Sequence[str]]:
        """A name or pattern in full, and the topics that are meant."""
        full = self._full_name(name.text)
        if not name.is_pattern:
            return full, (full,)
        self._patterns.append(
            ResolvedPattern(path=path, pattern=full, name=name, statement=statement, branch=side)
        )
        if full not in self._matches:
            self._matches[full] = matching(full, self._matchable)
        return full, self._matches[full]

    @cached_property
    def _matchable(self) -> Collection[str]:
        """The topics that are there, and those that are relayed by name."""
        names = (name for statement in self._statements for name in _relayed_names(statement))
        return {*self._types.topics, *(self._full_name(name.text) for name in names if not name.is_pattern)}

    def _counting(
        self, found: Sequence[_WrittenT], key: Callable[[_WrittenT], Hashable]
    ) -> tuple[_WrittenT, ...]:
        """Members of ``found`` that no other with the same ``key`` beats by its standing."""
        if all(one.topic == one.written for one in found):
            return tuple(found)
        best: dict[Hashable, tuple[bool, int]] = {}
        for one in found:
            best[key(one)] = max(best.get(key(one), (False, 0)), _standing(one))
        self._beaten.update(id(one) for one in found if _standing(one) < best[key(one)])
        return tuple(one for one in found if id(one) not in self._beaten)


def _relayed_names(statement: Statement) -> Iterator[TopicName]:
    if isinstance(statement, Block):
        for side in (statement.then, statement.otherwise):
            yield from (rate.topic for rate in sets_in(side))
            yield from (bound.topic for bound in bounds_in(side))
    else:
        yield statement.topic
