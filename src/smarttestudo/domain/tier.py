# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""QUPER quality levels."""

from __future__ import annotations

from enum import Enum


class Tier(Enum):
    """A quality level; the value is its name in a rule file, the order that of rising quality."""

    UNACCEPTABLE = "Unacceptable"
    MARGINAL = "Marginal"
    ACCEPTABLE = "Acceptable"
    DESIRABLE = "Desirable"
    COMPETITIVE = "Competitive"
    EXCESSIVE = "Excessive"

    @property
    def level(self) -> int:
        """0 for Unacceptable … 5 for Excessive."""
        return list(Tier).index(self)
