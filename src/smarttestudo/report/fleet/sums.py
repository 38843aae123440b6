# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Numbers of topics and rules, added up over recordings."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from smarttestudo.report.fleet.recording_numbers import (
    BoundNumbers,
    RecordingNumbers,
    RuleNumbers,
    TopicNumbers,
)


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

    def _count(self, one: TopicNumbers | RuleNumbers, received_bytes: int | None) -> None:
        self.messages += one.messages
        self.size_bytes += one.size_bytes
        self.lost += one.lost
        if received_bytes is not None:
            self.shared_messages += one.messages
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
        self.duration_s += recording.duration_s
        for one in topics:
            self._count(one, None if one.received is None else one.received.size_bytes)
            if one.received is not None:
                self.age_max_s = _larger(self.age_max_s, one.received.age_max_s)
            if recording.position is not None and recording.position.topic == one.topic:
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
