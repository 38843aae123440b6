# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The budget that a link leaves to relayed topics."""

from __future__ import annotations

from smarttestudo.domain.profile import UNLIMITED_KB_PER_S
from smarttestudo.domain.units import BYTES_PER_KB, NS_PER_S
from smarttestudo.link.protocol.window import Window

_PERIOD_NS = NS_PER_S // 4
_KEPT_SHARE = 0.99
"""How much an earlier message counts beside the newest: about the last hundred say what compression saves."""
_USABLE = 0.95
"""The share of the capacity that is planned with; the rest carries what nobody planned."""
_OUTGROWN = 2.0
"""A budget of so many times what was measured has grown while the link stood idle."""
_GROWTH = ((0.5, 1.4), (0.15, 1.07), (0.05, 1.0))
"""Shares of a period in which nothing waited to be sent, and by how much the budget grows after it."""
_MOST_BYTES_PER_S = UNLIMITED_KB_PER_S * BYTES_PER_KB


class BudgetEstimator:
    """The capacity where the link is the limit; elsewhere it grows while nothing waits to be sent."""

    def __init__(self) -> None:
        self._bytes_per_s: float | None = None
        self._measured_ns = 0
        self._idle_ns = 0
        """For how long nothing waited to be sent, since ``_measured_ns``."""
        self._idle_since_ns: int | None = None
        self._payload_bytes = self._wire_bytes = 1.0

    def idle(self, now_ns: int) -> None:
        """Nothing waits to be sent."""
        self._idle_since_ns = self._idle_since_ns or now_ns

    def sent(self, now_ns: int) -> None:
        """Something was sent."""
        if self._idle_since_ns is not None:
            self._idle_ns += now_ns - self._idle_since_ns
            self._idle_since_ns = None

    def encoded(self, payload_bytes: int, wire_bytes: int) -> None:
        """A message that is planned takes so many bytes on the link."""
        self._payload_bytes = self._payload_bytes * _KEPT_SHARE + payload_bytes
        self._wire_bytes = self._wire_bytes * _KEPT_SHARE + wire_bytes

    def measure(self, window: Window, now_ns: int) -> None:
        """Set the budget by what was measured, four times a second."""
        span_ns = now_ns - self._measured_ns
        if span_ns < _PERIOD_NS:
            return
        if self._idle_since_ns is not None:
            self._idle_ns += now_ns - self._idle_since_ns
            self._idle_since_ns = now_ns
        idle_share, self._idle_ns, self._measured_ns = self._idle_ns / span_ns, 0, now_ns
        if not window.is_measured:
            return
        usable = window.capacity_bytes_per_s * _USABLE
        before = usable if self._bytes_per_s is None else self._bytes_per_s
        growth = next((growth for share, growth in _GROWTH if idle_share > share), None)
        grown = usable if growth is None else max(usable, before * growth)
        self._bytes_per_s = min(grown, _MOST_BYTES_PER_S)

    def is_limit(self, window: Window) -> bool:
        """Whether the capacity was measured, and topics need so much that it says something by now."""
        usable = window.capacity_bytes_per_s * _USABLE
        budget = self._bytes_per_s
        return window.is_measured and (budget is None or budget <= _OUTGROWN * usable)

    @property
    def kb_per_s(self) -> float | None:
        """The budget of all relayed topics now, before compression; ``None`` while it is not known.

        ``UNLIMITED_KB_PER_S`` where the link is no limit.
        """
        if self._bytes_per_s is None:
            return None
        if self._bytes_per_s >= _MOST_BYTES_PER_S:
            return UNLIMITED_KB_PER_S
        budget_kb_per_s = self._bytes_per_s * self._payload_bytes / self._wire_bytes / BYTES_PER_KB
        return min(budget_kb_per_s, UNLIMITED_KB_PER_S)
