# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Nodes that publish the statuses of others, as a player of a recording does."""

from __future__ import annotations

import json
from collections.abc import Callable, Collection, Hashable

from smarttestudo.domain.errors import RosError
from smarttestudo.domain.names import STATUS_TOPIC, TEXT_TYPE
from smarttestudo.domain.robot import UNKNOWN_NODE, DataPath, Payload, Qos, Subscription
from smarttestudo.pacing.cdr import string_text

DOUBT_S = 2.0
"""The last status of a run is latched: it comes as soon as somebody subscribes."""
_QOS = Qos(reliable=True, transient_local=True, depth=100)


class StatusPlayers:
    """Tells players from runs, each of which is named by the statuses that it publishes.

    A node that publishes statuses is in doubt until one names it, for ``DOUBT_S`` at most. They are received
    only while there is a node that none has named. ``steady_s`` is a clock that never jumps.
    """

    def __init__(self, steady_s: Callable[[], float]) -> None:
        self.doubted: frozenset[str] = frozenset()
        self._steady_s = steady_s
        self._since_s: dict[str, float] = {}
        self._named: set[str] = set()
        self._subscription: Subscription | None = None

    def among(self, nodes: Collection[str], path: Callable[[], DataPath]) -> frozenset[str]:
        """The players among ``nodes``, which publish statuses; ``path`` opens a way to receive those.

        Where they cannot be received, no node is one.
        """
        now_s = self._steady_s()
        self._since_s = {
            name: self._since_s.get(name, now_s)
            for name in nodes
            if name not in self._named and not name.endswith(UNKNOWN_NODE)
        }
        if not self._follow(path):
            self.doubted = frozenset()
            return frozenset()
        players = frozenset(name for name, since_s in self._since_s.items() if now_s - since_s >= DOUBT_S)
        self.doubted = frozenset(self._since_s) - players
        return players

    def _follow(self, path: Callable[[], DataPath]) -> bool:
        """Receive statuses while a node is not named; whether that works."""
        if not self._since_s and self._subscription is not None:
            self._subscription.close()
            self._subscription = None
        elif self._since_s and self._subscription is None:
            try:
                self._subscription = path().subscribe(STATUS_TOPIC, TEXT_TYPE, _QOS, self._receive)
            except RosError:
                return False
        return True

    def _receive(self, payload: Payload, _publisher: Hashable) -> None:
        try:
            record = json.loads(string_text(payload[:]) or "")
        except (ValueError, RecursionError):
            return
        # Of any version: what else a status says does not count here.
        if isinstance(record, dict) and isinstance(record.get("node"), str):
            self._named.add(record["node"])
