# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""One topic of a robot while it runs: subscribed to where it is wanted, published where relayed."""

from __future__ import annotations

from collections.abc import Hashable, Iterator
from contextlib import contextmanager

from smarttestudo.composition.live_source import LiveSource, suits
from smarttestudo.composition.outlets import Outlets
from smarttestudo.domain.errors import RosError
from smarttestudo.domain.payload import Payload
from smarttestudo.domain.robot import DataPath, Inlet, Receive


class LiveTopic:
    """What is open for one topic, following its source.

    ``output`` is its monitored topic, ``None`` if it is only watched. ``unheard`` are publishers whose
    messages are dropped. ``problem`` says why nothing is open: what opens something may raise ``RosError``;
    it is not tried again until the source changes.
    """

    def __init__(
        self, topic: str, output: str | None, path: DataPath, receive: Receive, priority: float = 0.0
    ) -> None:
        self.topic = topic
        self.output = output
        self.source: LiveSource | None = None
        self.unheard: frozenset[Hashable] = frozenset()
        self.problem: str | None = None
        self._path = path
        self._receive = receive
        self._priority = priority
        self.is_wanted = False
        self._opened_for: LiveSource | None = None
        self.inlet: Inlet | None = None
        self._outlets: Outlets | None = None

    def follow(self, source: LiveSource) -> None:
        """Open what ``source`` needs, anew where what is open does not suit it. Raises ``RosError``."""
        before, self.source = self.source, source
        if self._opened_for is None or not suits(self._opened_for, source):
            self._open()
        elif before is not None and self._outlets is not None and source.publishers:
            self._outlets.forget(before.gids - source.gids)

    def want(self, *, is_wanted: bool) -> bool:
        """Subscribe, or do so no longer; whether that is a change. Raises ``RosError``."""
        if is_wanted == self.is_wanted:
            return False
        self.is_wanted = is_wanted
        if self._opened_for is None:
            return False
        if is_wanted:
            with self._closed_on_error():
                self._subscribe(self._opened_for)
        elif self._opened_for.qos.transient_local:
            # What is latched comes anew with the next subscription, and must not be there twice.
            self._open()
        else:
            self._unsubscribe()
        return True

    def publish(self, payload: Payload, publisher: Hashable) -> None:
        """Send a message on the monitored topic. Raises ``RosError``."""
        if self._outlets is not None:
            self._outlets.publish(payload, publisher)

    def close(self) -> None:
        """Receive and send nothing more."""
        self._opened_for = None
        self._unsubscribe()
        if self._outlets is not None:
            self._outlets.close()
            self._outlets = None

    def _open(self) -> None:
        self.close()
        source = self.source
        assert source is not None
        with self._closed_on_error():
            if self.output is not None:
                self._outlets = self._outlets_to(self.output, source)
            if self.is_wanted:
                self._subscribe(source)
        self._opened_for, self.problem = source, None

    @contextmanager
    def _closed_on_error(self) -> Iterator[None]:
        try:
            yield
        except RosError as error:
            self.close()
            self.problem = error.cause
            raise

    def _outlets_to(self, output: str, source: LiveSource) -> Outlets:
        return Outlets(
            lambda: self._path.advertise(output, source.type_name, source.qos),
            one_each=source.qos.transient_local and self._path.tells_publishers,
        )

    def _subscribe(self, source: LiveSource) -> None:
        self.inlet = self._path.subscribe(
            self.topic, source.type_name, source.inlet_qos, self._received, priority=self._priority
        )

    def _unsubscribe(self) -> None:
        if self.inlet is not None:
            self.inlet.close()
            self.inlet = None

    def _received(self, payload: Payload, publisher: Hashable) -> None:
        if publisher not in self.unheard:
            self._receive(payload, publisher)
