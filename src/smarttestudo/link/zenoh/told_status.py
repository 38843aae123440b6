# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A robot's statuses at its end of a link: what changed for all who listen, all of it for who asks."""

from __future__ import annotations

import threading
from collections.abc import Callable

import zenoh

from smarttestudo.domain.errors import LinkError
from smarttestudo.domain.status import RuntimeStatus
from smarttestudo.domain.status_json import compact_status, is_measured
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.link.protocol.status_stream import StatusSender
from smarttestudo.link.zenoh.compression import packed
from smarttestudo.link.zenoh.keys import Boot

_FULLS_PER_SECOND = 4
"""How many full statuses are sent to those who ask; more would be felt on a thin link."""


class ToldStatus:
    """Sends each status once, however many listen; routers share it among them."""

    def __init__(self, session: zenoh.Session, boot: Boot, clock: Callable[[], int]) -> None:
        self.is_watched = False
        self._key = boot.status_key
        self._clock = clock
        self._sender = StatusSender(is_measured, packed)
        self._lock = threading.Lock()
        self._second = 0
        self._fulls = 0
        # What is dropped is missed by who listens, who then asks for a full status.
        self._publisher = session.declare_publisher(
            self._key,
            congestion_control=zenoh.CongestionControl.DROP,
            priority=zenoh.Priority.DATA_HIGH,
        )
        # Undeclared where nobody holds them.
        self._kept = (
            self._publisher.declare_matching_listener(self._match),
            session.declare_queryable(self._key, self._asked),
        )

    def tell(self, status: RuntimeStatus) -> None:
        """Send ``status``; never waits for the link."""
        with self._lock:
            data = self._sender.next(compact_status(status), self._clock())
        try:
            self._publisher.put(data)
        except zenoh.ZError as error:
            raise LinkError(f"no status is sent over the link: {error}") from error

    def _match(self, status: zenoh.MatchingStatus) -> None:
        self.is_watched = status.matching

    def _asked(self, query: zenoh.Query) -> None:
        with query:
            # What is asked of many keys at once may go round access control.
            if str(query.key_expr) != self._key:
                return
            try:
                query.reply(self._key, self._full())
            except LinkError as error:
                query.reply_err(str(error).encode())

    def _full(self) -> bytes:
        with self._lock:
            second = self._clock() // NS_PER_S
            if second != self._second:
                self._second, self._fulls = second, 0
            self._fulls += 1
            if self._fulls > _FULLS_PER_SECOND:
                raise LinkError("too many ask for a status at once", remedy="ask again in a second")
            return self._sender.full()
