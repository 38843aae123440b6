# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""More statuses of a robot while somebody watches it, and as many as before once nobody does."""

from __future__ import annotations

_TRY_AGAIN_S = 3.0


class StatusDemand:
    """What to set ``status_hz`` of one robot to.

    Others may set it, too: nobody is given fewer than they had.
    """

    def __init__(self) -> None:
        self.wanted_hz: float | None = None
        self._ours_hz: float | None = None
        self._before_hz = 0.0
        self._again_s = 0.0

    @property
    def is_settled(self) -> bool:
        """Whether nobody watches, and nothing is to be put back."""
        return self.wanted_hz is None and self._ours_hz is None

    def change_hz(self, status_hz: float, now_s: float) -> float | None:
        """What to set at ``now_s``, where the robot said that it is ``status_hz``; ``None``: nothing."""
        if self.wanted_hz is None:
            return self._put_back_hz(status_hz, now_s)
        is_ours = status_hz == self._ours_hz
        if status_hz >= self.wanted_hz and not (is_ours and status_hz > self.wanted_hz):
            return None
        if self.wanted_hz == self._ours_hz and now_s < self._again_s:
            return None
        if self._ours_hz is None:
            self._before_hz = status_hz
        self._ours_hz, self._again_s = self.wanted_hz, now_s + _TRY_AGAIN_S
        return self.wanted_hz

    def _put_back_hz(self, status_hz: float, now_s: float) -> float | None:
        ours_hz, self._ours_hz = self._ours_hz, None
        # What was set a moment ago is not in a status yet.
        is_ours = ours_hz is not None and (status_hz == ours_hz or now_s < self._again_s)
        return self._before_hz if is_ours else None
