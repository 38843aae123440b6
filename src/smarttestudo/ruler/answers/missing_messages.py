# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What is not in an incident, as the page is told."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from smarttestudo.domain.incident import Missing, MissingReason
from smarttestudo.domain.units import NS_PER_S


@dataclass(frozen=True, slots=True, kw_only=True)
class MissingMessages:
    """What is not in an incident: ``messages`` of ``topic``, null where nobody counted them.

    ``from_s`` and ``to_s`` are seconds from the trigger, negative before it.
    """

    topic: str
    reason: MissingReason
    messages: int | None
    from_s: float
    to_s: float


def missing_messages(missing: Iterable[Missing], triggered_ns: int) -> tuple[MissingMessages, ...]:
    """``missing`` of an incident that was triggered then."""
    return tuple(
        MissingMessages(
            topic=one.topic,
            reason=one.reason,
            messages=one.messages,
            from_s=(one.from_ns - triggered_ns) / NS_PER_S,
            to_s=(one.to_ns - triggered_ns) / NS_PER_S,
        )
        for one in missing
    )
