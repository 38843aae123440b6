# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Summary of a recording: its topics with their numbers."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Annotated

from smarttestudo.bags.statistics import Latency, RecordingSpan, TopicStatistics
from smarttestudo.domain.incident import IncidentRecord
from smarttestudo.domain.record import JsonEntry, derived, to_columns
from smarttestudo.domain.recording import Storage
from smarttestudo.domain.signal import Value
from smarttestudo.domain.units import utc_time


@dataclass(frozen=True, slots=True, kw_only=True)
class BagTopic:
    """One topic of a recording.

    ``qos`` is the offered quality of service in words, empty where the recording does not tell.
    ``longest_gap_s`` is the longest time between two messages, ``jitter_s`` the standard deviation of those
    times; ``None`` where there are too few messages. ``latency`` is ``None`` where nobody asked for it.
    """

    name: Annotated[str, JsonEntry(is_absent=True)]
    type_name: Annotated[str, JsonEntry(name="type")]
    qos: str
    statistics: Annotated[TopicStatistics, JsonEntry(is_merged=True)]
    longest_gap_s: float | None
    jitter_s: float | None
    latency: Annotated[Latency | None, JsonEntry(is_merged=True)] = None


@dataclass(frozen=True, slots=True, kw_only=True)
class BagTotal:
    """All topics of a recording together."""

    messages: int
    size_bytes: Annotated[int, JsonEntry(name="bytes")]
    kb_per_s: float | None
    kbit_per_s: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordedMoment:
    """The moment for which rules recorded an incident, as its record says."""

    name: str
    rule: str
    time: str
    triggered_ns: int
    values: Annotated[Mapping[str, Value | None], JsonEntry(has_infinite=True)]


@dataclass(frozen=True, slots=True, kw_only=True)
class BagSummary:
    """A recording that is called ``name``: the robot's topics, and what was lost or odd, a line each.

    ``own_topics`` are those of what SmartTestudo said of itself, which no list and no sum holds.

    ``readable_share`` is how much of it can be read, 0 … 1, ``None`` where it is damaged and does not tell.
    ``incident`` is what rules recorded it for, if they did.
    """

    name: Annotated[str, JsonEntry(name="bag")]
    storage: Storage
    span: Annotated[RecordingSpan, JsonEntry(is_merged=True)]
    topics: Annotated[tuple[BagTopic, ...], JsonEntry(keyed_by="name")]
    readable_share: Annotated[float | None, JsonEntry(is_absent=True)] = 1.0
    notices: tuple[str, ...] = ()
    incident: Annotated[IncidentRecord | None, JsonEntry(is_absent=True)] = None
    own_topics: Annotated[
        tuple[BagTopic, ...], JsonEntry(name="testudo_topics", keyed_by="name", omits_default=True)
    ] = ()

    @property
    @derived()
    def readable_percent(self) -> float | None:
        """The readable share in percent."""
        return None if self.readable_share is None else 100 * self.readable_share

    @property
    @derived("incident", omits_default=True)
    def moment(self) -> RecordedMoment | None:
        """The moment of the incident, if it is one."""
        found = self.incident
        if found is None:
            return None
        return RecordedMoment(
            name=found.name,
            rule=found.rule,
            time=utc_time(found.triggered_ns),
            triggered_ns=found.triggered_ns,
            values=found.values,
        )

    @property
    @derived()
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

    def naming(self, names: Collection[str]) -> BagSummary:
        """The same with those of ``own_topics`` that ``names`` has among the others; patterns name none."""
        asked = tuple(topic for topic in self.own_topics if topic.name in names)
        if not asked:
            return self
        own = tuple(topic for topic in self.own_topics if topic not in asked)
        topics = sorted((*self.topics, *asked), key=lambda topic: topic.name)
        return replace(self, topics=tuple(topics), own_topics=own)

    def over(self, duration_s: float) -> BagSummary:
        """The same with bandwidths over ``duration_s``."""
        topics = (replace(topic, statistics=topic.statistics.over(duration_s)) for topic in self.topics)
        return replace(self, topics=tuple(topics))

    def only(self, names: Collection[str | None]) -> BagSummary:
        """The same with the topics in ``names``."""
        return replace(self, topics=tuple(topic for topic in self.topics if topic.name in names))

    def rows(self) -> Iterator[dict[str, object]]:
        """One row for each topic, for ``--csv``."""
        for topic in self.topics:
            row = RecordedTopicRow(
                bag=self.name,
                topic=topic.name,
                type_name=topic.type_name,
                qos=topic.qos,
                statistics=topic.statistics,
                kbit_per_s=topic.statistics.kbit_per_s,
                longest_gap_s=topic.longest_gap_s,
                jitter_s=topic.jitter_s,
                latency=topic.latency,
            )
            yield to_columns(row)


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordedTopicRow:
    """A topic of a recording as a row; without ``latency`` where nobody asked for it."""

    bag: str
    topic: str
    type_name: Annotated[str, JsonEntry(name="type")]
    qos: str
    statistics: Annotated[TopicStatistics, JsonEntry(is_merged=True)]
    kbit_per_s: float | None
    longest_gap_s: float | None
    jitter_s: float | None
    latency: Annotated[Latency | None, JsonEntry(is_merged=True)]
