# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Numbers and requirements in the words of the optimizer's answers."""

from __future__ import annotations

import math
from collections.abc import Sequence

from smarttestudo.domain.rate import Tier
from smarttestudo.domain.units import grouped
from smarttestudo.optimizer.problem import fits


def kb_text(kb_per_s: float) -> str:
    """``157 665.72``: at most two decimals, thousands apart."""
    return _without_zeros(grouped(kb_per_s, 2))


def enough_kb_text(kb_per_s: float) -> str:
    """KB/s as ``kb_text``, rounded up: what is needed fits a budget of the number that is named."""
    nearest = round(kb_per_s, 2)
    return kb_text(nearest if fits(kb_per_s, nearest) else math.ceil(100 * kb_per_s) / 100)


def hz_text(rate_hz: float) -> str:
    """``12.345``: what a rule file writes; all digits of a rate that is no multiple of 0.001 Hz."""
    return _without_zeros(f"{rate_hz:.3f}") if round(rate_hz, 3) == rate_hz else repr(rate_hz)


def wanted_text(wanted: Tier | float) -> str:
    """A level's name, or a rate with its unit."""
    return wanted.value if isinstance(wanted, Tier) else f"{hz_text(wanted)} Hz"


def listed(parts: Sequence[str]) -> str:
    """``a, b and c``."""
    return parts[0] if len(parts) == 1 else f"{', '.join(parts[:-1])} and {parts[-1]}"


def _without_zeros(number: str) -> str:
    return number.rstrip("0").rstrip(".")
