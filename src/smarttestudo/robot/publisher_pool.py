# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Publishers of an output topic: one for all, or one for each publisher of the source."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Sequence, Set
from contextlib import ExitStack

from smarttestudo.domain.robot import Payload, Publisher
from smarttestudo.robot.gone_publishers import GonePublishers

MAX_PUBLISHERS = 64


class PublisherPool:
    """One publisher for all, or with ``one_each`` one for each publisher of the source.

    The latter is for latched topics: a publisher keeps the last messages only, so that a source's publisher
    that sends often would push out the single message of another one. Where a link keeps only the newest
    message, it is so for every topic. All calls may raise what the middleware does.
    """

    def __init__(self, advertise: Callable[[], Publisher], *, one_each: bool) -> None:
        self._advertise = advertise
        self._one_each = one_each
        self._of: dict[Hashable, Publisher] = {}
        self._gone = GonePublishers()
        # One is there before the first message, so that subscribers find it in time.
        self._spare: Publisher | None = advertise()

    def publish(self, payload: Payload, publisher: Hashable) -> None:
        """Send a message of ``publisher``."""
        key = publisher if self._one_each else None
        open_publisher = self._of.get(key)
        if open_publisher is None:
            open_publisher = self._open(key)
        open_publisher.publish(payload)

    @property
    def only(self) -> Publisher | None:
        """The publisher of all messages; ``None`` with one for each publisher of the source."""
        if self._one_each:
            return None
        return self._of.get(None) or self._open(None)

    def forget_undiscovered(
        self, known: Set[Hashable], found: Callable[[], Set[Hashable]], now_ns: int
    ) -> None:
        """Forget those that were heard, and were gone before the graph was polled.

        ``known`` are forgotten when they go. ``found``, which costs more, are those that are there now; where
        there are none, the one that came last stays.
        """
        if not self._one_each or self._of.keys() <= known:
            return
        there = found()
        heard = tuple(self._of)
        self.forget(self._gone.among(heard, known | there, now_ns, is_somebody_there=bool(there)))

    def forget(self, publishers: Iterable[Hashable]) -> None:
        """These are gone, and what they latched goes with them."""
        gone = [self._of.pop(publisher) for publisher in publishers if publisher in self._of]
        if gone and not self._of and self._spare is None:
            self._spare = self._advertise()
        _close(gone)

    def close(self) -> None:
        """Send nothing more."""
        _close([one for one in (*self._of.values(), self._spare) if one is not None])

    def _open(self, key: Hashable) -> Publisher:
        if len(self._of) >= MAX_PUBLISHERS:
            key = None
        if key not in self._of:
            self._of[key] = self._spare or self._advertise()
            self._spare = None
        return self._of[key]


def _close(publishers: Sequence[Publisher]) -> None:
    """Close all, though one fails."""
    with ExitStack() as closing:
        for one in publishers:
            closing.callback(one.close)
