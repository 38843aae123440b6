# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Messages of an incident that the disk did not take."""

from __future__ import annotations

from dataclasses import replace

from smarttestudo.domain.incident import Missing, MissingReason


class LostMessages:
    """Counts messages by topic, from the first to the last."""

    def __init__(self) -> None:
        self._topics: dict[str, Missing] = {}

    def add(self, topic: str, stamp_ns: int) -> None:
        """One more was lost."""
        known = self._topics.get(topic)
        if known is None:
            known = Missing(
                topic=topic, reason=MissingReason.DISK, messages=0, from_ns=stamp_ns, to_ns=stamp_ns
            )
        self._topics[topic] = replace(known, messages=(known.messages or 0) + 1, to_ns=stamp_ns)

    def missing(self) -> tuple[Missing, ...]:
        """Losses for the record of an incident."""
        return tuple(self._topics.values())
