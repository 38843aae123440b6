# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rates of blocks that change nothing, whatever is known or unknown."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from collections.abc import Set as AbstractSet

from smarttestudo.checks.analysis.results import RedundantRate
from smarttestudo.domain.rate import Rate
from smarttestudo.language.boxes import Effort, TooComplexError
from smarttestudo.language.normal_form import Every, Form, InRegion, Some
from smarttestudo.language.resolved_rules import Branch, ResolvedFloor, ResolvedRate


def redundant_rates(
    possible: Sequence[Branch],
    branches: Sequence[Branch],
    defaults: Mapping[str, ResolvedRate],
    floors: Mapping[str, ResolvedFloor],
    effort: Effort,
) -> Iterator[RedundantRate]:
    """The rates of ``possible`` branches that equal their topic's default where none is overruled.

    Any of ``branches`` may be: one that never holds is feared all the same while its values are unknown.
    They can be removed all at once: what is asked of a rate is asked of others that differ from the default.
    Ends when ``effort`` is spent.
    """
    alike = _alike({topic: default.rate for topic, default in defaults.items()}, possible)
    rivals = _rivals(branches, {setting.topic for _, setting in alike}, floors) if alike else {}
    try:
        for branch, setting in alike:
            topic, rate = setting.topic, setting.rate
            if rate is None or (rate.yields_to_floor and rate.hz < _floor_hz(floors.get(topic))):
                continue
            others = (
                other
                for (priority, raised), asking in rivals[topic].items()
                if _may_matter(rate, branch.block.priority, raised, priority)
                for other in asking
                if other is not branch
            )
            if all(excludes(other.form, branch.form, effort) for other in others):
                yield RedundantRate(branch=branch, setting=setting, default=defaults[topic])
    except TooComplexError:
        return


def _alike(
    rates: Mapping[str, Rate | None], branches: Sequence[Branch]
) -> Sequence[tuple[Branch, ResolvedRate]]:
    """The settings of ``branches`` to known ``rates``."""
    return [
        (branch, setting)
        for branch in branches
        for topic, setting in branch.settings.items()
        if setting.rate is not None and setting.rate == rates.get(topic)
    ]


_Stance = tuple[int, Rate | None]
"""The priority of a block, and its rate raised to the floor."""


def _rivals(
    branches: Sequence[Branch], topics: AbstractSet[str], floors: Mapping[str, ResolvedFloor]
) -> dict[str, dict[_Stance, list[Branch]]]:
    """The branches that set each of ``topics``, by what they ask for: few ask for different things."""
    rivals: dict[str, dict[_Stance, list[Branch]]] = {}
    for branch in branches:
        for topic in branch.settings.keys() & topics:
            rate = branch.rate(topic)
            raised = None if rate is None else rate.at_least(_floor_hz(floors.get(topic)))
            alike = rivals.setdefault(topic, {}).setdefault((branch.block.priority, raised), [])
            alike.append(branch)
    return rivals


def _floor_hz(floor: ResolvedFloor | None) -> float:
    return 0.0 if floor is None else floor.rate.hz


def _may_matter(mine: Rate, my_priority: int, raised: Rate | None, priority: int) -> bool:
    """Whether ``mine``, which is the default's, can change what a block with the other rate makes of a topic.

    It does where it overrules a lower rate, known or in doubt, and where it keeps a higher rate of lower
    priority from being feared; unless the two conditions exclude each other.
    """
    if priority > my_priority or raised == mine:
        return False
    return raised is None or raised < mine or priority < my_priority


def excludes(first: Form, second: Form, effort: Effort) -> bool:
    """Whether ``second`` is known to be false wherever ``first`` is known to hold, unknown values included.

    It looks for values of one signal that both need and cannot both have; ``False`` may be either.
    Raises ``TooComplexError`` when ``effort`` is spent.
    """
    effort.spend(1)
    if isinstance(first, Some):
        return all(excludes(part, second, effort) for part in first.parts)
    if isinstance(second, Some):
        return all(excludes(first, part, effort) for part in second.parts)
    if isinstance(first, Every):
        return any(excludes(part, second, effort) for part in first.parts)
    if isinstance(second, Every):
        return any(excludes(first, part, effort) for part in second.parts)
    return _are_apart(first, second)


def _are_apart(first: InRegion, second: InRegion) -> bool:
    return first.signal == second.signal and first.region.intersection(second.region).is_empty
