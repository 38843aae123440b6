# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Zenoh clients at several places, as one.

A client of Zenoh is at one place only. A router would be at all of them, but it would also join them: robots
would be heard, and served, through the machine of somebody who only watches.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from functools import partial

import zenoh

from smarttestudo.domain.remote_robots import ANSWER_WITHIN_S
from smarttestudo.link.protocol.keys import MAX_ROBOTS, Boot, boot_of
from smarttestudo.link.protocol.status_stream import Record
from smarttestudo.link.zenoh.link_client import LinkClient
from smarttestudo.link.zenoh.query_client import Present, QueryClient, Reply
from smarttestudo.link.zenoh.status_listener import Heard


class LinkClients(QueryClient):
    """The robots that any of ``clients`` reaches, each once; a robot is asked where it was found first."""

    def __init__(self, clients: Sequence[LinkClient]) -> None:
        super().__init__(None)
        self._clients = clients
        self._reach: dict[Boot, dict[LinkClient, None]] = {}
        self._unsettled = set(clients)
        self._lock = threading.Lock()

    @property
    def problem(self) -> str | None:
        """Why nobody is connected at any place, or who is not understood."""
        told = [client for client in self._clients if client.is_connected] or self._clients
        return "; ".join(filter(None, (client.problem for client in told))) or None

    @property
    def is_refused(self) -> bool:
        """Whether nobody is connected, and somebody at one of the places does not let us in."""
        return not any(client.is_connected for client in self._clients) and any(
            client.is_refused for client in self._clients
        )

    def begin(self, present: Present, all_known: Callable[[], None], heard: Heard | None = None) -> None:
        """Connect, as ``LinkClient.begin``; a place that cannot be reached now has nobody to be known."""
        for client in self._clients:
            settle = partial(self._settle, client, all_known)
            client.begin(
                partial(self._see, client, present),
                settle,
                None if heard is None else partial(self._hear, client, heard),
                unreachable=settle,
            )

    def get(
        self,
        key: str,
        payload: bytes | None,
        answered: Callable[[Reply], None],
        timeout_s: float = ANSWER_WITHIN_S,
        *,
        priority: zenoh.Priority = zenoh.Priority.DATA_LOW,
        congestion_control: zenoh.CongestionControl = zenoh.CongestionControl.BLOCK,
    ) -> None:
        """Have ``answered`` called once with what came of a question, by any thread."""
        with self._lock:
            boot = boot_of(key.rpartition("/")[0])
            client = self._clients[0] if boot is None else self._first(boot) or self._clients[0]
        client.get(
            key, payload, answered, timeout_s, priority=priority, congestion_control=congestion_control
        )

    def close(self) -> None:
        """Leave all places."""
        for client in self._clients:
            client.close()

    def _first(self, boot: Boot) -> LinkClient | None:
        return next(iter(self._reach.get(boot, ())), None)

    def _see(self, client: LinkClient, present: Present, boot: Boot, is_present: bool) -> None:  # noqa: FBT001 - as Present
        with self._lock:
            was_present = boot in self._reach
            if is_present and (was_present or len(self._reach) < MAX_ROBOTS):
                self._reach.setdefault(boot, {})[client] = None
            elif was_present and not is_present:
                self._reach[boot].pop(client, None)
                if not self._reach[boot]:
                    del self._reach[boot]
            if was_present != (boot in self._reach):
                present(boot, is_present)

    def _hear(self, client: LinkClient, heard: Heard, boot: Boot, record: Record, size_bytes: int) -> None:
        with self._lock:
            is_first = self._first(boot) is client
        if is_first:
            heard(boot, record, size_bytes)

    def _settle(self, client: LinkClient, all_known: Callable[[], None]) -> None:
        with self._lock:
            is_last = self._unsettled == {client}
            self._unsettled.discard(client)
        if is_last:
            all_known()
