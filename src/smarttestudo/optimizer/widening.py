# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Bounds widened until they need no more than a rate."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping

from smarttestudo.domain.profile import TopicProfile, rounded_up

Within = Mapping[str, float]
"""The bounds of one topic, by property."""


def can_widen(entry: TopicProfile, within: Within) -> bool:
    """Whether it is known of every bound, and there are any, what it needs as it gets wider."""
    return bool(within) and all(
        bound > 0 and entry.needed_hz({name: math.inf}) < math.inf for name, bound in within.items()
    )


def widest(entry: TopicProfile, within: Within) -> dict[str, float]:
    """As wide as bounds may get: α0 of each, unless it is wider already. There must be measured levels."""
    loosest = {name: entry.accuracy(name) for name in within}
    return {
        name: bound if (tiers := loosest[name]) is None else max(bound, tiers.bounds[0])
        for name, bound in within.items()
    }


def widened(entry: TopicProfile, within: Within, rate_hz: float) -> dict[str, float]:
    """All of ``within`` times the least factor with which they need at most ``rate_hz``, in four digits.

    No bound gets wider than in ``widest``, even if that needs more.
    """
    limits = widest(entry, within)

    def at(factor: float) -> dict[str, float]:
        return {name: min(factor * bound, limits[name]) for name, bound in within.items()}

    factor = _least_factor(entry, within, rate_hz)
    return {
        name: within[name] if factor == 1.0 else min(rounded_up(bound), limits[name])
        for name, bound in at(factor).items()
    }


def _least_factor(entry: TopicProfile, within: Within, rate_hz: float) -> float:
    """Between two factors that bring some bound to an accuracy of its levels, the need falls on a line."""

    def needed_hz(factor: float) -> float:
        return entry.needed_hz({name: factor * bound for name, bound in within.items()})

    corners = {1.0}
    for name, bound in within.items():
        tiers = entry.accuracy(name)
        corners.update(_factor(bound, one) for one in (() if tiers is None else tiers.bounds) if one > bound)
    if needed_hz(1.0) <= rate_hz:
        return 1.0
    for low, high in itertools.pairwise(sorted(corners)):
        start_hz, between = needed_hz(low), (low + high) / 2
        fall_hz = start_hz - needed_hz(between)
        # Below α5 nothing is known (infinite), and at two equal accuracies the need falls at once.
        if start_hz < math.inf and fall_hz > 0:
            factor = low + (start_hz - rate_hz) / fall_hz * (between - low)
            if factor < high:
                return factor
        if needed_hz(high) <= rate_hz:
            return high
    return max(corners)


def _factor(bound: float, wider: float) -> float:
    """The factor from ``bound`` to ``wider``, or no less by float noise: that may need infinitely more."""
    factor = wider / bound
    return factor if factor * bound >= wider else math.nextafter(factor, math.inf)
