# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Budgets as people give them."""

from __future__ import annotations

import math
from numbers import Real

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
