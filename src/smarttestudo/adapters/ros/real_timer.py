# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Timers in real time, whatever clock the node has."""

from __future__ import annotations

import time
from collections.abc import Callable


class RealTimer:
    """Acts every ``period_s``; what it missed it does not catch up on. Times are ``time.monotonic``."""

    __slots__ = ("_act", "_period_s", "due_s")

    def __init__(self, period_s: float, act: Callable[[], None]) -> None:
        self._period_s = period_s
        self._act = act
        self.due_s = time.monotonic() + period_s

    def act_if_due(self, now_s: float) -> None:
        """Act once if it is time."""
        if now_s >= self.due_s:
            self.due_s = max(self.due_s + self._period_s, now_s)
            self._act()
