# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The publishers of one monitored topic."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable

from smarttestudo.domain.payload import Payload
from smarttestudo.domain.robot import Outlet

MAX_OUTLETS = 64


class Outlets:
    """One publisher for all, or with ``one_each`` one for each publisher of the source.

    The latter is for latched topics: a publisher keeps the last messages only, so that a source's publisher
    that often says something would push out what another one said once. ``advertise`` may raise ``RosError``.
    """

    def __init__(self, advertise: Callable[[], Outlet], *, one_each: bool) -> None:
        self._advertise = advertise
        self._one_each = one_each
        self._of: dict[Hashable, Outlet] = {}
        # One is there before the first message, so that subscribers find it in time.
        self._spare: Outlet | None = advertise()

    def publish(self, payload: Payload, publisher: Hashable) -> None:
        """Send a message of ``publisher``. Raises ``RosError``."""
        key = publisher if self._one_each else None
        outlet = self._of.get(key)
        if outlet is None:
            outlet = self._open(key)
        outlet.publish(payload)

    def forget(self, publishers: Iterable[Hashable]) -> None:
        """These are gone, and what they latched goes with them. Raises ``RosError``."""
        gone = [self._of.pop(publisher) for publisher in publishers if publisher in self._of]
        if gone and not self._of and self._spare is None:
            self._spare = self._advertise()
        for outlet in gone:
            outlet.close()

    def close(self) -> None:
        """Send nothing more."""
        for outlet in (*self._of.values(), self._spare):
            if outlet is not None:
                outlet.close()

    def _open(self, key: Hashable) -> Outlet:
        if len(self._of) >= MAX_OUTLETS:
            key = None
        if key not in self._of:
            self._of[key] = self._spare or self._advertise()
            self._spare = None
        return self._of[key]
