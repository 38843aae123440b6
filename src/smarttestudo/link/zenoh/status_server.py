# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A robot's statuses at its end of a link: what changed for all who listen, all of it for who asks."""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping

import zenoh

from smarttestudo.domain.errors import LinkError
from smarttestudo.domain.status import compact_status, is_measured
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.link.protocol.status_stream import StatusSender
from smarttestudo.link.zenoh.compression import compress
from smarttestudo.link.zenoh.query_server import Query, QueryServer

_FULLS_PER_SECOND = 4
"""How many full statuses are sent to those who ask; more would be felt on a thin link."""


class StatusServer:
    """Sends each status once, however many listen; routers share it among them."""

    def __init__(
        self, session: zenoh.Session, server: QueryServer, key: str, clock: Callable[[], int]
    ) -> None:
        self.is_watched = False
        self._clock = clock
        self._sender = StatusSender(is_measured, compress)
        self._lock = threading.Lock()
        self._second = 0
        self._fulls = 0
        # What is dropped is missed by who listens, who then asks for a full status.
        self._publisher = session.declare_publisher(
            key, congestion_control=zenoh.CongestionControl.DROP, priority=zenoh.Priority.DATA_HIGH
        )
        # Kept alive: Zenoh undeclares on garbage collection.
        self._kept = self._publisher.declare_matching_listener(self._match)
        server.serve(key, self._answer)

    def tell(self, status: Mapping[str, object]) -> None:
        """Send ``status``, an object of JSON; never waits for the link."""
        with self._lock:
            data = self._sender.next(compact_status(status), self._clock())
        try:
            self._publisher.put(data)
        except zenoh.ZError as error:
            raise LinkError(f"no status is sent over the link: {error}") from error

    def _match(self, status: zenoh.MatchingStatus) -> None:
        self.is_watched = status.matching

    def _answer(self, query: Query) -> None:
        with self._lock:
            second = self._clock() // NS_PER_S
            if second != self._second:
                self._second, self._fulls = second, 0
            self._fulls += 1
            if self._fulls > _FULLS_PER_SECOND:
                raise LinkError("too many ask for a status at once", remedy="ask again in a second")
            data = self._sender.full()
        query.reply(data)
