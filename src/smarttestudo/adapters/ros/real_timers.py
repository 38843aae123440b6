# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Timers in real time, whatever clock the node has."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass


@dataclass(slots=True)
class _Timer:
    period_s: float
    act: Callable[[], None]
    due_s: float


class RealTimers:
    """Things to do again and again, of which what was missed is not caught up on.

    Times are those of one steady clock, the caller's; ``due_s`` is when the next timer is due.
    """

    __slots__ = ("_timers", "due_s")

    def __init__(self) -> None:
        self._timers: list[_Timer] = []
        self.due_s = math.inf

    def add(self, period_s: float, act: Callable[[], None], now_s: float) -> None:
        """Do ``act`` every ``period_s``, for the first time after one period."""
        self._timers.append(_Timer(period_s, act, now_s + period_s))
        self._arm()

    def act(self, now_s: float) -> None:
        """Do what is due, each once."""
        for timer in self._timers:
            if timer.due_s <= now_s:
                next_s = timer.due_s + timer.period_s
                timer.due_s = next_s if next_s > now_s else now_s + timer.period_s
                timer.act()
        self._arm()

    def _arm(self) -> None:
        self.due_s = min(timer.due_s for timer in self._timers)
