# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Values of the machine and of the link that checks read."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from smarttestudo.domain.signal import Signal, SignalKind
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.loop.knowledge.watched_topic import Reading

VITALS_HOLD_NS = 5 * NS_PER_S
"""For how long values count that were measured once; they are measured once a second."""


class WatchedVitals:
    """The last values of the machine or of the link, and until when they count."""

    __slots__ = ("_ends_ns", "_signals", "_values")

    def __init__(self, signals: Iterable[Signal]) -> None:
        self._signals = tuple(signals)
        self._values: Mapping[str, float | None] = {}
        self._ends_ns: int | None = None

    def restore_history(self, before: WatchedVitals) -> None:
        """Take over the values that ``before``, the same under other rules, knows."""
        self._values, self._ends_ns = before._values, before._ends_ns

    def take(self, values: Mapping[str, float | None], now_ns: int) -> None:
        """These were measured, and no others."""
        self._values, self._ends_ns = values, now_ns + VITALS_HOLD_NS

    def readings(self, now_ns: int) -> list[Reading]:
        """The value of every signal at ``now_ns``."""
        values = {} if self._ends_ns is None or now_ns >= self._ends_ns else self._values
        return [(signal, self._value(signal, values)) for signal in self._signals]

    @staticmethod
    def _value(signal: Signal, values: Mapping[str, float | None]) -> float | None:
        return None if signal.kind is SignalKind.TEXT else values.get(signal.property)

    def next_change_ns(self, now_ns: int) -> int | None:
        """When the values become unknown, if they are not yet."""
        return None if self._ends_ns is None or self._ends_ns <= now_ns else self._ends_ns
