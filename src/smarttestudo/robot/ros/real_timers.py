# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Timers in real time, whatever clock the node has, and when to poll the ROS graph by them."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from smarttestudo.domain.robot import GraphChange, PollGraph

LEAST_PERIOD_S = 0.2
"""The shortest time between checks of the graph, and the period if changes are not reported."""
NET_PERIOD_S = 1.0
"""The period without a reported change: changes that are not reported are found too."""


@dataclass(slots=True)
class RealTimer:
    """Timer that acts again and again; ``due_s`` is the next time."""

    period_s: float
    act: Callable[[], float | None]
    due_s: float


class RealTimers:
    """Things to do again and again, of which what was missed is not caught up on.

    Times are those of one steady clock, the caller's; ``due_s`` is when the next timer is due.
    """

    __slots__ = ("_timers", "due_s")

    def __init__(self) -> None:
        self._timers: list[RealTimer] = []
        self.due_s = math.inf

    def add(self, period_s: float, act: Callable[[], float | None], now_s: float) -> RealTimer:
        """Do ``act`` every ``period_s``, for the first time after one period.

        Where it returns a number, the next time is after so many seconds.
        """
        timer = RealTimer(period_s, act, now_s + period_s)
        self._timers.append(timer)
        self._arm()
        return timer

    def hasten(self, timer: RealTimer, due_s: float) -> None:
        """Do what ``timer`` is for at ``due_s`` already, if that is sooner."""
        timer.due_s = min(timer.due_s, due_s)
        self._arm()

    def act(self, now_s: float) -> None:
        """Do what is due, each once."""
        for timer in self._timers:
            if timer.due_s <= now_s:
                due_s, timer.due_s = timer.due_s, math.inf
                period_s = timer.act() or timer.period_s
                again_s = due_s + period_s if due_s + period_s > now_s else now_s + period_s
                timer.due_s = min(timer.due_s, again_s)
        self._arm()

    def _arm(self) -> None:
        self.due_s = min(timer.due_s for timer in self._timers)


class GraphPolls:
    """Has ``poll`` called by ``timers``: at once, soon after ``changed``, and now and then in any case.

    ``is_reported`` is whether ``changed`` is called. Times are those of the steady clock ``steady_s``.
    """

    def __init__(
        self,
        timers: RealTimers,
        poll: PollGraph,
        is_reported: Callable[[], bool],
        steady_s: Callable[[], float],
    ) -> None:
        self._timers = timers
        self._poll = poll
        self._is_reported = is_reported
        self._steady_s = steady_s
        self._has_changed = False
        self._polled_s = steady_s()
        self._timer = timers.add(LEAST_PERIOD_S, self._act, self._polled_s)
        timers.hasten(self._timer, self._polled_s)

    def changed(self) -> None:
        """The graph has changed."""
        self._has_changed = True
        self._timers.hasten(self._timer, max(self._steady_s(), self._polled_s + LEAST_PERIOD_S))

    def _act(self) -> float:
        self._polled_s = self._steady_s()
        has_changed, self._has_changed = self._has_changed, False
        is_reported = self._is_reported()
        unchanged = GraphChange.NONE if is_reported else GraphChange.UNREPORTED
        self._poll(GraphChange.REPORTED if has_changed else unchanged)
        return NET_PERIOD_S if is_reported else LEAST_PERIOD_S
