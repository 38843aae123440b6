# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The meaning of one or more rule files together, ready for the evaluator."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Protocol

from smarttestudo.domain.decision import Reason
from smarttestudo.domain.errors import RuleFileError
from smarttestudo.domain.rate import Rate, Tier
from smarttestudo.domain.signal import Signal
from smarttestudo.domain.source import Span
from smarttestudo.language.normal_form import (
    Form,
    HeldTime,
    LastSeen,
    Resolve,
    check_form,
    held_time,
    normal_form,
    over_states,
    signals_of,
)
from smarttestudo.language.region import Region
from smarttestudo.language.syntax import (
    Action,
    Block,
    Check,
    KeepAtLeast,
    KeepWithin,
    RateExpression,
    RateWord,
    RecordIncident,
    RuleFile,
    SetFrequency,
    Timed,
    TimeWord,
    bounds_in,
    checks_in,
    records_in,
    sets_in,
    times_in,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordRequest:
    """The request of a ``Record``: topics by full name, from ``before_ns`` before to ``after_ns`` after."""

    name: str
    line: int
    topics: tuple[str, ...]
    before_ns: int
    after_ns: int


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleBlock:
    """A condition with the rates it sets; an ``Else`` is one of its own with the negated condition.

    ``bounds`` are those of the receiver's picture that it sets, by topic and property. ``order`` is its place
    among all blocks of the rule set, ``line`` that in its file; ``recordings`` begin when it begins to hold.
    """

    order: int
    label: str
    line: int
    path: str
    priority: int
    form: Form
    rates: Mapping[str, Rate]
    bounds: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    recordings: tuple[RecordRequest, ...] = ()

    @property
    def topics(self) -> tuple[str, ...]:
        """The topics whose rate or bounds it sets."""
        return tuple(dict.fromkeys([*self.rates, *self.bounds]))


@dataclass(frozen=True, slots=True, kw_only=True)
class WrittenCheck:
    """One check where it is written: true while its signal lies in ``region``, whatever is around it.

    With an ``Until`` it is as ``latch`` remembers, unknown while the signal is.
    """

    line: int
    column: int
    signal: Signal
    region: Region
    latch: LastSeen | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class WrittenTime:
    """A ``For`` or ``Within`` at the place of its duration, with the signal that it compares with it."""

    line: int
    column: int
    word: TimeWord
    held: HeldTime
    duration_ns: int


@dataclass(frozen=True, slots=True, kw_only=True)
class WrittenBlock:
    """An If where it is written, in file number ``file``, with its checks and times in their order.

    ``order`` is that of the block of its Then.
    """

    file: int
    line: int
    column: int
    order: int
    checks: tuple[WrittenCheck, ...]
    times: tuple[WrittenTime, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleSet:
    """Defaults, floors in Hz, bounds of the receiver's picture and blocks; topics by full name.

    ``bounds`` are those outside blocks, by topic and property; a topic of a bound alone is relayed at
    ``Full``, as is every other one without a default. ``default_reason`` is what decisions give as the reason
    of a default. ``written`` are the blocks as the files have them, an If and its Else once.
    """

    defaults: Mapping[str, Rate]
    default_lines: Mapping[str, int]
    floors_hz: Mapping[str, float]
    blocks: tuple[RuleBlock, ...]
    default_reason: Reason = Reason.DEFAULT
    written: tuple[WrittenBlock, ...] = ()
    bounds: Mapping[str, Mapping[str, float]] = field(default_factory=dict)

    @property
    def relayed(self) -> tuple[str, ...]:
        """The topics that are relayed, in order of first mention among defaults, floors, bounds, blocks."""
        names = dict.fromkeys([*self.defaults, *self.floors_hz, *self.bounds])
        for block in self.blocks:
            names.update(dict.fromkeys(block.topics))
        return tuple(names)

    @property
    def has_recordings(self) -> bool:
        """Whether any block records."""
        return any(block.recordings for block in self.blocks)

    @property
    def recorded(self) -> frozenset[str]:
        """The topics that recordings keep."""
        return frozenset(
            topic for block in self.blocks for recording in block.recordings for topic in recording.topics
        )

    @property
    def signals(self) -> frozenset[Signal]:
        """Everything that checks read."""
        return frozenset().union(*(signals_of(block.form) for block in self.blocks))

    def over_states(self) -> RuleSet:
        """The same rules for single states, in which what was before is a signal like any other."""
        return replace(
            self, blocks=tuple(replace(block, form=over_states(block.form)) for block in self.blocks)
        )


def fallback_rules(topics: Iterable[str]) -> RuleSet:
    """The rules in force while there are none: every message of ``topics`` passes."""
    return RuleSet(
        defaults={topic: Rate.full() for topic in topics},
        default_lines={},
        floors_hz={},
        blocks=(),
        default_reason=Reason.FALLBACK,
    )


class TierValues(Protocol):
    """The values that the optimizer gave tiers of rule files; statements come with their file's path."""

    def tier_rate(self, statement: SetFrequency, path: str, /) -> Rate:
        """The rate of a statement that names a tier."""

    def tier_bound(self, statement: KeepWithin, path: str, /) -> float:
        """The bound of a statement that names a tier."""


class RefusedTiers:
    """The ``TierValues`` of a set-up without an optimizer: every tier is an error."""

    def tier_rate(self, statement: SetFrequency, path: str, /) -> Rate:
        """Raises ``RuleFileError``."""
        raise _no_profile(statement.rate.value, "rate", statement.span, path)

    def tier_bound(self, statement: KeepWithin, path: str, /) -> float:
        """Raises ``RuleFileError``."""
        raise _no_profile(statement.bound, "accuracy", statement.span, path)


def _no_profile(value: float | Tier | RateWord, what: str, span: Span, path: str) -> RuleFileError:
    return RuleFileError(
        f"{value.value if isinstance(value, Tier) else value} has no {what} without a profile",
        place=f"{path}:{span.line}:{span.column}",
        remedy="give a number, or a profile with --profile",
    )


def compile_rules(files: Sequence[RuleFile], resolve: Resolve, tiers: TierValues | None = None) -> RuleSet:
    """The meaning of ``files``, which have no errors, as one set; tiers in them need ``tiers``."""
    compiler = _Compiler(resolve=resolve, tiers=RefusedTiers() if tiers is None else tiers)
    for file in files:
        compiler.add(file)
    return compiler.rule_set()


class _Compiler:
    def __init__(self, *, resolve: Resolve, tiers: TierValues) -> None:
        self._resolve = resolve
        self._tiers = tiers
        self._defaults: dict[str, Rate] = {}
        self._default_lines: dict[str, int] = {}
        self._floors_hz: dict[str, float] = {}
        self._bounds: dict[str, dict[str, float]] = {}
        self._blocks: list[RuleBlock] = []
        self._written: list[WrittenBlock] = []
        self._files = 0

    def add(self, file: RuleFile) -> None:
        self._files += 1
        for statement in file.enabled_statements:
            topic = "" if isinstance(statement, Block) else self._resolve(statement.topic.text)
            match statement:
                case SetFrequency():
                    self._defaults[topic] = self._rate(statement, file.path)
                    self._default_lines[topic] = statement.span.line
                case KeepAtLeast():
                    floor_hz = _number(statement.rate)
                    self._floors_hz[topic] = max(floor_hz, self._floors_hz.get(topic, 0.0))
                case KeepWithin():
                    self._tighten(self._bounds, topic, statement, file.path)
                case Block():
                    self._written.append(self._as_written(statement))
                    self._blocks.extend(self._blocks_of(statement, file.path))

    def rule_set(self) -> RuleSet:
        rules = self._without_topics()
        if not rules.has_recordings:
            return rules
        names = (*rules.relayed, *sorted(signal.topic for signal in rules.signals), *sorted(rules.recorded))
        named = tuple(dict.fromkeys(names))
        return replace(rules, blocks=tuple(_recording_all(block, named) for block in rules.blocks))

    def _without_topics(self) -> RuleSet:
        """The rule set in which recordings of all topics have none yet."""
        return RuleSet(
            defaults=self._defaults,
            default_lines=self._default_lines,
            floors_hz=self._floors_hz,
            blocks=tuple(self._blocks),
            written=tuple(self._written),
            bounds=self._bounds,
        )

    def _as_written(self, block: Block) -> WrittenBlock:
        return WrittenBlock(
            file=self._files - 1,
            line=block.span.line,
            column=block.span.column,
            order=len(self._blocks),
            checks=tuple(map(self._check_as_written, checks_in(block.condition))),
            times=tuple(map(self._time_as_written, times_in(block.condition))),
        )

    def _time_as_written(self, timed: Timed) -> WrittenTime:
        return WrittenTime(
            line=timed.duration.span.line,
            column=timed.duration.span.column,
            word=timed.word,
            held=held_time(timed, self._resolve),
            duration_ns=timed.duration.ns,
        )

    def _check_as_written(self, check: Check) -> WrittenCheck:
        signal = Signal(self._resolve(check.topic.text), check.property)
        found = check_form(check, signal).signal
        return WrittenCheck(
            line=check.span.line,
            column=check.span.column,
            signal=signal,
            region=Region.where(check.operator, check.value),
            latch=found if isinstance(found, LastSeen) else None,
        )

    def _blocks_of(self, block: Block, path: str) -> Iterator[RuleBlock]:
        order = len(self._blocks)
        sides = ((block.then, False, block.label), (block.otherwise, True, f"{block.label} (Else)"))
        for offset, (actions, negated, label) in enumerate(sides):
            if actions:
                yield RuleBlock(
                    order=order + offset,
                    label=label,
                    line=block.span.line,
                    path=path,
                    priority=block.priority or 0,
                    form=normal_form(block.condition, self._resolve, negated=negated),
                    rates={self._resolve(one.topic.text): self._rate(one, path) for one in sets_in(actions)},
                    bounds=self._bounds_of(actions, path),
                    recordings=tuple(map(self._recording, records_in(actions))),
                )

    def _bounds_of(self, actions: Iterable[Action], path: str) -> Mapping[str, Mapping[str, float]]:
        bounds: dict[str, dict[str, float]] = {}
        for one in bounds_in(actions):
            self._tighten(bounds, self._resolve(one.topic.text), one, path)
        return bounds

    def _tighten(self, bounds: dict[str, dict[str, float]], topic: str, one: KeepWithin, path: str) -> None:
        """Of several bounds of one property the tightest counts."""
        bound = self._tiers.tier_bound(one, path) if isinstance(one.bound, Tier) else one.bound
        of_topic = bounds.setdefault(topic, {})
        of_topic[one.property] = min(bound, of_topic.get(one.property, math.inf))

    def _recording(self, record: RecordIncident) -> RecordRequest:
        return RecordRequest(
            name=record.name,
            line=record.span.line,
            topics=tuple(dict.fromkeys(self._resolve(topic.text) for topic in record.topics)),
            before_ns=record.before.ns,
            after_ns=record.after.ns,
        )

    def _rate(self, statement: SetFrequency, path: str) -> Rate:
        value = statement.rate.value
        if isinstance(value, Tier):
            return self._tiers.tier_rate(statement, path)
        if isinstance(value, RateWord):
            return Rate.full() if value is RateWord.FULL else Rate.off()
        return Rate(value)


def _recording_all(block: RuleBlock, topics: tuple[str, ...]) -> RuleBlock:
    """``block`` whose recordings keep ``topics`` where they name none."""
    recordings = tuple(one if one.topics else replace(one, topics=topics) for one in block.recordings)
    return replace(block, recordings=recordings)


def _number(rate: RateExpression) -> float:
    return float(rate.value) if isinstance(rate.value, int | float) else math.nan
