# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The requirements of rule files on the optimizer: the defaults, then each block's topics."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum

from smarttestudo.domain.accuracy import AccuracyTiers
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.rate import Rate, Tier
from smarttestudo.domain.source import Span
from smarttestudo.language.normal_form import Resolve
from smarttestudo.language.syntax import (
    Block,
    KeepAtLeast,
    KeepWithin,
    RateWord,
    RuleFile,
    SetFrequency,
    Statement,
    bound_span,
    bounds_in,
    sets_in,
)
from smarttestudo.optimizer.model import BoundNeeds, Requirement, TopicNeeds, accuracy_of, needs_of

StatementKey = tuple[str, Span]
"""A file's path and where its rate or bound is written: what a statement is known by."""


class TopicsWithoutDefault(Enum):
    """The treatment of topics for which the files have no default."""

    APPENDED = "every one in the profile gets Unacceptable, as a default"
    COUNTED = "the same, but only where the profile has what that needs"
    LEFT_OUT = "none; those that the files relay are Full, and count as such"


@dataclass(frozen=True, slots=True, kw_only=True)
class Subproblem:
    """Topics that are solved in one go: the defaults (``label`` is ``None``) or one side of a block.

    ``requirements`` are by topic, those of bounds by topic and property. ``tier_statements`` are the
    statements that name a level, with the name of their requirement. ``path`` and ``span`` say where the
    block, or the first default, is.

    A topic takes what its bounds need where that was measured of all of them; its rate is its ceiling then.
    ``ceilings_hz`` are ceilings that are written as levels, ``unmeasured_bounds`` bounds of topics that count
    by their rate. ``kept`` are the requirements of the defaults for topics that a block sets, which go on
    below the ceiling in Hz that it sets.
    """

    label: str | None
    path: str
    span: Span
    requirements: Mapping[str, Requirement]
    tier_statements: tuple[tuple[StatementKey, str], ...]
    ceilings_hz: tuple[tuple[StatementKey, float], ...] = ()
    unmeasured_bounds: tuple[tuple[StatementKey, float], ...] = ()
    kept: Mapping[str, float] = field(default_factory=dict)

    @property
    def place(self) -> str:
        """``file:line:column``."""
        return f"{self.path}:{self.span.line}:{self.span.column}"

    def without_its_topics(self, defaults_hz: Mapping[str, float]) -> dict[str, float]:
        """``defaults_hz`` of other topics, and of what is kept, as far as the ceiling lets it."""
        topics = {topic_of(name) for name in (*self.requirements, *self.kept)}
        others = {name: hz for name, hz in defaults_hz.items() if topic_of(name) not in topics}
        kept = {name: min(defaults_hz[name], limit_hz) for name, limit_hz in self.kept.items()}
        return {**others, **kept}


def topic_of(name: str) -> str:
    """The topic of a requirement, whose name is the topic, or the topic and a property."""
    return name.partition(" ")[0]


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleRequirements:
    """Everything that is asked. ``appended`` are the profile's topics that no default names."""

    defaults: Subproblem
    blocks: tuple[Subproblem, ...]
    appended: tuple[str, ...]


def collect_requirements(
    files: Sequence[RuleFile], profile: Profile, resolve: Resolve, without_default: TopicsWithoutDefault
) -> RuleRequirements:
    """The requirements of ``files``, which have no errors, on the topics in ``profile``.

    Raises ``ProfileError`` where the profile lacks a topic of the rules or an entry that is needed.
    """
    return _Collector(
        files=files, profile=profile, resolve=resolve, without_default=without_default
    ).requirements()


_WrittenRate = float | Tier | RateWord
_Bounds = Mapping[str, float | Tier]
"""The bounds of one topic, by property."""


@dataclass(frozen=True, slots=True)
class _Draft:
    """The requirements of a subproblem so far, and the topics that count by their bounds."""

    requirements: dict[str, Requirement] = field(default_factory=dict)
    kept: dict[str, float] = field(default_factory=dict)
    bound_topics: set[str] = field(default_factory=set)


class _Collector:
    def __init__(
        self,
        *,
        files: Sequence[RuleFile],
        profile: Profile,
        resolve: Resolve,
        without_default: TopicsWithoutDefault,
    ) -> None:
        self._files = files
        self._profile = profile
        self._resolve = resolve
        self._without_default = without_default
        self._floors_hz: dict[str, float] = {}
        for _, statement in self._statements():
            if isinstance(statement, KeepAtLeast) and isinstance(statement.rate.value, int | float):
                topic = resolve(statement.topic.text)
                self._floors_hz[topic] = max(self._floors_hz.get(topic, 0.0), statement.rate.value)
        self._needs: dict[str, TopicNeeds] = {}
        self._bounds = self._by_topic(one for _, one in self._statements() if isinstance(one, KeepWithin))
        self._rates = self._default_rates()

    def requirements(self) -> RuleRequirements:
        defaults, appended = self._defaults()
        blocks = tuple(
            subproblem
            for path, statement in self._statements()
            if isinstance(statement, Block)
            for subproblem in self._sides(path, statement, defaults)
        )
        return RuleRequirements(defaults=defaults, blocks=blocks, appended=appended)

    def _statements(self) -> Iterator[tuple[str, Statement]]:
        return ((file.path, statement) for file in self._files for statement in file.enabled_statements)

    def _default_rates(self) -> dict[str, _WrittenRate]:
        """The defaults of all relayed topics, those that are written first."""
        statements = [statement for _, statement in self._statements()]
        written = [one for one in statements if isinstance(one, SetFrequency)]
        rates = {self._resolve(one.topic.text): one.rate.value for one in written}
        blocks = [one for one in statements if isinstance(one, Block)]
        actions = [one for block in blocks for one in (*block.then, *block.otherwise)]
        named = [one.topic.text for one in sets_in(actions)] + [one.topic.text for one in bounds_in(actions)]
        for topic in (*self._floors_hz, *self._bounds, *map(self._resolve, named)):
            rates.setdefault(topic, RateWord.FULL)
        return rates

    def _defaults(self) -> tuple[Subproblem, tuple[str, ...]]:
        written = [
            (path, one) for path, one in self._statements() if isinstance(one, SetFrequency | KeepWithin)
        ]
        sets = [(path, one) for path, one in written if isinstance(one, SetFrequency)]
        named = dict.fromkeys(self._resolve(one.topic.text) for _, one in sets)
        decided = {*named, *self._bounds}
        appended = tuple(
            topic for topic in self._profile.topics if topic not in decided and self._appends(topic)
        )
        draft = _Draft()
        for topic in named:
            self._add(draft, topic, self._rates[topic], self._bounds.get(topic, {}))
        for topic in appended:
            self._add(draft, topic, Tier.UNACCEPTABLE, {})
        for topic, rate in self._rates.items():
            if topic not in named and topic not in appended:
                self._add(draft, topic, rate, self._bounds.get(topic, {}))
        path, span = next(((path, one.span) for path, one in sets), self._start())
        return self._subproblem(draft, None, path, span, written), appended

    def _appends(self, topic: str) -> bool:
        if self._without_default is TopicsWithoutDefault.COUNTED:
            entry = self._profile.topic(topic)
            return entry.message_kb is not None and entry.tiers_hz is not None
        return self._without_default is TopicsWithoutDefault.APPENDED

    def _start(self) -> tuple[str, Span]:
        first = self._files[0]
        return first.path, first.collections[0].span

    def _sides(self, path: str, block: Block, defaults: Subproblem) -> Iterator[Subproblem]:
        for label, side in ((block.label, block.then), (f"{block.label} (Else)", block.otherwise)):
            sets, bounds = sets_in(side), bounds_in(side)
            rates = {self._resolve(one.topic.text): one.rate.value for one in sets}
            own = self._by_topic(bounds)
            draft = _Draft()
            for topic in dict.fromkeys([*rates, *own]):
                self._add_in_block(draft, topic, rates.get(topic), own.get(topic, {}), defaults)
            if draft.requirements or draft.kept or any(isinstance(one.bound, Tier) for one in bounds):
                written: list[SetFrequency | KeepWithin] = [*sets, *bounds]
                yield self._subproblem(draft, label, path, block.span, ((path, one) for one in written))

    def _add_in_block(
        self,
        draft: _Draft,
        topic: str,
        own_rate: _WrittenRate | None,
        own_bounds: _Bounds,
        defaults: Subproblem,
    ) -> None:
        """Add what the rate and bounds that a block sets require, beside those that it leaves as they are."""
        rate = self._rates[topic] if own_rate is None else own_rate
        bounds = {**self._bounds.get(topic, {}), **own_bounds}
        if self._is_measured(topic, bounds):
            limit_hz = self._ceiling_hz(topic, rate)
            kept = [
                name
                for name in bounds
                if name not in own_bounds and f"{topic} {name}" in defaults.requirements
            ]
            draft.kept.update((f"{topic} {name}", limit_hz) for name in kept)
            self._add_bounds(draft, topic, limit_hz, {n: b for n, b in bounds.items() if n not in kept})
        elif own_rate is not None:
            draft.requirements[topic] = self._required(topic, rate)
        elif topic not in defaults.requirements:
            # The defaults count bounds that are no longer all.
            draft.requirements[topic] = Requirement(
                needs=self._needs_of(topic), wanted=self._ceiling_hz(topic, rate)
            )

    def _add(self, draft: _Draft, topic: str, rate: _WrittenRate, bounds: _Bounds) -> None:
        """Add what a topic requires: its bounds where it is known what they need, else its rate."""
        if self._is_measured(topic, bounds):
            self._add_bounds(draft, topic, self._ceiling_hz(topic, rate), bounds)
        else:
            draft.requirements[topic] = self._required(topic, rate)

    def _add_bounds(self, draft: _Draft, topic: str, limit_hz: float, bounds: _Bounds) -> None:
        draft.bound_topics.add(topic)
        of_topic = self._needs_of(topic)
        for name, bound in bounds.items():
            accuracy = accuracy_of(of_topic, name)
            needs = BoundNeeds(of_topic=of_topic, property_name=name, accuracy=accuracy, limit_hz=limit_hz)
            if isinstance(bound, Tier):
                draft.requirements[needs.name] = Requirement(needs=needs, wanted=bound)
            else:
                needed_hz = max(accuracy.needed_hz(bound), of_topic.floor_hz)
                draft.requirements[needs.name] = Requirement(needs=needs, wanted=min(needed_hz, limit_hz))

    def _is_measured(self, topic: str, bounds: _Bounds) -> bool:
        """Whether it is known of all bounds, and there are any, what they need."""
        entry = self._profile.topic(topic)
        return bool(bounds) and all(_is_known(entry.accuracy(name), bound) for name, bound in bounds.items())

    def _by_topic(self, bounds: Iterable[KeepWithin]) -> dict[str, dict[str, float | Tier]]:
        """The bounds by topic and property: the tightest, where a level comes before numbers."""
        found: dict[str, dict[str, float | Tier]] = {}
        for one in bounds:
            of_topic = found.setdefault(self._resolve(one.topic.text), {})
            of_topic[one.property] = min(one.bound, of_topic.get(one.property, math.inf), key=_tightness)
        return found

    def _subproblem(
        self,
        draft: _Draft,
        label: str | None,
        path: str,
        span: Span,
        written: Iterable[tuple[str, SetFrequency | KeepWithin]],
    ) -> Subproblem:
        tier_statements: list[tuple[StatementKey, str]] = []
        ceilings_hz: list[tuple[StatementKey, float]] = []
        unmeasured: list[tuple[StatementKey, float]] = []
        for of_path, one in written:
            topic = self._resolve(one.topic.text)
            if isinstance(one, SetFrequency) and isinstance(one.rate.value, Tier):
                key = (of_path, one.rate.span)
                if topic in draft.bound_topics:
                    ceilings_hz.append((key, self._ceiling_hz(topic, one.rate.value)))
                else:
                    tier_statements.append((key, topic))
            elif isinstance(one, KeepWithin) and isinstance(one.bound, Tier):
                key, name = (of_path, bound_span(one)), f"{topic} {one.property}"
                if name in draft.requirements:
                    tier_statements.append((key, name))
                else:
                    accuracy = accuracy_of(self._needs_of(topic), one.property)
                    unmeasured.append((key, accuracy.interval(one.bound)[1]))
        return Subproblem(
            label=label,
            path=path,
            span=span,
            requirements=draft.requirements,
            tier_statements=tuple(tier_statements),
            ceilings_hz=tuple(ceilings_hz),
            unmeasured_bounds=tuple(unmeasured),
            kept=draft.kept,
        )

    def _ceiling_hz(self, topic: str, value: _WrittenRate) -> float:
        """The rate that a bound topic never exceeds; infinite for Full of a source of unknown rate."""
        needs = self._needs_of(topic)
        source_hz = math.inf if needs.entry.source_hz is None else needs.entry.source_hz
        if isinstance(value, Tier):
            return max(min(needs.tiers_hz[value.level], source_hz), needs.floor_hz)
        return source_hz if value is RateWord.FULL else self._written_hz(topic, value)

    def _written_hz(self, topic: str, value: float | RateWord) -> float:
        rate = Rate.off() if isinstance(value, RateWord) else Rate(value)
        return rate.at_least(self._floors_hz.get(topic, 0.0)).hz

    def _required(self, topic: str, value: _WrittenRate) -> Requirement:
        needs = self._needs_of(topic)
        if isinstance(value, Tier):
            return Requirement(needs=needs, wanted=value)
        if value is RateWord.FULL:
            return Requirement(needs=needs, wanted=needs.source_hz)
        return Requirement(needs=needs, wanted=self._written_hz(topic, value))

    def _needs_of(self, topic: str) -> TopicNeeds:
        if topic not in self._needs:
            floor_hz = self._floors_hz.get(topic, 0.0)
            self._needs[topic] = needs_of(topic, self._profile, keep_at_least_hz=floor_hz)
        return self._needs[topic]


def _is_known(accuracy: AccuracyTiers | None, bound: float | Tier) -> bool:
    if accuracy is None or accuracy.needs_hz is None:
        return False
    return isinstance(bound, Tier) or accuracy.needed_hz(bound) < math.inf


def _tightness(bound: float | Tier) -> tuple[bool, float]:
    return (False, -bound.level) if isinstance(bound, Tier) else (True, bound)
