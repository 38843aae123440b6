# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Profile of a robot: facts about its topics, levels of accuracy, and the budget of its link."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from enum import Enum
from numbers import Real

from smarttestudo.domain.action import ActionKind, ActRequest
from smarttestudo.domain.rate import Tier


class LevelledProperty(Enum):
    """A property whose accuracy can have quality levels; the value is its name in a rule file."""

    POSITION = "position"
    ORIENTATION = "orientation"
    POSITIONS = "positions"

    @property
    def unit(self) -> str:
        """The unit in a profile's keys: m, deg or rad."""
        return {"position": "m", "orientation": "deg", "positions": "rad"}[self.value]

    @property
    def tiers_key(self) -> str:
        """The profile's key of the accuracies."""
        return f"tiers_{self.unit}"

    @property
    def needs_key(self) -> str:
        """The profile's key of the rates that they need."""
        return f"{self.tiers_key}_need_hz"


@dataclass(frozen=True, slots=True, kw_only=True)
class AccuracyTiers:
    """Six accuracies α0 … α5 of one property that do not rise, and what they need.

    ``bounds`` are in the property's unit. ``needs_hz`` are the mean rates, which do not fall, that keeping
    within each of them was measured to need; ``None`` where it was not.
    """

    bounds: tuple[float, ...]
    needs_hz: tuple[float, ...] | None = None

    def interval(self, tier: Tier) -> tuple[float, float]:
        """The loosest and the tightest bound of a level.

        Unacceptable is α0 and Excessive α5, since beyond them nothing is said.
        """
        level = tier.level
        if tier in {Tier.UNACCEPTABLE, Tier.EXCESSIVE}:
            return self.bounds[level], self.bounds[level]
        return self.bounds[level - 1], self.bounds[level]

    def needed_hz(self, bound: float) -> float:
        """The rate that ``bound`` needs.

        Between two accuracies it is on the line between theirs, from α0 on that of α0; infinite where a
        tighter bound than α5 is asked for, or nothing was measured.
        """
        if self.needs_hz is None:
            return math.inf
        if bound >= self.bounds[0]:
            return self.needs_hz[0]
        for (loose, low_hz), (tight, high_hz) in self._segments():
            if tight <= bound < loose:
                return high_hz + (low_hz - high_hz) * (bound - tight) / (loose - tight)
        return math.inf

    def tightest_within(self, rate_hz: float) -> float:
        """The tightest bound that ``rate_hz`` keeps, α0 where it keeps none; ``needs_hz`` must be known."""
        tightest = self.bounds[0]
        for (loose, low_hz), (tight, high_hz) in self._segments():
            if high_hz <= rate_hz:
                tightest = tight
            elif low_hz < rate_hz:
                return loose + (tight - loose) * (rate_hz - low_hz) / (high_hz - low_hz)
        return tightest

    def _segments(self) -> Iterator[tuple[tuple[float, float], tuple[float, float]]]:
        return itertools.pairwise(zip(self.bounds, self.needs_hz or (), strict=True))


_DIGITS = 4
_NOISE = 1e-12


def rounded_up(bound: float) -> float:
    """``bound`` in four significant digits, never tighter than it was but for float noise."""
    if not 0 < bound < math.inf:
        return bound
    step = 10.0 ** (math.floor(math.log10(bound)) + 1 - _DIGITS)
    near = float(f"{bound:.{_DIGITS}g}")
    return near if near >= bound * (1 - _NOISE) else float(f"{near + step:.{_DIGITS}g}")


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
    stamps this one follows, ``accuracies`` the levels of bounds. ``measured`` is false while size and rate
    are from a preset.
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
    measured: bool = True

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
    """Topics by full name, the link's budget in KB/s, and how long a lower rate waits, in seconds.

    ``allow_parameters`` are those that rules may set, by their node, ``allow_calls`` the services that rules
    may call.
    """

    budget_kb_per_s: float | None = None
    settle_s: float = 0.5
    topics: Mapping[str, TopicProfile] = field(default_factory=dict)
    path: str = ""
    allow_parameters: Mapping[str, frozenset[str]] = field(default_factory=dict)
    allow_calls: frozenset[str] = frozenset()

    def allows(self, action: ActRequest) -> bool:
        """Whether rules may do it; anybody may be notified."""
        match action.kind:
            case ActionKind.SET_PARAMETER:
                return action.parameter in self.allow_parameters.get(action.target, ())
            case ActionKind.CALL:
                return action.target in self.allow_calls
            case ActionKind.NOTIFY:
                return True

    def topic(self, name: str) -> TopicProfile:
        """The entry of ``name``, or an empty one."""
        return self.topics.get(name, _EMPTY)

    def resolved(self, resolve: Callable[[str], str]) -> Profile:
        """This profile with every topic, node and service by the name that ``resolve`` gives it."""
        topics = {
            resolve(name): topic
            if topic.paced_with is None
            else replace(topic, paced_with=resolve(topic.paced_with))
            for name, topic in self.topics.items()
        }
        allowed: dict[str, frozenset[str]] = {}
        for node, parameters in self.allow_parameters.items():
            allowed[resolve(node)] = allowed.get(resolve(node), frozenset()) | parameters
        calls = frozenset(map(resolve, self.allow_calls))
        return replace(self, topics=topics, allow_parameters=allowed, allow_calls=calls)


MAX_BUDGET_KB_PER_S = 1e9
UNLIMITED_KB_PER_S = 1e7
"""What a link is said to carry that topics do not come near to fill: it is no limit."""


def budget_kb_per_s(value: object) -> float:
    """``value``, a number or text, as KB/s for all relayed topics together. Raises ``ValueError``."""
    number = math.nan
    if isinstance(value, Real | str) and not isinstance(value, bool):
        try:
            number = float(value)
        except (ValueError, OverflowError):
            number = math.nan
    if not 0 <= number <= MAX_BUDGET_KB_PER_S:
        raise ValueError(f"a budget is a number of KB/s from 0 to {MAX_BUDGET_KB_PER_S:g}, not {value!r:.40}")
    return number
