# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How old the newest message received is, over time."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

from smarttestudo.domain.units import NS_PER_S
from smarttestudo.visualizer.loss.report import Age

_PERCENTILE = 0.95


def age_of(stamps_ns: Sequence[int], *, sent_from_ns: int, end_ns: int) -> Age | None:
    """The age between the first of ``stamps_ns``, which rise, and ``end_ns``; ``None`` without a message.

    The age is a sawtooth that falls to 0 with each message: over intervals d its mean is Σd² / 2Σd (Kaul,
    Yates and Gruteser, "Real-time status: how often should one update?", INFOCOM 2012, with messages that
    count from their reception).
    """
    received_ns = [stamp_ns for stamp_ns in stamps_ns if stamp_ns <= end_ns]
    if not received_ns:
        return None
    intervals_ns = [after - before for before, after in itertools.pairwise([*received_ns, end_ns])]
    total_ns = sum(intervals_ns)
    squares = sum(interval_ns * interval_ns for interval_ns in intervals_ns)
    return Age(
        mean_s=squares / (2 * total_ns) / NS_PER_S if total_ns else 0.0,
        p95_s=_percentile(intervals_ns, _PERCENTILE) / NS_PER_S,
        max_s=max(intervals_ns) / NS_PER_S,
        unseen_s=max(0, received_ns[0] - sent_from_ns) / NS_PER_S,
    )


def _percentile(intervals_ns: Sequence[int], share: float) -> float:
    """The age that is not exceeded for ``share`` of the time: the a with Σ min(d, a) = share · Σ d."""
    left_ns = share * sum(intervals_ns)
    below_ns = 0
    rising = sorted(intervals_ns)
    for index, interval_ns in enumerate(rising):
        teeth = len(rising) - index
        if below_ns + interval_ns * teeth >= left_ns:
            return (left_ns - below_ns) / teeth
        below_ns += interval_ns
    return float(rising[-1])
