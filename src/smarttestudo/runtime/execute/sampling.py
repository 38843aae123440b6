# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Whether a source is so much faster than its target that most of its messages need not even be looked at."""

from __future__ import annotations

import math

from smarttestudo.domain.units import NS_PER_S

BEGIN_RATIO = 3.5
"""Source over target from which sampling is worth a change of subscriptions."""
END_RATIO = 2.5
"""Source over target below which it is no more."""
LEAST_SOURCE_HZ = 20.0
"""Slower sources cost next to nothing."""
MEASURE_NS = NS_PER_S
PAUSE_NS = 10 * NS_PER_S
"""How long every message is looked at again before sampling may begin anew: rules may flicker."""


class SamplingChoice:
    """Decides for one topic, by the number of messages that its source has sent.

    ``source_hz`` is the source's rate in the last second or so; ``None`` before it was measured.
    """

    __slots__ = ("_not_before_ns", "_sent", "_since_ns", "is_sampled", "source_hz")

    def __init__(self, now_ns: int) -> None:
        self.is_sampled = False
        self.source_hz: float | None = None
        self._sent: int | None = None
        self._since_ns = now_ns
        self._not_before_ns = now_ns

    def look(self, sent: int, target_hz: float, now_ns: int) -> bool:
        """Whether to sample from ``now_ns`` on; ``sent`` counts messages from any point on."""
        self._measure(sent, now_ns)
        ratio = _ratio(self.source_hz, target_hz)
        if self.is_sampled:
            if ratio < END_RATIO:
                self.is_sampled = False
                self._not_before_ns = now_ns + PAUSE_NS
        elif ratio >= BEGIN_RATIO and now_ns >= self._not_before_ns:
            self.is_sampled = True
        return self.is_sampled

    def _measure(self, sent: int, now_ns: int) -> None:
        elapsed_ns = now_ns - self._since_ns
        if self._sent is None or elapsed_ns < 0:
            self._not_before_ns = min(self._not_before_ns, now_ns)
        elif elapsed_ns < MEASURE_NS:
            return
        else:
            self.source_hz = (sent - self._sent) * NS_PER_S / elapsed_ns
        self._sent, self._since_ns = sent, now_ns


def _ratio(source_hz: float | None, target_hz: float) -> float:
    if source_hz is None or source_hz < LEAST_SOURCE_HZ:
        return 0.0
    return source_hz / target_hz if target_hz else math.inf
