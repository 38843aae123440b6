# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The properties of every topic that need nothing decoded: rate, bandwidth and age."""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from collections.abc import Callable, Iterator, Mapping, Sequence

from smarttestudo.adirf.region import Bound
from smarttestudo.domain.signal import ArrivalProperty
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.runtime.knowledge.arrival_window import ArrivalWindow

_LONGEST_NS = 2**62


class Arrivals:
    """Those of the three that checks read, and when time alone takes one of them across a cut."""

    __slots__ = ("_ages_ns", "_cuts", "_window", "_window_is_read")

    def __init__(self, cuts: Mapping[ArrivalProperty, Sequence[Bound]]) -> None:
        self._cuts = cuts
        self._window = ArrivalWindow()
        self._window_is_read = bool(cuts.keys() - {ArrivalProperty.AGE})
        age_cuts = cuts.get(ArrivalProperty.AGE, ())
        self._ages_ns = sorted({_first_age_ns(cut) for cut in age_cuts if math.isfinite(cut[0])})

    def __bool__(self) -> bool:
        """Whether any of them is read."""
        return bool(self._cuts)

    def carry_on(self, before: Arrivals) -> None:
        """Take over the arrivals that ``before`` counted, if it did."""
        if before._window_is_read:
            self._window = before._window

    def record(self, now_ns: int, size_bytes: int) -> None:
        """Count a message."""
        if self._window_is_read:
            self._window.record(now_ns, size_bytes)

    def values(self, now_ns: int, silent_since_ns: int) -> Iterator[tuple[ArrivalProperty, float]]:
        """The value of each property at ``now_ns``; to ask changes nothing."""
        for kind in self._cuts:
            if kind is ArrivalProperty.AGE:
                yield kind, (now_ns - silent_since_ns) / NS_PER_S
            else:
                yield kind, self._measure(kind)(self._window.leaving(now_ns))

    def changes_ns(self, now_ns: int, silent_since_ns: int) -> Iterator[int]:
        """When time alone next takes each property across a cut; for those that it will."""
        for kind, cuts in self._cuts.items():
            if kind is ArrivalProperty.AGE:
                position = bisect_right(self._ages_ns, now_ns - silent_since_ns)
                if position < len(self._ages_ns):
                    yield silent_since_ns + self._ages_ns[position]
            else:
                self._window.forget(now_ns)
                falls_ns = self._window.falls_ns(self._measure(kind), cuts)
                if falls_ns is not None:
                    yield falls_ns

    def _measure(self, kind: ArrivalProperty) -> Callable[[int], float]:
        is_rate = kind is ArrivalProperty.RATE
        return self._window.rate_hz if is_rate else self._window.bandwidth_kb_per_s


def _first_age_ns(cut: Bound) -> int:
    """The first age beyond ``cut``, found by the very comparison that checks use: floats round."""
    return bisect_left(range(_LONGEST_NS), 1, key=lambda age_ns: (age_ns / NS_PER_S, 0) > cut)
