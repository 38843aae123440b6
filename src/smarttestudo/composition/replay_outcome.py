# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The numbers of one replay."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from smarttestudo.domain.units import BYTES_PER_KB
from smarttestudo.runtime.execute.statistics import RelayStatistics


@dataclass(frozen=True, slots=True, kw_only=True)
class TopicOutcome:
    """What one relayed topic carried in, and out on ``monitored_topic``.

    ``messages_out`` includes ``repeated``. ``source_hz`` and ``mean_hz`` are (n − 1) / (last − first) of what
    came in and went out. ``target_hz`` is weighted by time, with Full as the source's rate; ``error_percent``
    is how far ``mean_hz`` lies above the lesser of target and source at each time, likewise weighted.
    ``declared`` says that sizes are those that the bag declares. A number that the messages do not determine
    is ``None``.
    """

    monitored_topic: str
    messages_in: int
    messages_out: int
    repeated: int
    source_hz: float | None
    target_hz: float | None
    mean_hz: float | None
    error_percent: float | None
    in_kb: float
    out_kb: float
    declared: bool = False

    def to_json(self) -> dict[str, object]:
        """The topic's entry in ``--json``."""
        return {
            "monitored_topic": self.monitored_topic,
            "in": self.messages_in,
            "out": self.messages_out,
            "repeated": self.repeated,
            "source_hz": self.source_hz,
            "target_hz": self.target_hz,
            "mean_hz": self.mean_hz,
            "error_percent": self.error_percent,
            "in_kb": self.in_kb,
            "out_kb": self.out_kb,
            "declared": self.declared,
        }


@dataclass(frozen=True, slots=True, kw_only=True)
class ReplayOutcome:
    """A replay's topics by source name, its number of decisions, and what was lost or odd, a line each."""

    topics: Mapping[str, TopicOutcome]
    decisions: int
    notices: tuple[str, ...]
    duration_s: float
    wall_seconds: float

    def to_json(self) -> dict[str, object]:
        """The object that ``testudo replay --json`` prints."""
        return {
            "topics": {name: topic.to_json() for name, topic in self.topics.items()},
            "total": {
                "in": sum(topic.messages_in for topic in self.topics.values()),
                "out": sum(topic.messages_out for topic in self.topics.values()),
                "in_kb": sum(topic.in_kb for topic in self.topics.values()),
                "out_kb": sum(topic.out_kb for topic in self.topics.values()),
            },
            "decisions": self.decisions,
            "notices": list(self.notices),
            "duration_s": self.duration_s,
            "wall_seconds": self.wall_seconds,
        }


def topic_outcome(statistics: RelayStatistics, *, monitored_topic: str, declared: bool) -> TopicOutcome:
    """The numbers of a topic from what its relay counted."""
    arrived, relayed = statistics.arrived, statistics.relayed
    source_hz, mean_hz = arrived.mean_hz, relayed.mean_hz
    target_hz = attainable_hz = None
    if source_hz is not None:
        target_hz = statistics.target.mean_hz(source_hz)
        attainable_hz = statistics.target.attainable_hz(source_hz)
    return TopicOutcome(
        monitored_topic=monitored_topic,
        messages_in=arrived.messages,
        messages_out=relayed.messages,
        repeated=statistics.repeated,
        source_hz=source_hz,
        target_hz=target_hz,
        mean_hz=mean_hz,
        error_percent=100 * (mean_hz / attainable_hz - 1) if mean_hz and attainable_hz else None,
        in_kb=arrived.size_bytes / BYTES_PER_KB,
        out_kb=relayed.size_bytes / BYTES_PER_KB,
        declared=declared,
    )
