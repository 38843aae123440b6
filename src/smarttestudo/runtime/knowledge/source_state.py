# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Whether a source can still be believed."""

from __future__ import annotations

from smarttestudo.domain.observation import SourceChanged
from smarttestudo.domain.source_period import SourcePeriod


class SourceState:
    """The arrivals of a topic and what is said of its publishers.

    It is fresh from a message on until it is stale or the last publisher has left; then a publisher and a
    message must come, in either order: a latched message may overtake the news of its publisher.
    """

    __slots__ = (
        "_has_publishers",
        "_is_heard",
        "_period",
        "_stale_after_ns",
        "_start_ns",
        "_transient_local",
    )

    def __init__(self, start_ns: int, stale_after_ns: int | None) -> None:
        self._start_ns = start_ns
        self._stale_after_ns = stale_after_ns
        self._period = SourcePeriod()
        self._is_heard = False
        self._has_publishers = True
        self._transient_local = False

    def carry_on(self, before: SourceState) -> None:
        """Take over what ``before`` knows of the source."""
        self._start_ns = before._start_ns
        self._period = before._period
        self._is_heard = before._is_heard
        self._has_publishers = before._has_publishers
        self._transient_local = before._transient_local

    def record(self, now_ns: int) -> None:
        """Count an arrival."""
        self._period.record(now_ns)
        self._is_heard = True

    def change(self, change: SourceChanged) -> None:
        """Take what is said of the publishers."""
        self._has_publishers = change.publishers > 0
        self._is_heard = self._is_heard and self._has_publishers
        self._transient_local = change.transient_local

    @property
    def silent_since_ns(self) -> int:
        """The time of the last message, or the loop's start."""
        return self._start_ns if self._period.last_ns is None else self._period.last_ns

    def is_fresh(self, now_ns: int) -> bool:
        """Whether what the last message said still counts."""
        if not (self._is_heard and self._has_publishers):
            return False
        stale_from_ns = self.stale_from_ns
        return stale_from_ns is None or now_ns < stale_from_ns

    @property
    def stale_from_ns(self) -> int | None:
        """When the last message becomes stale; ``None`` while it never will."""
        return self._period.stale_from_ns(
            stale_after_ns=self._stale_after_ns, transient_local=self._transient_local
        )
