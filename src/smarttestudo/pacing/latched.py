# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Streams of transient_local topics: sparse samples pass whole, and the newest one always arrives."""

from __future__ import annotations

from smarttestudo.domain.units import NS_PER_S
from smarttestudo.pacing.pace import NEVER_NS, Pace
from smarttestudo.pacing.sample import Sample
from smarttestudo.pacing.stream import Stream

WHOLE_AT_FIRST_NS = 2 * NS_PER_S
WHOLE_FROM_PERIOD_NS = NS_PER_S


class LatchedStream(Stream):
    """The samples of one transient_local publisher.

    All pass in the publisher's first 2 s and while its mean rate is at most 1 Hz. Above that they are
    thinned, and the newest held sample goes out as soon as it is due. Off lets nothing pass, but the
    newest sample stays held and follows when Off ends, as a late subscriber would get it.
    """

    __slots__ = ("_first_ns",)

    def __init__(self, pace: Pace, now_ns: int) -> None:
        super().__init__(pace, now_ns)
        self._first_ns = now_ns

    def offer(self, sample: Sample, now_ns: int) -> bool:
        """Whether ``sample`` passes now; if not, it is held."""
        self.source.record(now_ns)
        grid = self.grid
        if now_ns >= grid.due_ns or (not grid.pace.is_off and self._passes_whole(now_ns)):
            self.settle(now_ns)
            return True
        self.hold(sample, now_ns)
        return False

    @property
    def release_ns(self) -> int:
        """When the held sample is due."""
        return NEVER_NS if self.held is None else self.grid.due_ns

    def restart(self, now_ns: int) -> None:
        """Begin anew on a clock that jumped back to ``now_ns``."""
        super().restart(now_ns)
        self._first_ns = now_ns

    def _passes_whole(self, now_ns: int) -> bool:
        mean_ns = self.source.mean_ns
        return (
            now_ns - self._first_ns <= WHOLE_AT_FIRST_NS or mean_ns is None or mean_ns >= WHOLE_FROM_PERIOD_NS
        )
