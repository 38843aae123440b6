# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Numbers and rates as text."""

from __future__ import annotations

from smarttestudo.adirf.syntax import RateExpression, RateWord
from smarttestudo.domain.tier import Tier


def number_text(value: float) -> str:
    """The shortest spelling that reads back as ``value``, a whole number without its ``.0``."""
    return repr(float(value)).removesuffix(".0")


def rate_text(rate: RateExpression) -> str:
    """The rate as written, or as one would write it where the tree holds no spelling."""
    if isinstance(rate.value, Tier | RateWord):
        name: str = rate.value.value
        return name
    unit = " Hz" if rate.has_unit else ""
    return f"{rate.text or number_text(rate.value)}{unit}"
