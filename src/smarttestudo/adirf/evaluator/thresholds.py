# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The leaves of one signal along the number line."""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Collection, Iterable

from smarttestudo.adirf.evaluator.literal import FALSE, TRUE, UNKNOWN, Leaf
from smarttestudo.adirf.region import Bound, Region


class Thresholds:
    """Which leaves a change of the signal's value can touch: those with a cut between old and new value."""

    __slots__ = ("_leaves", "_leaves_at", "_position", "cuts", "value")

    def __init__(self, leaves: Iterable[Leaf]) -> None:
        self._leaves = tuple(leaves)
        leaves_at: dict[Bound, list[Leaf]] = {}
        for leaf in self._leaves:
            for cut in leaf.region.cuts:
                leaves_at.setdefault(cut, []).append(leaf)
        self.cuts = sorted(leaves_at)
        self._leaves_at = [leaves_at[cut] for cut in self.cuts]
        self._position: int | None = None
        self.value: float | None = None

    def move(self, value: float | None) -> Collection[Leaf]:
        """Take the new value (``None`` or NaN: unknown); the leaves that may have changed."""
        if value is None or math.isnan(value):
            return self._forget()
        self.value = value
        before, after = self._position, bisect_left(self.cuts, (value, 0))
        self._position = after
        if before is None:
            return self._leaves
        if before == after:
            return ()
        return self._crossed(before, after) if before < after else self._crossed(after, before)

    def truth(self, leaf: Leaf) -> int:
        """What the current value makes of one of the leaves."""
        return self.truth_in(leaf.region)

    def truth_in(self, region: Region) -> int:
        """Whether the current value lies in ``region``."""
        if self.value is None:
            return UNKNOWN
        return TRUE if region.contains(self.value) else FALSE

    def _forget(self) -> Collection[Leaf]:
        self.value = None
        if self._position is None:
            return ()
        self._position = None
        return self._leaves

    def _crossed(self, low: int, high: int) -> Collection[Leaf]:
        if high - low == 1:
            return self._leaves_at[low]
        return {leaf for leaves in self._leaves_at[low:high] for leaf in leaves}
