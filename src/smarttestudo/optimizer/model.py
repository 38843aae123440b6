# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The five models: which rates a topic may get, and what they are worth."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum

from smarttestudo.domain.errors import ProfileError
from smarttestudo.domain.profile import Profile, TopicProfile
from smarttestudo.domain.rate import Tier
from smarttestudo.optimizer.problem import Demand, Piece
from smarttestudo.optimizer.quality import envelope_pieces, interval_hz


class Model(Enum):
    """What OBI maximises; the value is its name on the command line.

    The first three are those of the thesis (Riccardi 2025): the sum of all rates within the intervals of the
    levels (quper) or within [min_hz, max_hz] (budget), and that sum weighted by priority. ``benefit`` sums
    quality instead of hertz, ``maxmin`` raises the lowest quality first, then the next (lexicographic).
    """

    QUPER = "quper"
    BUDGET = "budget"
    PRIORITY = "priority"
    BENEFIT = "benefit"
    MAXMIN = "maxmin"


class MissingEntryError(ProfileError):
    """A profile that lacks ``key`` of ``topic``, all of the topic (no key), or the budget (no topic)."""

    def __init__(self, cause: str, *, path: str, remedy: str, topic: str | None, key: str | None) -> None:
        super().__init__(cause, place=path or None, remedy=remedy)
        self.topic = topic
        self.key = key


@dataclass(frozen=True, slots=True, kw_only=True)
class TopicNeeds:
    """What the optimizer knows of one topic: its profile, and the floor of KeepAtLeast and min_hz in Hz.

    Asking for an entry that the profile lacks raises ``MissingEntryError``.
    """

    topic: str
    entry: TopicProfile
    floor_hz: float
    profile_path: str

    @property
    def size_kb(self) -> float:
        """The mean message size in KB."""
        if self.entry.message_kb is None:
            raise self._missing("message_kb", "its mean message size in KB")
        return self.entry.message_kb

    @property
    def tiers_hz(self) -> Sequence[float]:
        """τ0 … τ5 in Hz."""
        if self.entry.tiers_hz is None:
            raise self._missing("tiers_hz", "six rates τ0 … τ5 in Hz")
        return self.entry.tiers_hz

    @property
    def source_hz(self) -> float:
        """The rate of the robot's topic in Hz."""
        if self.entry.source_hz is None:
            raise self._missing("source_hz", "its rate in Hz, which Full passes on")
        return self.entry.source_hz

    @property
    def ceiling_hz(self) -> float:
        """The highest rate of the models without levels: max_hz, else source_hz, else τ5."""
        if self.entry.max_hz is not None:
            return self.entry.max_hz
        if self.entry.source_hz is not None:
            return self.entry.source_hz
        if self.entry.tiers_hz is not None:
            return self.entry.tiers_hz[-1]
        raise self._missing("max_hz", "the highest useful rate in Hz")

    def _missing(self, key: str, what: str) -> MissingEntryError:
        return MissingEntryError(
            f'[topics."{self.topic}"] has no {key}',
            path=self.profile_path,
            remedy=f"add {key}, {what}",
            topic=self.topic,
            key=key,
        )


def needs_of(topic: str, profile: Profile, *, keep_at_least_hz: float = 0.0) -> TopicNeeds:
    """What ``profile`` says of ``topic``; ``MissingEntryError`` where it does not know the topic."""
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


def bounds_hz(model: Model, needs: TopicNeeds, tier: Tier) -> tuple[float, float]:
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
            source_hz = math.inf if needs.entry.source_hz is None else needs.entry.source_hz
            low_hz, high_hz = (min(end, source_hz) for end in interval_hz(tier, needs.tiers_hz))
    low_hz = max(low_hz, needs.floor_hz)
    return low_hz, max(low_hz, high_hz)


@dataclass(frozen=True, slots=True, kw_only=True)
class Ask:
    """What a rule file asks for one topic: a quality level, or a rate in Hz that is fixed."""

    needs: TopicNeeds
    wanted: Tier | float

    def bounds_hz(self, model: Model) -> tuple[float, float]:
        """The lowest and highest rate that may be given under ``model``."""
        if isinstance(self.wanted, Tier):
            return bounds_hz(model, self.needs, self.wanted)
        return self.wanted, self.wanted

    def demand(self, model: Model) -> Demand:
        """The ask in the terms of a solver; maxmin has no worths that add up, so no pieces."""
        least_hz, most_hz = self.bounds_hz(model)
        pieces = _pieces(model, self.needs, least_hz, most_hz) if most_hz > least_hz else ()
        return Demand(topic=self.needs.topic, size_kb=self.needs.size_kb, least_hz=least_hz, pieces=pieces)


def _pieces(model: Model, needs: TopicNeeds, least_hz: float, most_hz: float) -> tuple[Piece, ...]:
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
