# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Tiers that a measurement proposes."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class TierProposal:
    """τ0 … τ5 in Hz, and where they come from, as a comment in a profile says it."""

    tiers_hz: tuple[float, ...]
    origin: str
