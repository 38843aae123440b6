# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Summary of a recording: its topics with their numbers."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Annotated

from smarttestudo.bags.statistics import Latency, RecordingSpan, TopicStatistics
from smarttestudo.domain.infinite_values import infinite_entry
from smarttestudo.domain.record import JsonEntry, to_json
from smarttestudo.domain.recording import Storage
from smarttestudo.domain.units import utc_time

if TYPE_CHECKING:
    from smarttestudo.domain.incident import IncidentRecord


@dataclass(frozen=True, slots=True, kw_only=True)
class BagTopic:
    """One topic of a recording.

    ``qos`` is the offered quality of service in words, empty where the recording does not tell.
    ``longest_gap_s`` is the longest time between two messages, ``jitter_s`` the standard deviation of those
    times; ``None`` where there are too few messages. ``latency`` is ``None`` where nobody asked for it.
    """

    name: str
    type_name: str
    qos: str
    statistics: TopicStatistics
    longest_gap_s: float | None
    jitter_s: float | None
    latency: Latency | None = None

    def to_json(self) -> dict[str, object]:
        """The topic's entry in ``--json``."""
        return {
            "type": self.type_name,
            "qos": self.qos,
            **to_json(self.statistics),
            "kbit_per_s": self.statistics.kbit_per_s,
            "longest_gap_s": self.longest_gap_s,
            "jitter_s": self.jitter_s,
            **(to_json(self.latency) if self.latency else {}),
        }


@dataclass(frozen=True, slots=True, kw_only=True)
class BagTotal:
    """All topics of a recording together."""

    messages: int
    size_bytes: Annotated[int, JsonEntry(name="bytes")]
    kb_per_s: float | None
    kbit_per_s: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class BagSummary:
    """A recording that is called ``name``: its topics, and what was lost or odd, a line each.

    ``readable_share`` is how much of it can be read, 0 … 1, ``None`` where it is damaged and does not tell.
    ``incident`` is what rules recorded it for, if they did.
    """

    name: str
    storage: Storage
    span: RecordingSpan
    topics: tuple[BagTopic, ...]
    readable_share: float | None = 1.0
    notices: tuple[str, ...] = ()
    incident: IncidentRecord | None = None

    @property
    def total(self) -> BagTotal:
        """The sum over the topics."""
        each = [topic.statistics for topic in self.topics]
        rates = [one.kb_per_s for one in each if one.kb_per_s is not None]
        bit_rates = [one.kbit_per_s for one in each if one.kbit_per_s is not None]
        return BagTotal(
            messages=sum(one.messages for one in each),
            size_bytes=sum(one.size_bytes for one in each),
            kb_per_s=sum(rates) if rates else None,
            kbit_per_s=sum(bit_rates) if bit_rates else None,
        )

    @property
    def statistics(self) -> dict[str, TopicStatistics]:
        """The numbers of each topic by its name."""
        return {topic.name: topic.statistics for topic in self.topics}

    def over(self, duration_s: float) -> BagSummary:
        """The same with bandwidths over ``duration_s``."""
        topics = (replace(one, statistics=one.statistics.over(duration_s)) for one in self.topics)
        return replace(self, topics=tuple(topics))

    def only(self, names: Collection[str | None]) -> BagSummary:
        """The same with the topics in ``names``."""
        return replace(self, topics=tuple(topic for topic in self.topics if topic.name in names))

    def to_json(self) -> dict[str, object]:
        """The object that ``--json`` prints."""
        return {
            "bag": self.name,
            "storage": self.storage.value,
            "start": utc_time(self.span.start_ns),
            "end": utc_time(self.span.end_ns),
            "start_ns": self.span.start_ns,
            "end_ns": self.span.end_ns,
            "duration_s": self.span.duration_s,
            "readable_percent": None if self.readable_share is None else 100 * self.readable_share,
            "topics": {topic.name: topic.to_json() for topic in self.topics},
            "total": to_json(self.total),
            "notices": list(self.notices),
            **({} if self.incident is None else {"incident": _moment(self.incident)}),
        }

    def rows(self) -> Iterator[dict[str, object]]:
        """One row for each topic, for ``--csv``."""
        for topic in self.topics:
            yield {"bag": self.name, "topic": topic.name, **topic.to_json()}


def _moment(record: IncidentRecord) -> dict[str, object]:
    return {
        "name": record.name,
        "rule": record.rule,
        "time": utc_time(record.triggered_ns),
        "triggered_ns": record.triggered_ns,
        "values": dict(record.values),
        **infinite_entry(record.values),
    }
