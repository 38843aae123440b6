# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What every stream has: a grid, its source's period and the newest sample that was held back."""

from __future__ import annotations

from abc import ABC, abstractmethod

from smarttestudo.domain.source_period import SourcePeriod
from smarttestudo.pacing.grid import Grid
from smarttestudo.pacing.pace import Pace
from smarttestudo.pacing.sample import Pass, Sample


class Stream(ABC):
    """The messages of one publisher, or those that hold one child frame; opened by its first message."""

    __slots__ = ("finished", "grid", "held", "held_ns", "source")

    def __init__(self, pace: Pace, now_ns: int) -> None:
        self.grid = Grid(pace, now_ns)
        self.source = SourcePeriod()
        self.held: Sample | None = None
        self.held_ns = now_ns
        self.finished = False

    @abstractmethod
    def offer(self, sample: Sample, now_ns: int) -> bool:
        """Whether ``sample`` passes now; if not, it may be held."""

    @property
    @abstractmethod
    def release_ns(self) -> int:
        """When the stream relays something of its own accord unless a message comes; or ``NEVER_NS``."""

    def hold(self, sample: Sample, now_ns: int) -> None:
        """Keep ``sample`` as the newest that did not pass."""
        self.held = sample
        self.held_ns = now_ns

    def settle(self, now_ns: int) -> None:
        """Something passes now: pay for it, and what was held before it is no longer the newest."""
        self.grid.charge(now_ns)
        self.held = None

    def release(self, now_ns: int) -> tuple[Pass, ...]:
        """Relay what ``release_ns`` announced."""
        sample = self.held
        self.settle(now_ns)
        return () if sample is None else (Pass(sample),)

    def change_pace(self, pace: Pace, now_ns: int) -> None:
        """Follow another pace from now on."""
        self.grid.change_pace(pace, now_ns)

    def restart(self, now_ns: int) -> None:
        """Begin anew on a clock that jumped back to ``now_ns``; what is held stays held."""
        self.grid.start(now_ns)
        self.source = SourcePeriod()
        self.held_ns = now_ns

    def is_idle(self, now_ns: int) -> bool:
        """Whether a fresh stream would do as well: nothing held, nothing ahead."""
        pace = self.grid.pace
        return self.held is None and (pace.is_off or self.grid.due_ns < now_ns - pace.slack_ns)
