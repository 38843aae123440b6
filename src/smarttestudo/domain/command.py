# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Commands: messages of a few topics that an operator sends to a robot and the robot accepts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from smarttestudo.domain.link_state import CommandTopic
from smarttestudo.domain.names import full_topic_names
from smarttestudo.domain.robot import Publisher
from smarttestudo.domain.units import NS_PER_MS, NS_PER_S

MAX_AGE_NS = NS_PER_S // 2
"""Nothing older is delivered."""
MAX_COMMAND_BYTES = 64_000
MAX_COMMAND_TOPICS = 16


@dataclass(slots=True)
class SentCounts:
    """Messages of one topic at the operator's end, since the robot's end is known.

    ``replaced`` ones gave way to newer ones, ``expired`` ones became too old, before they were sent;
    ``too_large`` ones were refused.
    """

    sent: int = 0
    replaced: int = 0
    expired: int = 0
    too_large: int = 0


class IncomingCommands(Protocol):
    """Commands from operators at the robot's end of a link. Calls never wait for the link."""

    @property
    def topics(self) -> Sequence[CommandTopic]:
        """State of each accepted topic."""

    @property
    def has_operator(self) -> bool:
        """Whether an operator's end that sends anything is connected."""

    def sent_names(self) -> Sequence[tuple[str, ...]]:
        """Topics that each operator's end heard lately sends."""

    def follow(
        self, topic: str, type_name: str | None, publisher: Publisher | None, problem: str | None = None
    ) -> None:
        """From now on give ``publisher`` the messages of ``topic``, which are of that type."""


class TooOld:
    """Says of which topics all that arrives lately is too old; each once, until something is delivered."""

    def __init__(self) -> None:
        self._before: dict[str, CommandTopic] = {}
        self._said: set[str] = set()

    def new_sentences(self, topics: Sequence[CommandTopic]) -> list[str]:
        """A sentence for each topic of which that is new since the last poll."""
        sentences = []
        for now in topics:
            before = self._before.get(now.topic, now)
            self._before[now.topic] = now
            if now.delivered > before.delivered:
                self._said.discard(now.topic)
            elif now.too_old > before.too_old and now.topic not in self._said and now.age_ms is not None:
                self._said.add(now.topic)
                sentences.append(
                    f"{now.topic} arrives {now.age_ms:.0f} ms old; "
                    f"nothing older than {MAX_AGE_NS // NS_PER_MS} ms is delivered"
                )
        return sentences


def command_topics(names: Sequence[str], option: str) -> tuple[str, ...]:
    """The topics that ``option`` names, each once. Raises ``UsageError``."""
    return full_topic_names(names, option, most=MAX_COMMAND_TOPICS, like="/joy")
