# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The requirements of rule files on the optimizer: the defaults, then each block's topics."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import Enum
from functools import cache

from smarttestudo.domain.finding import Span
from smarttestudo.domain.profile import AccuracyTiers, Profile
from smarttestudo.domain.rate import SLOW_HZ, Rate, Tier
from smarttestudo.language.known_types import NO_TYPES, KnownTypes
from smarttestudo.language.normal_form import Resolve
from smarttestudo.language.resolved_rules import Branch, ResolvedBound, ResolvedRate, resolve_rules
from smarttestudo.language.syntax import (
    RateWord,
    RuleFile,
)
from smarttestudo.language.syntax_walks import (
    bound_span,
)
from smarttestudo.optimizer.model import BoundNeeds, Requirement, TopicNeeds, accuracy_of, needs_of

StatementKey = tuple[str, Span]
"""A file's path and where its rate or bound is written: what a statement is known by."""


class TopicsWithoutDefault(Enum):
    """The treatment of topics for which the files have no default."""

    APPENDED = (
        "every one that the profile knows gets Unacceptable as a default, a slow one without levels Full"
    )
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
    below the ceiling in Hz that it sets. ``below_default`` are topics with bounds whose ceiling is a default
    that is solved first; ``unlimited`` is what this was before that default was known.
    """

    label: str | None
    path: str
    span: Span
    requirements: Mapping[str, Requirement]
    tier_statements: tuple[tuple[StatementKey, str], ...]
    ceilings_hz: tuple[tuple[StatementKey, float], ...] = ()
    unmeasured_bounds: tuple[tuple[StatementKey, float], ...] = ()
    kept: Mapping[str, float] = field(default_factory=dict)
    below_default: frozenset[str] = frozenset()
    unlimited: Subproblem | None = None

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

    def limited(self, defaults_hz: Mapping[str, float]) -> Subproblem:
        """The subproblem with the rates that the defaults got as the ceilings of ``below_default``."""
        if not self.below_default:
            return self
        unlimited = self.unlimited or self
        limited = {
            name: one.limited(defaults_hz[topic_of(name)]) if topic_of(name) in self.below_default else one
            for name, one in unlimited.requirements.items()
        }
        return replace(self, requirements=limited, unlimited=unlimited)


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
    files: Sequence[RuleFile],
    profile: Profile,
    resolve: Resolve,
    without_default: TopicsWithoutDefault,
    types: KnownTypes = NO_TYPES,
) -> RuleRequirements:
    """The requirements of ``files``, which have no errors, on the topics in ``profile``.

    ``types`` has the topics that patterns match.

    Raises ``ProfileError`` where the profile lacks a topic of the rules or an entry that is needed.
    """
    return _Collector(files, profile, resolve, without_default, types).requirements()


_WrittenRate = float | Tier | RateWord
_Bounds = Mapping[str, float | Tier]
"""The bounds of one topic, by property."""


@dataclass(frozen=True, slots=True)
class _Draft:
    """A subproblem so far: its requirements, and the topics that count by their bounds."""

    label: str | None
    path: str
    span: Span
    requirements: dict[str, Requirement] = field(default_factory=dict)
    kept: dict[str, float] = field(default_factory=dict)
    bound_topics: set[str] = field(default_factory=set)
    below_default: set[str] = field(default_factory=set)


class _Collector:
    def __init__(
        self,
        files: Sequence[RuleFile],
        profile: Profile,
        resolve: Resolve,
        without_default: TopicsWithoutDefault,
        types: KnownTypes,
    ) -> None:
        self._start = files[0].path, files[0].collections[0].span
        self._rules = resolve_rules(files, cache(resolve), types)
        self._profile = profile
        self._without_default = without_default
        self._floors_hz = self._rules.floors_hz
        self._needs: dict[str, TopicNeeds] = {}
        self._bounds = _tightest(self._rules.always_bounds)
        self._rates = self._default_rates()

    def requirements(self) -> RuleRequirements:
        defaults, appended = self._defaults()
        blocks = (self._side(branch, defaults) for branch in self._rules.branches)
        return RuleRequirements(
            defaults=defaults, blocks=tuple(one for one in blocks if one is not None), appended=appended
        )

    def _default_rates(self) -> dict[str, _WrittenRate]:
        """The defaults of all relayed topics, those that are written first."""
        rates = {one.topic: one.statement.highest.value for one in self._rules.written_defaults}
        named = [topic for branch in self._rules.branches for topic in branch.settings]
        named += [one.topic for branch in self._rules.branches for one in branch.bounds]
        for topic in (*self._floors_hz, *self._bounds, *named):
            rates.setdefault(topic, RateWord.FULL)
        return rates

    def _defaults(self) -> tuple[Subproblem, tuple[str, ...]]:
        written = self._rules.written_defaults
        named = self._rules.defaults
        # A default that is appended would be the ceiling of the bounds in blocks.
        decided = {*named, *self._bounds, *_bound_without_rate(self._rules.branches)}
        appended = tuple(
            topic for topic in self._profile.topics if topic not in decided and self._appends(topic)
        )
        path, span = (written[0].path, written[0].span) if written else self._start
        draft = _Draft(None, path, span)
        for topic in named:
            self._add(draft, topic, self._rates[topic], self._bounds.get(topic, {}))
        for topic in appended:
            self._add(draft, topic, RateWord.FULL if self._is_slow(topic) else Tier.UNACCEPTABLE, {})
        for topic, rate in self._rates.items():
            if topic not in named and topic not in appended:
                self._add(draft, topic, rate, self._bounds.get(topic, {}))
        return self._subproblem(draft, written, self._rules.always_bounds), appended

    def _appends(self, topic: str) -> bool:
        entry = self._profile.topic(topic)
        if self._without_default is TopicsWithoutDefault.COUNTED:
            return entry.message_kb is not None and (entry.tiers_hz is not None or self._is_slow(topic))
        # A topic of which no message was measured has neither.
        is_known = (entry.message_kb, entry.source_hz, entry.tiers_hz) != (None, None, None)
        return self._without_default is TopicsWithoutDefault.APPENDED and is_known

    def _is_slow(self, topic: str) -> bool:
        """Whether a topic has no levels, and needs none: maps, static frames and the like."""
        entry = self._profile.topic(topic)
        return entry.tiers_hz is None and entry.source_hz is not None and entry.source_hz <= SLOW_HZ

    def _side(self, branch: Branch, defaults: Subproblem) -> Subproblem | None:
        """The subproblem of one side of a block; ``None`` where it requires nothing."""
        rates = {topic: one.statement.highest.value for topic, one in branch.settings.items()}
        own = _tightest(branch.bounds)
        draft = _Draft(branch.label, branch.block.path, branch.block.block.span)
        for topic in dict.fromkeys([*rates, *own]):
            self._add_in_block(draft, topic, rates.get(topic), own.get(topic, {}), defaults)
        has_tier = any(isinstance(one.statement.bound, Tier) for one in branch.bounds)
        if not (draft.requirements or draft.kept or has_tier):
            return None
        return self._subproblem(draft, branch.written, branch.bounds)

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
            required = defaults.requirements.get(topic)
            if own_rate is None and required is not None and isinstance(required.wanted, Tier):
                draft.below_default.add(topic)
                rate = RateWord.FULL
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
                needed_hz = max(accuracy.needed_hz(bound) / of_topic.entry.streams, of_topic.floor_hz)
                draft.requirements[needs.name] = Requirement(needs=needs, wanted=min(needed_hz, limit_hz))

    def _is_measured(self, topic: str, bounds: _Bounds) -> bool:
        """Whether it is known of all bounds, and there are any, what they need."""
        entry = self._profile.topic(topic)
        return bool(bounds) and all(_is_known(entry.accuracy(name), bound) for name, bound in bounds.items())

    def _subproblem(
        self, draft: _Draft, rates: Iterable[ResolvedRate], bounds: Iterable[ResolvedBound]
    ) -> Subproblem:
        tier_statements: list[tuple[StatementKey, str]] = []
        ceilings_hz: list[tuple[StatementKey, float]] = []
        unmeasured: list[tuple[StatementKey, float]] = []
        for rate in rates:
            for end in rate.statement.ends:
                tier, key = end.value, (rate.path, end.span)
                if not isinstance(tier, Tier):
                    continue
                if rate.topic in draft.bound_topics or end is not rate.statement.highest:
                    ceilings_hz.append((key, self._ceiling_hz(rate.topic, tier)))
                else:
                    tier_statements.append((key, rate.topic))
        for one in bounds:
            tier, name = one.statement.bound, f"{one.topic} {one.statement.property}"
            if isinstance(tier, Tier):
                key = (one.path, bound_span(one.statement))
                if name in draft.requirements:
                    tier_statements.append((key, name))
                else:
                    accuracy = accuracy_of(self._needs_of(one.topic), one.statement.property)
                    unmeasured.append((key, accuracy.interval(tier)[1]))
        return Subproblem(
            label=draft.label,
            path=draft.path,
            span=draft.span,
            requirements=draft.requirements,
            tier_statements=tuple(tier_statements),
            ceilings_hz=tuple(ceilings_hz),
            unmeasured_bounds=tuple(unmeasured),
            kept=draft.kept,
            below_default=frozenset(draft.below_default),
        )

    def _ceiling_hz(self, topic: str, value: _WrittenRate) -> float:
        """The rate that a bound topic never exceeds; infinite for Full of a source of unknown rate."""
        needs = self._needs_of(topic)
        source_hz = math.inf if needs.entry.stream_hz is None else needs.entry.stream_hz
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


def _bound_without_rate(branches: Iterable[Branch]) -> set[str]:
    """Topics that a side of a block bounds without a rate of its own: their default is the ceiling."""
    return {one.topic for branch in branches for one in branch.bounds if one.topic not in branch.settings}


def _is_known(accuracy: AccuracyTiers | None, bound: float | Tier) -> bool:
    if accuracy is None or accuracy.needs_hz is None:
        return False
    return isinstance(bound, Tier) or accuracy.needed_hz(bound) < math.inf


def _tightest(bounds: Iterable[ResolvedBound]) -> dict[str, dict[str, float | Tier]]:
    """The bounds by topic and property: the tightest, where a level comes before numbers."""
    found: dict[str, dict[str, float | Tier]] = {}
    for one in bounds:
        of_topic, name = found.setdefault(one.topic, {}), one.statement.property
        of_topic[name] = min(one.statement.bound, of_topic.get(name, math.inf), key=_tightness)
    return found


def _tightness(bound: float | Tier) -> tuple[bool, float]:
    return (False, -bound.level) if isinstance(bound, Tier) else (True, bound)
