# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Counts the messages that topics lose before they can be relayed, and warns of them."""

from __future__ import annotations

from collections.abc import Mapping

from smarttestudo.domain.dataclass import dataclass
from smarttestudo.domain.robot import RobotLog, Subscription
from smarttestudo.domain.units import NS_PER_S

PAUSE_NS = 10 * NS_PER_S
"""How long a topic is not reported again."""


@dataclass(slots=True)
class _Losses:
    said: int = 0
    silent_until_ns: int = 0


class LiveLosses:
    """Counts what each topic lost, and warns of what it lost since it was last reported."""

    def __init__(self, log: RobotLog) -> None:
        self._log = log
        self._open: Mapping[str, Subscription] = {}
        self._losses: dict[str, _Losses] = {}
        self._ended: dict[str, int] = {}
        """What subscriptions lost that are closed."""

    def measure(self, subscriptions: Mapping[str, Subscription], now_ns: int) -> None:
        """Count for the subscriptions that are open; times may jump back."""
        if subscriptions is not self._open:
            self._end_all_but(subscriptions)
            self._open = subscriptions
        for topic, subscription in subscriptions.items():
            if subscription.dropped:
                self._say_in_time(topic, subscription, now_ns)

    def lost(self) -> Mapping[str, int]:
        """Messages that each topic lost so far; none for one whose messages were never numbered."""
        still_open = {
            topic: self._ended.get(topic, 0) + subscription.dropped
            for topic, subscription in self._open.items()
            if subscription.sent is not None
        }
        return {**self._ended, **still_open}

    def close(self) -> None:
        """Report what was not reported yet; nothing is received any more."""
        self.measure({}, 0)

    def _end_all_but(self, still_open: Mapping[str, Subscription]) -> None:
        for topic, subscription in self._open.items():
            if still_open.get(topic) is not subscription:
                self._say(topic, subscription, self._losses.pop(topic, _Losses()))
                if subscription.sent is not None:
                    self._ended[topic] = self._ended.get(topic, 0) + subscription.dropped

    def _say_in_time(self, topic: str, subscription: Subscription, now_ns: int) -> None:
        losses = self._losses.setdefault(topic, _Losses())
        is_silent = losses.silent_until_ns - PAUSE_NS <= now_ns < losses.silent_until_ns
        if not is_silent and self._say(topic, subscription, losses):
            losses.silent_until_ns = now_ns + PAUSE_NS

    def _say(self, topic: str, subscription: Subscription, losses: _Losses) -> bool:
        """Whether there was anything to say."""
        lost = subscription.dropped - losses.said
        if lost:
            losses.said += lost
            self._log.warning(
                f"{topic}: lost {lost} messages before they could be relayed; "
                "either this machine or its network is too slow for them"
            )
        return lost > 0
