# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Says which topics lose messages before they can be relayed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from smarttestudo.domain.robot import Inlet, RobotLog
from smarttestudo.domain.units import NS_PER_S

PAUSE_NS = 10 * NS_PER_S
"""How long nothing more is said of a topic."""


@dataclass(slots=True)
class _Losses:
    inlet: Inlet
    said: int = 0
    silent_until_ns: int = 0


class LiveLosses:
    """Warns of each topic that lost messages since it was last spoken of."""

    def __init__(self, log: RobotLog) -> None:
        self._log = log
        self._losses: dict[str, _Losses] = {}

    def look(self, inlets: Mapping[str, Inlet], now_ns: int) -> None:
        """Look at the subscriptions that are open; times may jump back."""
        self._losses = {
            topic: losses for topic, losses in self._losses.items() if inlets.get(topic) is losses.inlet
        }
        for topic, inlet in inlets.items():
            if inlet.dropped:
                self._say(topic, self._losses.setdefault(topic, _Losses(inlet)), now_ns)

    def _say(self, topic: str, losses: _Losses, now_ns: int) -> None:
        lost = losses.inlet.dropped - losses.said
        if lost and not losses.silent_until_ns - PAUSE_NS <= now_ns < losses.silent_until_ns:
            losses.said += lost
            losses.silent_until_ns = now_ns + PAUSE_NS
            self._log.warning(
                f"{topic}: lost {lost} messages before they could be relayed; "
                "either this machine or its network is too slow for them"
            )
