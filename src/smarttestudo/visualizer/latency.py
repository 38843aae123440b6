# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How long messages took from their header's stamp to the recorder."""

from __future__ import annotations

from array import array
from dataclasses import dataclass
from fractions import Fraction
from math import ceil

from smarttestudo.domain.units import NS_PER_S

_P95 = Fraction(95, 100)


@dataclass(frozen=True, slots=True, kw_only=True)
class Latency:
    """Receive time minus ``header.stamp``: its mean, the least that 95 % do not exceed, and the largest.

    ``None`` where no message has a stamp. Below zero, or years, where the two come from different clocks.
    """

    mean_s: float | None = None
    p95_s: float | None = None
    max_s: float | None = None

    def to_json(self) -> dict[str, object]:
        """What it adds to the topic's entry in ``--json``."""
        return {
            "latency_mean_s": self.mean_s,
            "latency_p95_s": self.p95_s,
            "latency_max_s": self.max_s,
        }


class LatencyAccumulator:
    """Takes a topic's latencies one by one; memory grows by 8 bytes for each."""

    __slots__ = ("_latencies_ns",)

    def __init__(self) -> None:
        self._latencies_ns = array("q")

    def add(self, latency_ns: int) -> None:
        """Count one message."""
        self._latencies_ns.append(latency_ns)

    def latency(self) -> Latency:
        """The numbers over all messages so far."""
        if not self._latencies_ns:
            return Latency()
        rising_ns = sorted(self._latencies_ns)
        return Latency(
            mean_s=sum(rising_ns) / len(rising_ns) / NS_PER_S,
            p95_s=rising_ns[ceil(_P95 * len(rising_ns)) - 1] / NS_PER_S,
            max_s=rising_ns[-1] / NS_PER_S,
        )
