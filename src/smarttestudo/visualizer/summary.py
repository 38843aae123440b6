# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A run in one sentence."""

from __future__ import annotations

from smarttestudo.visualizer.comparison import Comparison
from smarttestudo.visualizer.table import MISSING, format_number

_KB_PER_MB = 1000


def summary_sentence(comparison: Comparison, decisions: int) -> str:
    """What the rules did to the bandwidth of all topics, and how often they changed a rate."""
    change = comparison.bandwidth_change_percent
    saved = "" if change is None else f"{format_number(change, 0, signed=True)} % bandwidth, "
    return f"{saved}{decisions:,} {'decision' if decisions == 1 else 'decisions'}"


def bandwidth_text(kb_per_s: float | None) -> str:
    """``kb_per_s`` with its unit, MB/s from 1000 KB/s on."""
    if kb_per_s is None:
        return MISSING
    if kb_per_s >= _KB_PER_MB:
        return f"{format_number(kb_per_s / _KB_PER_MB, 1)} MB/s"
    return f"{format_number(kb_per_s, 1)} KB/s"
