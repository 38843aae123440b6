# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A Zenoh client that watches robots and asks them, connected again and again without a hand."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import zenoh

from smarttestudo.link.protocol.keys import Boot
from smarttestudo.link.worker import Worker
from smarttestudo.link.zenoh.query_client import Present, QueryClient
from smarttestudo.link.zenoh.reach import why_unreachable
from smarttestudo.link.zenoh.session import POLL_PERIOD_S, OtherVersions, close_session, is_connected
from smarttestudo.link.zenoh.status_listener import Heard, StatusListener

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
        self._heard: Heard | None = None
        self._present: Present = lambda *_: None
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
        present: Present,
        all_known: Callable[[], None],
        heard: Heard | None = None,
        unreachable: Callable[[], None] = lambda: None,
    ) -> None:
        """Connect; say who is there, and once that these are all who were there before.

        Statuses are asked for, and given to ``heard``, where that is given. ``unreachable`` is told each time
        that nobody answers.
        """
        self._present, self._all_known, self._heard = present, all_known, heard
        self._say_unreachable = unreachable
        self._worker.start()

    def close(self) -> None:
        """Leave."""
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
        if self._heard is not None:
            self._listener = StatusListener(session, self._heard, self._versions, self._worker.wake)
        self._session = session
        super().begin(self._follow, self._all_known)
        return session

    def _follow(self, boot: Boot, is_present: bool) -> None:  # noqa: FBT001 - as Present
        """Hear the statuses of who is there, before that is said."""
        if self._listener is not None:
            (self._listener.add if is_present else self._listener.remove)(boot)
        self._present(boot, is_present)

    def _why(self) -> str:
        found = [why_unreachable(endpoint, self._known) for endpoint in self._endpoints]
        self._is_refused = any(one.is_refused for one in found)
        return "; ".join(one.why for one in found)

    def _fail(self, error: Exception) -> None:
        self._unreachable = f"{', '.join(self._endpoints)}: {error}"
