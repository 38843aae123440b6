# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The numbers of one recording or pair, and what they add up to over many, by topic and rule."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from datetime import datetime, timezone
from typing import Annotated

from smarttestudo.bags.statistics import RecordingSpan
from smarttestudo.domain.record import JsonEntry, to_columns
from smarttestudo.domain.units import NS_PER_S
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
    """The numbers of A, whose time is ``span``, and of what B has of it.

    ``robot`` is "" where the names of folders do not tell. ``position`` is how far off the operator's picture
    of the robot's place was. ``rules`` are known where rules decided over A, ``bounds`` where there is a B,
    too. ``unmatched`` are patterns of topics that name none here. ``notices`` say what was lost or odd, a
    line each.
    """

    a: str
    b: str | None
    robot: str
    span: Annotated[RecordingSpan, JsonEntry(is_merged=True)]
    topics: Annotated[tuple[TopicNumbers, ...], JsonEntry(keyed_by="topic")]
    rules: tuple[RuleNumbers, ...] = ()
    bounds: tuple[BoundNumbers, ...] = ()
    position: PositionError | None = None
    unmatched: Annotated[frozenset[str], JsonEntry(is_absent=True)] = frozenset()
    notices: tuple[str, ...] = ()

    def rows(self) -> Iterator[dict[str, object]]:
        """One row for each topic, for ``--csv``."""
        began_at = datetime.fromtimestamp(self.span.start_ns // NS_PER_S, tz=timezone.utc)
        recorded_at = None if self.span.is_empty else began_at
        for topic in self.topics:
            got = topic.received
            row = ReportRow(
                a=self.a,
                b=self.b,
                robot=self.robot,
                recorded_at=recorded_at,
                duration_s=self.span.duration_s,
                topic=topic.topic,
                messages=topic.messages,
                size_bytes=topic.size_bytes,
                received_messages=got.messages if got else None,
                received_bytes=got.size_bytes if got else None,
                lost_messages=topic.lost if got else None,
                age_mean_s=got.age_mean_s if got else None,
                age_max_s=got.age_max_s if got else None,
            )
            yield to_columns(row)


@dataclass(frozen=True, slots=True, kw_only=True)
class ReportRow:
    """A topic of a recording or a pair as a row."""

    a: str
    b: str | None
    robot: str
    recorded_at: datetime | None
    duration_s: float
    topic: str
    messages: int
    size_bytes: Annotated[int, JsonEntry(name="bytes")]
    received_messages: int | None
    received_bytes: int | None
    lost_messages: int | None
    age_mean_s: float | None
    age_max_s: float | None


def percent(part: float, whole: float) -> float | None:
    """``part`` in percent of ``whole``; ``None`` of nothing."""
    return 100 * part / whole if whole else None


@dataclass(slots=True, kw_only=True)
class Volume:
    """Messages and bytes in some recordings, and what of them the operator received.

    ``shared_messages`` are those of the topics that the operator has, too; only of these some can be lost.
    """

    recordings: int = 0
    messages: int = 0
    size_bytes: int = 0
    shared_messages: int = 0
    received_bytes: int = 0
    lost: int = 0

    @property
    def lost_percent(self) -> float | None:
        """The share of the messages that the operator did not get; ``None`` where there is none to get."""
        return percent(self.lost, self.shared_messages)

    def _count(self, numbers: TopicNumbers | RuleNumbers, received_bytes: int | None) -> None:
        self.messages += numbers.messages
        self.size_bytes += numbers.size_bytes
        self.lost += numbers.lost
        if received_bytes is not None:
            self.shared_messages += numbers.messages
            self.received_bytes += received_bytes


@dataclass(slots=True, kw_only=True)
class Sums(Volume):
    """The volume of topics of some recordings, and how the operator saw them.

    ``age_max_s`` is the longest time without a newer message, ``position_m`` the largest error of a robot's
    place (RMSE of a recording).
    """

    duration_s: float = 0.0
    age_max_s: float | None = None
    position_m: float | None = None

    def add(self, recording: RecordingNumbers, topics: Iterable[TopicNumbers]) -> None:
        """Add ``topics`` of a ``recording``."""
        self.recordings += 1
        self.duration_s += recording.span.duration_s
        for topic in topics:
            self._count(topic, None if topic.received is None else topic.received.size_bytes)
            if topic.received is not None:
                self.age_max_s = _larger(self.age_max_s, topic.received.age_max_s)
            if recording.position is not None and recording.position.topic == topic.topic:
                self.position_m = _larger(self.position_m, recording.position.received_m)

    def merge(self, other: Sums) -> None:
        """Add the sums of other recordings."""
        self.recordings += other.recordings
        self.duration_s += other.duration_s
        self.messages += other.messages
        self.size_bytes += other.size_bytes
        self.shared_messages += other.shared_messages
        self.received_bytes += other.received_bytes
        self.lost += other.lost
        self.age_max_s = _larger(self.age_max_s, other.age_max_s)
        self.position_m = _larger(self.position_m, other.position_m)


def of_recording(recording: RecordingNumbers) -> Sums:
    """The sums of one recording."""
    sums = Sums()
    sums.add(recording, recording.topics)
    return sums


@dataclass(slots=True, kw_only=True)
class RuleSums(Volume):
    """Numbers of a rule over recordings, as in ``RuleNumbers``."""

    decided_s: float = 0.0
    decisions: int = 0

    def add(self, rule: RuleNumbers) -> None:
        """Add the numbers of one recording."""
        self.recordings += 1
        self.decided_s += rule.decided_s
        self.decisions += rule.decisions
        self._count(rule, rule.received_bytes)


@dataclass(slots=True, kw_only=True)
class BoundSums:
    """Numbers of a bound over recordings, as in ``BoundNumbers``; the worst is the largest of all."""

    recordings: int = 0
    messages: int = 0
    broken: int = 0
    worst: float | None = None

    def add(self, bound: BoundNumbers) -> None:
        """Add the numbers of one recording."""
        self.recordings += 1
        self.messages += bound.messages
        self.broken += bound.broken
        self.worst = _larger(self.worst, bound.worst)


def _larger(one: float | None, other: float | None) -> float | None:
    known = [value for value in (one, other) if value is not None]
    return max(known, default=None)
