# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Zenoh clients that watch robots and ask them, connected again and again without a hand."""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping, Sequence
from functools import partial

import zenoh

from smarttestudo.link.protocol.keys import MAX_ROBOTS, Boot, boot_of
from smarttestudo.link.protocol.status_stream import Record
from smarttestudo.link.worker import Worker
from smarttestudo.link.zenoh.queries import OnPresence, QueryClient
from smarttestudo.link.zenoh.session import (
    POLL_PERIOD_S,
    OtherVersions,
    close_session,
    is_connected,
    why_unreachable,
)
from smarttestudo.link.zenoh.statuses import OnStatus, StatusListener

_TRY_AGAIN_S = 1.0


class LinkClient(QueryClient):
    """Connects to ``endpoints`` by a Zenoh ``config`` on a thread of its own, from ``begin`` on."""

    def __init__(self, config: zenoh.Config, known: Mapping[str, object], endpoints: tuple[str, ...]) -> None:
        super().__init__(None)
        self._config = config
        self._known = known
        self._endpoints = endpoints
        self._unreachable: str | None = f"{', '.join(endpoints)}: nobody answers yet"
        self._is_refused = False
        self._versions = OtherVersions()
        self._listener: StatusListener | None = None
        self._on_status: OnStatus | None = None
        self._on_presence: OnPresence = lambda *_: None
        self._all_known: Callable[[], None] = lambda: None
        self._say_unreachable: Callable[[], None] = lambda: None
        self._worker = Worker("link-client", self._fail, self._poll)

    @property
    def is_connected(self) -> bool:
        """Whether somebody was there lately."""
        return self._unreachable is None

    @property
    def problem(self) -> str | None:
        """Why nobody is connected, or who is not understood."""
        return "; ".join(filter(None, (self._unreachable, *self._versions.present.values()))) or None

    @property
    def is_refused(self) -> bool:
        """Whether nobody is connected because somebody there does not let us in, or we not them."""
        return self._unreachable is not None and self._is_refused

    def begin(
        self,
        on_presence: OnPresence,
        all_known: Callable[[], None],
        on_status: OnStatus | None = None,
        unreachable: Callable[[], None] = lambda: None,
    ) -> None:
        """Connect; say who is there, and once that these are all who were there before.

        Statuses are asked for, and given to ``on_status``, where that is given. ``unreachable`` is called
        each time that nobody answers.
        """
        self._on_presence, self._all_known, self._on_status = on_presence, all_known, on_status
        self._say_unreachable = unreachable
        self._worker.start()

    def close(self) -> None:
        self._worker.close()
        session, self._session = self._session, None
        if session is not None:
            close_session(session)

    def _poll(self) -> float:
        session = self._session or self._opened()
        if session is None:
            self._unreachable = self._why()
            self._say_unreachable()
            return _TRY_AGAIN_S
        self._unreachable = None if is_connected(session) else self._why()
        return POLL_PERIOD_S if self._listener is None else min(self._listener.poll(), POLL_PERIOD_S)

    def _opened(self) -> zenoh.Session | None:
        try:
            session = zenoh.open(self._config)
        except zenoh.ZError:
            return None
        if self._on_status is not None:
            self._listener = StatusListener(session, self._on_status, self._versions, self._worker.wake)
        self._session = session
        super().begin(self._follow, self._all_known)
        return session

    def _follow(self, boot: Boot, is_present: bool) -> None:  # noqa: FBT001 - as OnPresence
        """Hear the statuses of who is there, before that is said."""
        if self._listener is not None:
            (self._listener.add if is_present else self._listener.remove)(boot)
        self._on_presence(boot, is_present)

    def _why(self) -> str:
        found = [why_unreachable(endpoint, self._known) for endpoint in self._endpoints]
        self._is_refused = any(problem.is_refused for problem in found)
        return "; ".join(problem.why for problem in found)

    def _fail(self, error: Exception) -> None:
        self._unreachable = f"{', '.join(self._endpoints)}: {error}"


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
        asked = [client for client in self._clients if client.is_connected] or self._clients
        return "; ".join(filter(None, (client.problem for client in asked))) or None

    @property
    def is_refused(self) -> bool:
        """Whether nobody is connected, and somebody at one of the places does not let us in."""
        return not any(client.is_connected for client in self._clients) and any(
            client.is_refused for client in self._clients
        )

    def begin(
        self, on_presence: OnPresence, all_known: Callable[[], None], on_status: OnStatus | None = None
    ) -> None:
        """Connect, as ``LinkClient.begin``; a place that cannot be reached now has nobody to be known."""
        for client in self._clients:
            settle = partial(self._settle, client, all_known)
            client.begin(
                partial(self._presence_at, client, on_presence),
                settle,
                None if on_status is None else partial(self._status_at, client, on_status),
                unreachable=settle,
            )

    def session_for(self, key: str) -> zenoh.Session | None:
        """The session with the place where the robot was found first."""
        with self._lock:
            boot = boot_of(key.rpartition("/")[0])
            client = self._clients[0] if boot is None else self._first(boot) or self._clients[0]
        return client.session_for(key)

    def close(self) -> None:
        for client in self._clients:
            client.close()

    def _first(self, boot: Boot) -> LinkClient | None:
        return next(iter(self._reach.get(boot, ())), None)

    def _presence_at(
        self,
        client: LinkClient,
        on_presence: OnPresence,
        boot: Boot,
        is_present: bool,  # noqa: FBT001 - as OnPresence
    ) -> None:
        with self._lock:
            was_present = boot in self._reach
            if is_present and (was_present or len(self._reach) < MAX_ROBOTS):
                self._reach.setdefault(boot, {})[client] = None
            elif was_present and not is_present:
                self._reach[boot].pop(client, None)
                if not self._reach[boot]:
                    del self._reach[boot]
            if was_present != (boot in self._reach):
                on_presence(boot, is_present)

    def _status_at(
        self, client: LinkClient, on_status: OnStatus, boot: Boot, record: Record, size_bytes: int
    ) -> None:
        with self._lock:
            is_first = self._first(boot) is client
        if is_first:
            on_status(boot, record, size_bytes)

    def _settle(self, client: LinkClient, all_known: Callable[[], None]) -> None:
        with self._lock:
            is_last = self._unsettled == {client}
            self._unsettled.discard(client)
        if is_last:
            all_known()
