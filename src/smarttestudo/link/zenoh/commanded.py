# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The robots that accept something of operators, as the operator's end knows them."""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

from smarttestudo.domain.command import SentCounts
from smarttestudo.domain.link_state import AcceptedTopic
from smarttestudo.link.zenoh.keys import Boot


@dataclass(frozen=True, slots=True, kw_only=True)
class CommandedRobot:
    """A robot's end that accepts something, as it was heard last, and what was sent to it, by topic."""

    boot: Boot
    topics: Mapping[str, AcceptedTopic]
    counts: Mapping[str, SentCounts]
    round_trip_ms: float | None


class OutgoingCommands(Protocol):
    """Messages to robots, at the operator's end of their links. Calls never wait for a link."""

    names: tuple[str, ...]

    def robots(self) -> Sequence[CommandedRobot]:
        """The robots that were heard lately."""

    def send(self, boot: Boot, topic: str, publisher: Hashable, payload: bytes) -> bool:
        """Have a message sent instead of an earlier one of its publisher; whether it is small enough."""

    def pump(self) -> None:
        """Send what is due; to be called ten times a second."""
