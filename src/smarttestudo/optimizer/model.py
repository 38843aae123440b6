# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The five models: which rates a topic may get, and what they are worth."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import Enum

from smarttestudo.domain.errors import ProfileError
from smarttestudo.domain.profile import AccuracyTiers, LevelledProperty, Profile, TopicProfile, rounded_up
from smarttestudo.domain.rate import Tier
from smarttestudo.optimizer.problem import Demand, Piece, envelope_pieces, interval_hz

_LEVELS = (
    "its six levels in Hz, as in [1, 2, 5, 10, 15, 20], or write a rate, as 4, Full or Off, in place of its "
    "level in the rules"
)


class Model(Enum):
    """The goal that OBI maximises; the value is its name on the command line.

    The first three are those of the thesis (Riccardi 2025): the sum of all rates within the intervals of the
    levels (quper) or within [min_hz, max_hz] (budget), and that sum weighted by priority. ``benefit`` sums
    quality instead of hertz, ``maxmin`` raises the lowest quality first, then the next (lexicographic).
    """

    QUPER = "quper"
    BUDGET = "budget"
    PRIORITY = "priority"
    BENEFIT = "benefit"
    MAXMIN = "maxmin"

    every_hz_counts: bool
    """Whether a higher rate, within the bounds of its level, is always worth more."""

    def __init__(self, name: str) -> None:
        self.every_hz_counts = name in {"quper", "budget", "priority"}


class MissingEntryError(ProfileError):
    """A profile that lacks ``key`` of ``topic``, all of the topic (no key), or the budget (no topic)."""

    def __init__(self, cause: str, *, path: str, remedy: str, topic: str | None, key: str | None) -> None:
        super().__init__(cause, place=path or None, remedy=remedy)
        self.topic = topic
        self.key = key


@dataclass(frozen=True, slots=True, kw_only=True)
class TopicNeeds:
    """The optimizer's knowledge of one topic: its profile, and the floor of KeepAtLeast and min_hz in Hz.

    Asking for an entry that the profile lacks raises ``MissingEntryError``.
    """

    topic: str
    entry: TopicProfile
    floor_hz: float
    profile_path: str

    @property
    def name(self) -> str:
        """Its name in messages and tables."""
        return self.topic

    @property
    def most_hz(self) -> float:
        """A rate above which nothing is given, whatever the level says."""
        return math.inf

    @property
    def has_tiers(self) -> bool:
        """Whether rates have levels."""
        return self.entry.tiers_hz is not None

    @property
    def size_kb(self) -> float:
        """Bandwidth of 1 Hz, in KB/s: the mean message size in KB, for each stream."""
        if self.entry.kb_per_hz is None:
            raise self.missing("message_kb", "its mean message size in KB")
        return self.entry.kb_per_hz

    @property
    def tiers_hz(self) -> Sequence[float]:
        """τ0 … τ5 in Hz."""
        if self.entry.tiers_hz is None:
            raise self.missing("tiers_hz", _LEVELS)
        return self.entry.tiers_hz

    @property
    def source_hz(self) -> float:
        """The rate of the robot's topic in Hz."""
        if self.entry.stream_hz is None:
            raise self.missing("source_hz", "its rate in Hz, which Full passes on")
        return self.entry.stream_hz

    @property
    def ceiling_hz(self) -> float:
        """The highest rate of the models without levels: max_hz, else source_hz, else τ5."""
        if self.entry.max_hz is not None:
            return self.entry.max_hz
        if self.entry.stream_hz is not None:
            return self.entry.stream_hz
        if self.entry.tiers_hz is not None:
            return self.entry.tiers_hz[-1]
        raise self.missing("max_hz", "the highest useful rate in Hz")

    def missing(self, key: str, what: str) -> MissingEntryError:
        """That the profile lacks ``key`` of this topic."""
        return MissingEntryError(
            f'[topics."{self.topic}"] has no {key}',
            path=self.profile_path,
            remedy=f"add {key}, {what}",
            topic=self.topic,
            key=key,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class BoundNeeds:
    """The optimizer's knowledge of a bound of one property: its levels, as the rates that they need.

    ``limit_hz`` is the topic's ceiling, which no bound costs more than.
    """

    of_topic: TopicNeeds
    property_name: str
    accuracy: AccuracyTiers
    limit_hz: float

    @property
    def topic(self) -> str:
        return self.of_topic.topic

    @property
    def name(self) -> str:
        """Topic and property."""
        return f"{self.topic} {self.property_name}"

    @property
    def entry(self) -> TopicProfile:
        return self.of_topic.entry

    @property
    def size_kb(self) -> float:
        """The mean message size in KB."""
        return self.of_topic.size_kb

    @property
    def has_tiers(self) -> bool:
        return True

    @property
    def tiers_hz(self) -> Sequence[float]:
        """The rates that α0 … α5 need."""
        needs_hz = self.accuracy.needs_hz or ()
        return [min(rate_hz / self.entry.streams, self.limit_hz) for rate_hz in needs_hz]

    @property
    def floor_hz(self) -> float:
        """The rate that α0 needs, or the topic's floor: no bound is looser than that of Unacceptable."""
        return min(max(self.of_topic.floor_hz, self.tiers_hz[0]), self.limit_hz)

    @property
    def most_hz(self) -> float:
        """The rate that α5 needs: nothing is known of tighter bounds."""
        return max(self.tiers_hz[-1], self.floor_hz)

    @property
    def ceiling_hz(self) -> float:
        """The highest rate of the models without levels."""
        return self.most_hz

    def bound(self, rate_hz: float, wanted: Tier, model: Model) -> float:
        """The tightest bound that ``wanted`` allows and ``rate_hz`` keeps, in four digits."""
        loosest, tightest = self.accuracy.bounds[0], self.accuracy.bounds[-1]
        if model not in {Model.BUDGET, Model.PRIORITY}:
            loosest, tightest = self.accuracy.interval(wanted)
        if rate_hz >= self.limit_hz:
            return tightest
        found = self.accuracy.tightest_within(rate_hz)
        return min(max(rounded_up(found), tightest), loosest)


Needs = TopicNeeds | BoundNeeds


def needs_of(topic: str, profile: Profile, *, keep_at_least_hz: float = 0.0) -> TopicNeeds:
    """The entry of ``profile`` on ``topic``; ``MissingEntryError`` where it does not know the topic."""
    entry = profile.topics.get(topic)
    if entry is None:
        raise MissingEntryError(
            f"{topic} is in the rules but not in the profile",
            path=profile.path,
            remedy=f'add [topics."{topic}"]',
            topic=topic,
            key=None,
        )
    floor_hz = max(keep_at_least_hz, entry.min_hz or 0.0)
    return TopicNeeds(topic=topic, entry=entry, floor_hz=floor_hz, profile_path=profile.path)


def accuracy_of(needs: TopicNeeds, name: str) -> AccuracyTiers:
    """The levels of the property ``name``; ``MissingEntryError`` where the profile has none."""
    found = needs.entry.accuracy(name)
    if found is not None:
        return found
    known = next((one for one in LevelledProperty if one.value == name), None)
    if known is not None:
        raise needs.missing(known.tiers_key, f"six accuracies α0 … α5 of {name} in {known.unit}")
    levelled = [one.value for one in LevelledProperty]
    raise MissingEntryError(
        f"{name} of {needs.topic} has no quality levels, only {', '.join(levelled)} have",
        path=needs.profile_path,
        remedy="write a number in the rules",
        topic=needs.topic,
        key=None,
    )


def bounds_hz(model: Model, needs: Needs, tier: Tier) -> tuple[float, float]:
    """The lowest and highest rate that ``tier`` allows under ``model``; floors win over levels.

    The budget and priority models do not look at levels. Benefit and maxmin do not pay for rates above the
    source's, which bring nothing; to the quper model the source's rate is unknown, as in the thesis.
    """
    match model:
        case Model.QUPER:
            low_hz, high_hz = interval_hz(tier, needs.tiers_hz)
        case Model.BUDGET | Model.PRIORITY:
            low_hz, high_hz = 0.0, needs.ceiling_hz
        case Model.BENEFIT | Model.MAXMIN:
            source_hz = math.inf if needs.entry.stream_hz is None else needs.entry.stream_hz
            low_hz, high_hz = (min(end, source_hz) for end in interval_hz(tier, needs.tiers_hz))
    low_hz = max(low_hz, needs.floor_hz)
    return low_hz, max(low_hz, min(high_hz, needs.most_hz))


@dataclass(frozen=True, slots=True, kw_only=True)
class Requirement:
    """The need of a rule file for a topic or a bound of it: a quality level, or a fixed rate in Hz."""

    needs: Needs
    wanted: Tier | float

    def bounds_hz(self, model: Model) -> tuple[float, float]:
        """The lowest and highest rate that may be given under ``model``."""
        if isinstance(self.wanted, Tier):
            return bounds_hz(model, self.needs, self.wanted)
        return self.wanted, self.wanted

    def limited(self, ceiling_hz: float) -> Requirement:
        """The same requirement, of a bound below another ceiling that is lower."""
        if not isinstance(self.needs, BoundNeeds):
            return self
        limit_hz = min(self.needs.limit_hz, ceiling_hz)
        wanted = self.wanted if isinstance(self.wanted, Tier) else min(self.wanted, limit_hz)
        return Requirement(needs=replace(self.needs, limit_hz=limit_hz), wanted=wanted)

    def bound(self, rate_hz: float, model: Model) -> float | None:
        """The bound that ``rate_hz`` stands for; ``None`` where no level of a bound is asked for."""
        if isinstance(self.needs, BoundNeeds) and isinstance(self.wanted, Tier):
            return self.needs.bound(rate_hz, self.wanted, model)
        return None

    def demand(self, model: Model, least_hz: float, most_hz: float) -> Demand:
        """The requirement between its bounds in the terms of a solver.

        maxmin has no worths that add up, so no pieces.
        """
        pieces = _pieces(model, self.needs, least_hz, most_hz) if most_hz > least_hz else ()
        return Demand(topic=self.needs.name, size_kb=self.needs.size_kb, least_hz=least_hz, pieces=pieces)


def _pieces(model: Model, needs: Needs, least_hz: float, most_hz: float) -> tuple[Piece, ...]:
    priority = needs.entry.priority
    match model:
        case Model.QUPER | Model.BUDGET:
            return (Piece(most_hz - least_hz, 1.0),)
        case Model.PRIORITY:
            return (Piece(most_hz - least_hz, priority),)
        case Model.BENEFIT:
            return envelope_pieces(needs.tiers_hz, least_hz=least_hz, most_hz=most_hz, priority=priority)
        case Model.MAXMIN:
            return ()
