# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The numbers of one replay."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from statistics import fmean
from typing import Annotated, NamedTuple

from smarttestudo.domain.rate_meter import Flow
from smarttestudo.domain.record import JsonEntry, derived, to_json
from smarttestudo.domain.units import BYTES_PER_KB
from smarttestudo.loop.statistics import RelayStatistics, TargetRate
from smarttestudo.pacing.bound import BoundRecord


@dataclass(frozen=True, slots=True, kw_only=True)
class TopicOutcome:
    """Flow of one relayed topic in, and out on ``output_topic``.

    ``messages_out`` includes ``repeated``. ``source_hz`` and ``mean_hz`` are (n − 1) / (last − first) of what
    came in and went out. ``target_hz`` is weighted by time, with Full as the source's rate;
    ``error_percent`` is how far ``mean_hz`` lies above the lesser of target and ``source_hz``, likewise
    weighted, so it says little where the source's rate varies; it is ``None`` where bounds decide what
    passes. Where messages name streams, such as child frames, ``frames`` counts them, the target is that of
    each, and rates are means over them. ``bounds`` say how each bound of the receiver's picture was kept,
    ``unreadable`` how many messages of a topic with bounds lack a value of one. ``declared`` says that sizes
    are those that the bag declares. A number that the messages do not determine is ``None``.
    """

    output_topic: Annotated[str, JsonEntry(name="monitored_topic")]
    messages_in: Annotated[int, JsonEntry(name="in")]
    messages_out: Annotated[int, JsonEntry(name="out")]
    repeated: int
    source_hz: float | None
    target_hz: float | None
    mean_hz: float | None
    error_percent: float | None
    in_kb: float
    out_kb: float
    declared: bool = False
    frames: int | None = None
    bounds: Annotated[Mapping[str, tuple[BoundRecord, ...]], JsonEntry(omits_default=True)] = field(
        default_factory=dict
    )
    unreadable: Annotated[int, JsonEntry(is_absent=True)] = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class ReplayTotal:
    """All topics of a replay together."""

    messages_in: Annotated[int, JsonEntry(name="in")]
    messages_out: Annotated[int, JsonEntry(name="out")]
    in_kb: float
    out_kb: float


@dataclass(frozen=True, slots=True, kw_only=True)
class ReplayOutcome:
    """A replay's topics by source name, its number of decisions, and what was lost or odd, a line each.

    ``incidents`` are the names of the folders that were written.
    """

    topics: Mapping[str, TopicOutcome]
    decisions: int
    notices: tuple[str, ...]
    duration_s: float
    wall_seconds: float
    incidents: tuple[str, ...] = ()

    def rows(self) -> Iterator[dict[str, object]]:
        """One row for each topic."""
        for name, topic in self.topics.items():
            yield {"topic": name, **to_json(topic)}

    @property
    @derived()
    def total(self) -> ReplayTotal:
        """The sums over the topics."""
        topics = self.topics.values()
        return ReplayTotal(
            messages_in=sum(topic.messages_in for topic in topics),
            messages_out=sum(topic.messages_out for topic in topics),
            in_kb=sum(topic.in_kb for topic in topics),
            out_kb=sum(topic.out_kb for topic in topics),
        )


def topic_outcome(statistics: RelayStatistics, *, output_topic: str, declared: bool) -> TopicOutcome:
    """The numbers of a topic from what its relay counted."""
    arrived, relayed = statistics.arrived, statistics.relayed
    rates = _frame_rates(statistics) if statistics.frames else _rates(arrived, relayed, statistics.target)
    mean_hz, attainable_hz = rates.mean_hz, rates.attainable_hz
    return TopicOutcome(
        output_topic=output_topic,
        messages_in=arrived.messages,
        messages_out=relayed.messages,
        repeated=statistics.repeated,
        source_hz=rates.source_hz,
        target_hz=rates.target_hz,
        mean_hz=mean_hz,
        error_percent=None
        if statistics.bounds or not (mean_hz and attainable_hz)
        else 100 * (mean_hz / attainable_hz - 1),
        in_kb=arrived.size_bytes / BYTES_PER_KB,
        out_kb=relayed.size_bytes / BYTES_PER_KB,
        declared=declared,
        frames=len(statistics.frames) or None,
        bounds={name: tuple(by_bound.values()) for name, by_bound in statistics.bounds.items()},
        unreadable=statistics.unreadable,
    )


class _Rates(NamedTuple):
    source_hz: float | None
    target_hz: float | None
    attainable_hz: float | None
    mean_hz: float | None


def _rates(arrived: Flow, relayed: Flow, target: TargetRate) -> _Rates:
    source_hz = arrived.mean_hz
    if source_hz is None:
        return _Rates(None, None, None, relayed.mean_hz)
    return _Rates(source_hz, target.mean_hz(source_hz), target.attainable_hz(source_hz), relayed.mean_hz)


def _frame_rates(statistics: RelayStatistics) -> _Rates:
    """The means over the frames whose rates are known on both sides."""
    frames = statistics.frames
    rates = [
        _rates(arrived, frames.relayed.get(frame, Flow()), statistics.target)
        for frame, arrived in frames.arrived.items()
    ]
    known = [numbers for rate in rates if None not in (numbers := tuple(rate))]
    if not known:
        return rates[0] if len(rates) == 1 else _Rates(None, None, None, None)
    return _Rates(*(fmean(column) for column in zip(*known, strict=True)))
