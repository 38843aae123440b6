# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Messages of an incident that the disk did not take."""

from __future__ import annotations

from dataclasses import replace

from smarttestudo.domain.incident import Missing, MissingReason
from smarttestudo.incidents.topic_ring import IncidentMessage


class LostMessages:
    """Counts messages by topic, from the first to the last."""

    def __init__(self) -> None:
        self._topics: dict[str, Missing] = {}

    def add(self, message: IncidentMessage) -> None:
        """One more was lost."""
        known = self._topics.get(message.topic)
        if known is None:
            known = Missing(
                topic=message.topic,
                reason=MissingReason.DISK,
                messages=0,
                from_ns=message.stamp_ns,
                to_ns=message.stamp_ns,
            )
        self._topics[message.topic] = replace(
            known, messages=(known.messages or 0) + 1, to_ns=message.stamp_ns
        )

    def missing(self) -> tuple[Missing, ...]:
        """Losses for the record of an incident."""
        return tuple(self._topics.values())
