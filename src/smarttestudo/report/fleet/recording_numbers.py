# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The numbers of one recording, or of a pair, that the report over many adds up."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from datetime import datetime, timezone
from typing import Annotated

from smarttestudo.domain.record import JsonEntry, derived
from smarttestudo.domain.units import NS_PER_S, utc_time
from smarttestudo.report.summary import PositionError


@dataclass(frozen=True, slots=True, kw_only=True)
class Received:
    """The part of a topic that the operator received in the time of A, and its ages as in ``TopicLoss``."""

    messages: int
    size_bytes: Annotated[int, JsonEntry(name="bytes")]
    age_mean_s: float | None
    age_max_s: float | None


def _lost(messages: int, received_messages: int | None) -> int:
    """The ``messages`` that were not received; 0 where nobody knows."""
    return 0 if received_messages is None else max(messages - received_messages, 0)


@dataclass(frozen=True, slots=True, kw_only=True)
class TopicNumbers:
    """A topic of A; ``received`` is ``None`` where B lacks it, and where there is no B."""

    topic: str
    messages: int
    size_bytes: Annotated[int, JsonEntry(name="bytes")]
    received: Received | None = None

    @property
    def lost(self) -> int:
        """Messages that the operator did not get; 0 where nobody knows."""
        return _lost(self.messages, None if self.received is None else self.received.messages)


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleNumbers:
    """Messages and bytes of topics, each while ``rule`` decided its rate, to the second; "" is the defaults.

    ``decided_s`` is how long it decided the most topics, ``decisions`` how often it began to decide one.
    """

    rule: str
    decided_s: float
    decisions: int
    messages: int
    size_bytes: Annotated[int, JsonEntry(name="bytes")]
    received_messages: int | None
    received_bytes: int | None

    @property
    def lost(self) -> int:
        """As of ``TopicNumbers``."""
        return _lost(self.messages, self.received_messages)


@dataclass(frozen=True, slots=True, kw_only=True)
class BoundNumbers:
    """How a bound of the rules was kept, as of ``BoundLoss``; ``picture`` is its topic and property."""

    picture: str
    unit: str
    bound: float
    messages: int
    broken: int
    worst: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordingNumbers:
    """The numbers of A, and of what B has of it; ``robot`` is "" where the names of folders do not tell.

    ``position`` is how far off the operator's picture of the robot's place was. ``rules`` are known where
    rules decided over A, ``bounds`` where there is a B, too. ``unmatched`` are patterns of topics that name
    none here. ``notices`` say what was lost or odd, a line each. An empty A has no time.
    """

    a: str
    b: str | None
    robot: str
    start_ns: Annotated[int, JsonEntry(is_absent=True)]
    is_empty: Annotated[bool, JsonEntry(is_absent=True)] = False
    duration_s: float
    topics: Annotated[tuple[TopicNumbers, ...], JsonEntry(keyed_by="topic")]
    rules: tuple[RuleNumbers, ...] = ()
    bounds: tuple[BoundNumbers, ...] = ()
    position: PositionError | None = None
    unmatched: Annotated[frozenset[str], JsonEntry(is_absent=True)] = frozenset()
    notices: tuple[str, ...] = ()

    @property
    @derived()
    def start(self) -> str | None:
        """Date and time of the first message of A."""
        return None if self.is_empty else utc_time(self.start_ns)

    @property
    @derived("start_ns")
    def known_start_ns(self) -> int | None:
        """Stamp of the first message of A, if there is one."""
        return None if self.is_empty else self.start_ns

    def rows(self) -> Iterator[dict[str, object]]:
        """One row for each topic, for ``--csv``."""
        began_at = datetime.fromtimestamp(self.start_ns // NS_PER_S, tz=timezone.utc)
        recorded_at = None if self.is_empty else began_at
        for one in self.topics:
            got = one.received
            yield {
                "a": self.a,
                "b": self.b,
                "robot": self.robot,
                "recorded_at": recorded_at,
                "duration_s": self.duration_s,
                "topic": one.topic,
                "messages": one.messages,
                "bytes": one.size_bytes,
                "received_messages": got.messages if got else None,
                "received_bytes": got.size_bytes if got else None,
                "lost_messages": one.lost if got else None,
                "age_mean_s": got.age_mean_s if got else None,
                "age_max_s": got.age_max_s if got else None,
            }
