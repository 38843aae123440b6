# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Where a topic's loss bends: six thresholds for QUPER."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

from smarttestudo.domain.rate import RATE_STEP_HZ
from smarttestudo.optimizer.profiling.proposal import TierProposal
from smarttestudo.optimizer.profiling.text import rounded

LEVELS = (0.2, 0.1, 0.05, 0.02, 0.01)
"""Error relative to the field's range at τ0 … τ4."""

_SLOWEST_SOURCE_HZ = (len(LEVELS) + 1) * RATE_STEP_HZ

Loss = tuple[float, float, str]
"""A rate in Hz, the relative hold RMSE of the worst field there, and that field."""


def proposed_breakpoints(losses: Sequence[Loss], source_hz: float) -> TierProposal | None:
    """Six thresholds from a loss curve.

    τ0 … τ4 are the rates from which on who holds the last value errs by at most 20, 10, 5, 2, 1 % of the
    field's range (RMSE, the worst field counts); τ5 is the source's rate, at which nothing is lost.

    ``losses`` are those at some rates below ``source_hz``, in any order.
    Between two rates, and below the lowest, the error counts as linear in the period 1/f, which it is for
    a signal that changes slowly. The thresholds rise by 0.001 Hz or more and do not exceed the source.
    ``None`` where nothing is lost at any rate, or the source is too slow for six thresholds.
    """
    source_hz = rounded(source_hz)
    curve = _rising_curve(losses, source_hz)
    if source_hz < _SLOWEST_SOURCE_HZ or curve[-1][1] <= 0:
        return None
    found = [_period_at(level, curve) for level in LEVELS]
    tiers_hz = _strictly_rising([*(rounded(1 / period_s) for period_s, _ in found), source_hz])
    worst = ", ".join(dict.fromkeys(field for _, field in found))
    levels = ", ".join(f"{100 * level:g}" for level in LEVELS)
    return TierProposal(
        tiers_hz=tiers_hz,
        origin=f"RMSE of holding: {levels} % of the range (worst: {worst}), 0 at source_hz",
    )


def _rising_curve(losses: Sequence[Loss], source_hz: float) -> list[Loss]:
    """Period in s, error and field, with both rising: an error that falls again at a lower rate is luck."""
    curve: list[Loss] = [(1 / source_hz, 0.0, "")]
    for rate_hz, error, field in sorted(losses, reverse=True):
        if rate_hz < source_hz:
            _, before, worst_before = curve[-1]
            curve.append(
                (1 / rate_hz, error, field) if error > before else (1 / rate_hz, before, worst_before)
            )
    return curve


def _period_at(level: float, curve: Sequence[Loss]) -> tuple[float, str]:
    """The period at which the error reaches ``level``, and the field that does."""
    for (short_s, below, _), (long_s, above, field) in itertools.pairwise(curve):
        if above > level:
            return short_s + (level - below) / (above - below) * (long_s - short_s), field
    longest_s, error, field = curve[-1]
    return longest_s * level / error, field


def _strictly_rising(rates_hz: Sequence[float]) -> tuple[float, ...]:
    """``rates_hz``, which do not fall, with 0.001 Hz between those that would be nearer."""
    apart: list[float] = []
    for rate_hz in reversed(rates_hz):
        below = apart[-1] - RATE_STEP_HZ if apart else rate_hz
        apart.append(round(min(rate_hz, below), 9))
    lowest = [(index + 1) * RATE_STEP_HZ for index in range(len(apart))]
    return tuple(round(max(rate, least), 9) for rate, least in zip(reversed(apart), lowest, strict=True))
