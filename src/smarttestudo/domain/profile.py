# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Profile of a robot: facts about its topics and the link they travel on."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from enum import Enum

from smarttestudo.domain.accuracy import AccuracyTiers, LevelledProperty


class LevelUnit(Enum):
    """How a BatteryState counts ``percentage``."""

    PERCENT = "percent"
    FRACTION = "fraction"


@dataclass(frozen=True, slots=True, kw_only=True)
class TopicProfile:
    """One topic of a profile; every entry is optional until something needs it.

    ``message_kb`` is in KB of 1000 B. Messages of some types name ``streams``, each of which has the rate of
    the topic: so many messages pass at 1 Hz, as far as the source has them. ``tiers_hz`` are the six rates
    τ0 … τ5 in Hz, ``min_hz`` the floor of the budget models and ``max_hz`` their ceiling, ``stale_after_s``
    the age in seconds at which values of the topic count as unknown, ``paced_with`` the topic whose passed
    stamps this one follows, ``accuracies`` the levels of bounds.
    """

    type_name: str | None = None
    message_kb: float | None = None
    source_hz: float | None = None
    streams: float = 1.0
    tiers_hz: tuple[float, ...] | None = None
    priority: float = 1.0
    min_hz: float | None = None
    max_hz: float | None = None
    stale_after_s: float | None = None
    paced_with: str | None = None
    level_unit: LevelUnit | None = None
    accuracies: Mapping[LevelledProperty, AccuracyTiers] = field(default_factory=dict)

    @property
    def kb_per_hz(self) -> float | None:
        """Bandwidth of 1 Hz of the topic, in KB/s."""
        return None if self.message_kb is None else self.message_kb * self.streams

    @property
    def stream_hz(self) -> float | None:
        """The rate from which all messages pass: the source's of each stream."""
        return None if self.source_hz is None else self.source_hz / self.streams

    def accuracy(self, name: str) -> AccuracyTiers | None:
        """The levels of the property ``name``, if there are any."""
        return next((tiers for one, tiers in self.accuracies.items() if one.value == name), None)

    def needed_hz(self, within: Mapping[str, float]) -> float:
        """The mean rate that bounds by property need together; infinite where there is one of unknown need.

        They count as if no message served two of them.
        """
        if not within:
            return math.inf
        needs_hz = 0.0
        for name, bound in within.items():
            tiers = self.accuracy(name)
            needs_hz += math.inf if tiers is None else tiers.needed_hz(bound)
        return needs_hz


_EMPTY = TopicProfile()


@dataclass(frozen=True, slots=True, kw_only=True)
class Profile:
    """Topics by full name, the link's budget in KB/s, and how long a lower rate waits, in seconds."""

    budget_kb_per_s: float | None = None
    settle_s: float = 0.5
    topics: Mapping[str, TopicProfile] = field(default_factory=dict)
    path: str = ""

    def topic(self, name: str) -> TopicProfile:
        """The entry of ``name``, or an empty one."""
        return self.topics.get(name, _EMPTY)

    def resolved(self, resolve: Callable[[str], str]) -> Profile:
        """This profile with every topic, also those paced with, by the name that ``resolve`` gives it."""
        topics = {
            resolve(name): topic
            if topic.paced_with is None
            else replace(topic, paced_with=resolve(topic.paced_with))
            for name, topic in self.topics.items()
        }
        return replace(self, topics=topics)
