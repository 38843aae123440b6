# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Warns of topics that lose messages before they can be relayed."""

from __future__ import annotations

from collections.abc import Mapping

from smarttestudo.domain.dataclass import dataclass
from smarttestudo.domain.robot import RobotLog, Subscription
from smarttestudo.domain.units import NS_PER_S

PAUSE_NS = 10 * NS_PER_S
"""How long a topic is not reported again."""


@dataclass(slots=True)
class _Losses:
    subscription: Subscription
    said: int = 0
    silent_until_ns: int = 0


class LiveLosses:
    """Warns of each topic that lost messages since it was last reported."""

    def __init__(self, log: RobotLog) -> None:
        self._log = log
        self._losses: dict[str, _Losses] = {}

    def measure(self, subscriptions: Mapping[str, Subscription], now_ns: int) -> None:
        """Count for the subscriptions that are open; times may jump back."""
        self._losses = {
            topic: losses
            for topic, losses in self._losses.items()
            if subscriptions.get(topic) is losses.subscription
        }
        for topic, subscription in subscriptions.items():
            if subscription.dropped:
                self._say(topic, self._losses.setdefault(topic, _Losses(subscription)), now_ns)

    def _say(self, topic: str, losses: _Losses, now_ns: int) -> None:
        lost = losses.subscription.dropped - losses.said
        if lost and not losses.silent_until_ns - PAUSE_NS <= now_ns < losses.silent_until_ns:
            losses.said += lost
            losses.silent_until_ns = now_ns + PAUSE_NS
            self._log.warning(
                f"{topic}: lost {lost} messages before they could be relayed; "
                "either this machine or its network is too slow for them"
            )
