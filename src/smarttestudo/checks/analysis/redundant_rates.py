# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rates of blocks that change nothing, whatever is known or unknown."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from smarttestudo.checks.analysis.results import RedundantRate
from smarttestudo.domain.rate import Rate
from smarttestudo.language.boxes import Effort, TooComplexError
from smarttestudo.language.normal_form import Every, Form, InRegion, Some
from smarttestudo.language.resolved_rules import Branch, ResolvedFloor, ResolvedRate


def redundant_rates(
    branches: Sequence[Branch],
    defaults: Mapping[str, ResolvedRate],
    floors: Mapping[str, ResolvedFloor],
    effort: Effort,
) -> Iterator[RedundantRate]:
    """The rates of ``branches`` that equal their topic's default where no other block can be overruled.

    They can be removed all at once: what is asked of a rate is asked of others that differ from the default.
    Ends when ``effort`` is spent.
    """
    setters: dict[str, list[Branch]] = {}
    for branch in branches:
        for topic in branch.settings:
            setters.setdefault(topic, []).append(branch)
    try:
        for branch in branches:
            for topic, setting in branch.settings.items():
                default = defaults.get(topic)
                if default is None or setting.rate is None or setting.rate != default.rate:
                    continue
                floor_hz = _floor_hz(floors.get(topic))
                if not setting.rate.yields_to_floor or setting.rate.hz >= floor_hz:
                    others = [other for other in setters[topic] if other is not branch]
                    if not any(_matters_beside(branch, one, topic, floor_hz, effort) for one in others):
                        yield RedundantRate(branch=branch, setting=setting, default=default)
    except TooComplexError:
        return


def _floor_hz(floor: ResolvedFloor | None) -> float:
    return 0.0 if floor is None else floor.rate.hz


def _matters_beside(branch: Branch, other: Branch, topic: str, floor_hz: float, effort: Effort) -> bool:
    """Whether the rate of ``branch``, which is the default's, can change what ``other`` makes of ``topic``.

    It does where it overrules a lower rate, known or in doubt, and where it keeps a higher rate of lower
    priority from being feared.
    """
    mine, theirs = branch.settings[topic].rate, other.settings[topic].rate
    if other.block.priority > branch.block.priority or mine is None:
        return False
    raised: Rate | None = None if theirs is None else theirs.at_least(floor_hz)
    if raised == mine or (
        raised is not None and raised > mine and other.block.priority == branch.block.priority
    ):
        return False
    return not excludes(other.form, branch.form, effort)


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
