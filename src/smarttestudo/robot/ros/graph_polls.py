# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""When to poll the ROS graph."""

from __future__ import annotations

from collections.abc import Callable

from smarttestudo.domain.robot import GraphChange, PollGraph
from smarttestudo.robot.ros.real_timers import RealTimers

LEAST_PERIOD_S = 0.2
"""The shortest time between checks of the graph, and the period if changes are not reported."""
NET_PERIOD_S = 1.0
"""The period without a reported change: changes that are not reported are found too."""


class GraphPolls:
    """Has ``poll`` called by ``timers``: at once, soon after ``changed``, and now and then in any case.

    ``is_told`` is whether ``changed`` is called. Times are those of the steady clock ``steady_s``.
    """

    def __init__(
        self,
        timers: RealTimers,
        poll: PollGraph,
        is_told: Callable[[], bool],
        steady_s: Callable[[], float],
    ) -> None:
        self._timers = timers
        self._poll = poll
        self._is_told = is_told
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
        is_told = self._is_told()
        self._poll(GraphChange.TOLD if has_changed else GraphChange.NONE if is_told else GraphChange.UNTOLD)
        return NET_PERIOD_S if is_told else LEAST_PERIOD_S
