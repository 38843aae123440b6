# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The meaning of one or more rule files together, ready for the evaluator."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from typing import Protocol

from smarttestudo.domain.action import ActionKind, ActRequest
from smarttestudo.domain.decision import Reason
from smarttestudo.domain.errors import RuleFileError
from smarttestudo.domain.finding import Span
from smarttestudo.domain.names import is_source
from smarttestudo.domain.rate import Rate, Tier
from smarttestudo.domain.signal import Signal, Values
from smarttestudo.domain.timing import Yield, yielding
from smarttestudo.language.known_types import NO_TYPES, KnownTypes
from smarttestudo.language.margin_rate import MarginRate
from smarttestudo.language.normal_form import (
    Every,
    Form,
    HeldTime,
    InRegion,
    LastSeen,
    Resolve,
    Some,
    held_time,
    over_states,
    signals_of,
)
from smarttestudo.language.resolved_rules import (
    Branch,
    ResolvedBound,
    ResolvedCheck,
    ResolvedRate,
    ResolvedRecord,
    ResolvedRules,
    resolve_rules,
)
from smarttestudo.language.syntax import (
    Act,
    CallService,
    Constant,
    KeepWithin,
    Notify,
    RateExpression,
    RateWord,
    RuleFile,
    SetFrequency,
    SetParameter,
    Timed,
    TimeWord,
)
from smarttestudo.language.syntax_walks import (
    times_in,
)
from smarttestudo.language.text_region import SetOfValues


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordRequest:
    """The request of a ``Record``: topics by full name, from ``before_ns`` before to ``after_ns`` after."""

    name: str
    line: int
    topics: tuple[str, ...]
    before_ns: int
    after_ns: int


@dataclass(frozen=True, slots=True, kw_only=True)
class WrittenCheck:
    """One check where it is written: true while its signal lies in ``region``, whatever is around it.

    With an ``Until`` it is as ``latch`` remembers, unknown while the signal is.
    """

    line: int
    column: int
    signal: Signal
    region: SetOfValues
    latch: LastSeen | None = None

    def holds_for(self, values: Values) -> bool:
        """Whether it is true for a value, or for any of several."""
        each = values if isinstance(values, tuple) else (values,)
        return any(self.region.contains(value) for value in each)  # type: ignore[arg-type]  # of one sort


@dataclass(frozen=True, slots=True, kw_only=True)
class WrittenTime:
    """A ``For`` or ``Within`` at the place of its duration, with the signal that it compares with it."""

    line: int
    column: int
    word: TimeWord
    held: HeldTime
    duration_ns: int


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleBlock:
    """A condition with the rates it sets; an ``Else`` is one of its own with the negated condition.

    ``margins`` are the rates that go by a value, of which ``rates`` has the higher end. ``bounds`` are those
    of the receiver's picture that it sets, by topic and property. ``order`` is its place
    among all blocks of the rule set, ``line`` and ``column`` those in file number ``file``; ``recordings``
    begin and ``acts`` are done when it begins to hold. ``name`` is the one that is written, if one is; a
    ``label`` may say the line. ``checks`` and ``times`` are those of the condition as they are written, which
    an ``Else`` has not.
    """

    order: int
    name: str | None
    label: str
    file: int
    line: int
    column: int
    path: str
    priority: int
    form: Form
    rates: Mapping[str, Rate]
    margins: Mapping[str, MarginRate] = field(default_factory=dict)
    bounds: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    recordings: tuple[RecordRequest, ...] = ()
    acts: tuple[ActRequest, ...] = ()
    checks: tuple[WrittenCheck, ...] = ()
    times: tuple[WrittenTime, ...] = ()

    @property
    def topics(self) -> tuple[str, ...]:
        """The topics whose rate or bounds it sets."""
        return tuple(dict.fromkeys([*self.rates, *self.bounds]))


CompileAnew = Callable[[KnownTypes], "RuleSet"]


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleSet:
    """Defaults, floors in Hz, bounds of the receiver's picture and blocks; topics by full name.

    ``bounds`` are those outside blocks, by topic and property; a topic of a bound alone is relayed at
    ``Full``, as is every other one without a default. ``default_reason`` is what decisions give as the reason
    of a default. ``patterns`` in full stand in the files for topics of a kind; ``typed`` are the topics that
    checks compare with constants, each with the type that one names, if it does: what appears, or what is
    known of a type, may give these files another meaning.
    """

    defaults: Mapping[str, Rate]
    default_lines: Mapping[str, int]
    floors_hz: Mapping[str, float]
    blocks: tuple[RuleBlock, ...]
    patterns: tuple[str, ...] = ()
    typed: frozenset[tuple[str, str]] = frozenset()
    default_reason: Reason = Reason.DEFAULT
    bounds: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    default_margins: Mapping[str, MarginRate] = field(default_factory=dict)
    anew: CompileAnew | None = field(default=None, compare=False, repr=False)
    """What gives the same files the meaning that they have with other topics and types."""
    relayed: tuple[str, ...] = field(init=False, compare=False)
    """The topics that are relayed, in order of first mention among defaults, floors, bounds, blocks."""
    signals: frozenset[Signal] = field(init=False, compare=False)
    """Everything that checks and margins read."""

    def __post_init__(self) -> None:
        """Find what is asked for again and again, and costs a walk over all blocks."""
        names = dict.fromkeys([*self.defaults, *self.floors_hz, *self.bounds])
        for block in self.blocks:
            names.update(dict.fromkeys(block.topics))
        object.__setattr__(self, "relayed", tuple(names))
        signals: set[Signal] = set()
        for block in self.blocks:
            signals.update(signals_of(block.form), (margin.signal for margin in block.margins.values()))
        signals.update(margin.signal for margin in self.default_margins.values())
        object.__setattr__(self, "signals", frozenset(signals))

    @property
    def written(self) -> tuple[RuleBlock, ...]:
        """The blocks as the files have them, an If and its Else once."""
        return tuple(block for block in self.blocks if block.checks)

    def by(self, types: KnownTypes) -> RuleSet:
        """The meaning that the files have where ``types`` are known; the same where it depends on none."""
        return self if self.anew is None else self.anew(types)

    @property
    def is_open(self) -> bool:
        """Whether the meaning of the files depends on topics and types that are there."""
        return bool(self.patterns or self.typed)

    @property
    def has_recordings(self) -> bool:
        """Whether any block records."""
        return any(block.recordings for block in self.blocks)

    @property
    def topics_read(self) -> frozenset[str]:
        """The topics that checks and margins read, without the machine and the link."""
        return frozenset(signal.topic for signal in self.signals if not is_source(signal.topic))

    @property
    def recorded(self) -> frozenset[str]:
        """The topics that recordings keep."""
        return frozenset(
            topic for block in self.blocks for recording in block.recordings for topic in recording.topics
        )

    def blocks_by_topic(self, yield_turn: Yield) -> dict[str, list[RuleBlock]]:
        """The blocks that set each relayed topic, in order."""
        blocks: dict[str, list[RuleBlock]] = {topic: [] for topic in self.relayed}
        for block in yielding(self.blocks, yield_turn):
            for topic in block.topics:
                blocks[topic].append(block)
        return blocks

    def over_states(self) -> RuleSet:
        """The same rules for single states, in which what was before is a signal like any other."""
        return replace(
            self, blocks=tuple(replace(block, form=over_states(block.form)) for block in self.blocks)
        )


def _typed(rules: ResolvedRules) -> Iterator[tuple[str, str]]:
    """The topics that checks compare with constants, and the types that these name."""
    for block in rules.blocks:
        for check in block.checks:
            ends = (check.syntax.value, *([] if check.syntax.until is None else [check.syntax.until.value]))
            yield from ((check.signal.topic, end.type_name) for end in ends if isinstance(end, Constant))


def fallback_rules(rates: Mapping[str, Rate], floors_hz: Mapping[str, float] | None = None) -> RuleSet:
    """The rules in force while there are no valid ones: topics at these rates."""
    return RuleSet(
        defaults=rates, default_lines={}, floors_hz=floors_hz or {}, blocks=(), default_reason=Reason.FALLBACK
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
        raise _no_profile(statement.highest.value, "rate", statement.span, path)

    def tier_bound(self, statement: KeepWithin, path: str, /) -> float:
        """Raises ``RuleFileError``."""
        raise _no_profile(statement.bound, "accuracy", statement.span, path)


def _no_profile(value: float | Tier | RateWord, what: str, span: Span, path: str) -> RuleFileError:
    return RuleFileError(
        f"{value.value if isinstance(value, Tier) else value} has no {what} without a profile",
        place=f"{path}:{span.line}:{span.column}",
        remedy="give a number, or a profile with --profile",
    )


def compile_rules(
    files: Sequence[RuleFile],
    resolve: Resolve,
    tiers: TierValues | None = None,
    types: KnownTypes = NO_TYPES,
) -> RuleSet:
    """The meaning of ``files``, which have no errors, as one set; tiers in them need ``tiers``.

    ``types`` says which topics patterns match, and what constants are.
    """
    compiler = _Compiler(resolve=cache(resolve), tiers=tiers or RefusedTiers(), types=types)
    return compiler.rule_set(files)


class _Compiler:
    """Equal parts of what it makes are one object each: in many rules the same signals and limits recur."""

    def __init__(self, *, resolve: Resolve, tiers: TierValues, types: KnownTypes) -> None:
        self._resolve = resolve
        self._types = types
        self._tiers = tiers
        self._regions: dict[InRegion, InRegion] = {}
        self._rates: dict[tuple[tuple[str, Rate], ...], Mapping[str, Rate]] = {}
        self._no_bounds: Mapping[str, Mapping[str, float]] = {}
        self._no_margins: Mapping[str, MarginRate] = {}

    def rule_set(self, files: Sequence[RuleFile]) -> RuleSet:
        resolved = resolve_rules(files, self._resolve, self._types)
        rules = RuleSet(
            defaults={topic: self._rate(default) for topic, default in resolved.defaults.items()},
            default_margins=self._margins(resolved.defaults),
            default_lines={topic: one.span.line for topic, one in resolved.defaults.items()},
            floors_hz=resolved.floors_hz,
            blocks=tuple(map(self._block, resolved.branches)),
            bounds=self._tightest(resolved.always_bounds),
            patterns=tuple(dict.fromkeys(one.pattern for one in resolved.patterns)),
            typed=frozenset(_typed(resolved)),
        )
        if not rules.has_recordings:
            return rules
        names = (*rules.relayed, *sorted(rules.topics_read), *sorted(rules.recorded))
        named = tuple(dict.fromkeys(names))
        blocks = zip(rules.blocks, resolved.branches, strict=True)
        return replace(
            rules, blocks=tuple(_recording_all(block, branch.records, named) for block, branch in blocks)
        )

    def _time_as_written(self, timed: Timed) -> WrittenTime:
        return WrittenTime(
            line=timed.duration.span.line,
            column=timed.duration.span.column,
            word=timed.word,
            held=held_time(timed, self._resolve, self._types),
            duration_ns=timed.duration.ns,
        )

    def _check_as_written(self, check: ResolvedCheck) -> WrittenCheck:
        alone = self._shared_region(InRegion(check.signal, check.region))
        return WrittenCheck(
            line=check.syntax.span.line,
            column=check.syntax.span.column,
            signal=alone.signal,
            region=alone.region,
            latch=check.latch,
        )

    def _shared_form(self, form: Form) -> Form:
        if isinstance(form, InRegion):
            return self._shared_region(form)
        parts = tuple(map(self._shared_form, form.parts))
        return Every(parts) if isinstance(form, Every) else Some(parts)

    def _shared_region(self, found: InRegion) -> InRegion:
        return self._regions.setdefault(found, found)

    def _block(self, branch: Branch) -> RuleBlock:
        rates = {topic: self._rate(setting) for topic, setting in branch.settings.items()}
        resolved, block = branch.block, branch.block.block
        return RuleBlock(
            order=branch.order,
            name=block.name,
            label=branch.label,
            file=resolved.file,
            line=block.span.line,
            column=block.span.column,
            path=resolved.path,
            priority=resolved.priority,
            form=self._shared_form(branch.form),
            rates=self._rates.setdefault(tuple(rates.items()), rates),
            margins=self._margins(branch.settings) or self._no_margins,
            bounds=self._tightest(branch.bounds) or self._no_bounds,
            recordings=tuple(map(_record_request, branch.records)),
            acts=tuple(act_request(act, self._resolve) for act in branch.acts),
            checks=() if branch.is_else else tuple(map(self._check_as_written, resolved.checks)),
            times=() if branch.is_else else tuple(map(self._time_as_written, times_in(block.condition))),
        )

    def _tightest(self, bounds: Iterable[ResolvedBound]) -> Mapping[str, Mapping[str, float]]:
        """Of several bounds of one property the tightest counts."""
        found: dict[str, dict[str, float]] = {}
        for resolved in bounds:
            written = resolved.statement.bound
            bound = (
                self._tiers.tier_bound(resolved.statement, resolved.path)
                if isinstance(written, Tier)
                else written
            )
            of_topic = found.setdefault(resolved.topic, {})
            of_topic[resolved.signal.property] = min(bound, of_topic.get(resolved.signal.property, math.inf))
        return found

    def _rate(self, rate: ResolvedRate) -> Rate:
        return self._end(rate, rate.statement.highest)

    def _end(self, rate: ResolvedRate, end: RateExpression) -> Rate:
        return end.rate or self._tiers.tier_rate(replace(rate.statement, rate=end, margin=None), rate.path)

    def _margins(self, settings: Mapping[str, ResolvedRate]) -> Mapping[str, MarginRate]:
        return {topic: self._margin(rate) for topic, rate in settings.items() if rate.margin is not None}

    def _margin(self, rate: ResolvedRate) -> MarginRate:
        statement, signal = rate.statement, rate.margin
        assert statement.margin is not None and signal is not None  # noqa: PT018
        places = [statement.margin.from_value, statement.margin.to_value]
        ends = [self._end(rate, end) for end in statement.ends]
        (low, low_at), (high, high_at) = sorted(zip(ends, places, strict=True), key=lambda end: end[0])
        return MarginRate(signal=signal, low=low, high=high, low_at=low_at, high_at=high_at)


def _record_request(record: ResolvedRecord) -> RecordRequest:
    return RecordRequest(
        name=record.statement.name,
        line=record.statement.span.line,
        topics=tuple(dict.fromkeys(record.topics)),
        before_ns=record.statement.before.ns,
        after_ns=record.statement.after.ns,
    )


def act_request(act: Act, resolve: Resolve) -> ActRequest:
    """The request of a statement, with the full name of the node or the service."""
    match act:
        case SetParameter(value=value):
            is_whole = isinstance(value, float) and act.text.lstrip("+-").isdigit()
            return ActRequest(
                kind=ActionKind.SET_PARAMETER,
                target=resolve(act.node.text),
                parameter=act.parameter,
                value=int(act.text) if is_whole else value,
            )
        case CallService():
            return ActRequest(kind=ActionKind.CALL, target=resolve(act.service.text), value=act.argument)
        case Notify():
            return ActRequest(kind=ActionKind.NOTIFY, target=act.text)


def _recording_all(block: RuleBlock, records: Sequence[ResolvedRecord], topics: tuple[str, ...]) -> RuleBlock:
    """``block`` whose recordings, made of ``records``, keep ``topics`` where they name none."""
    recordings = tuple(
        recording if record.statement.topics else replace(recording, topics=topics)
        for recording, record in zip(block.recordings, records, strict=True)
    )
    return replace(block, recordings=recordings)
