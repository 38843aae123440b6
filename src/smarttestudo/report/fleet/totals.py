# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The numbers of many recordings added up: over all, and over days, hours or recordings."""

from __future__ import annotations

import heapq
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, field
from datetime import datetime, timedelta, timezone
from enum import Enum

from smarttestudo.domain.units import NS_PER_S, S_PER_HOUR
from smarttestudo.report.fleet.numbers import (
    BoundSums,
    RecordingNumbers,
    RuleSums,
    Sums,
    Volume,
    of_recording,
)

MOST_COLUMNS = 60
_MOST_DAYS = 1000
_HOUR_NS = S_PER_HOUR * NS_PER_S
_DAY_NS = 24 * _HOUR_NS
_EPOCH = datetime(1970, 1, 1, tzinfo=timezone.utc)


class Step(Enum):
    """The recordings that a column stands for."""

    RECORDING = "recording"
    HOUR = "hour"
    DAY = "day"


@dataclass(slots=True, kw_only=True)
class TrendColumn:
    """The sums of recordings of one time, from ``first`` to ``last``, over all and by topic and robot.

    ``steps`` are the days on which there are some, by number; of a recording or an hour there is one.
    """

    first: str
    last: str
    steps: set[int] = field(default_factory=set)
    total: Sums = field(default_factory=Sums)
    topics: dict[str, Sums] = field(default_factory=lambda: defaultdict(Sums))
    robots: dict[str, Sums] = field(default_factory=lambda: defaultdict(Sums))

    def add(self, recording: RecordingNumbers) -> None:
        """Add a recording."""
        self.steps.add(recording.span.start_ns // _DAY_NS)
        self.total.add(recording, recording.topics)
        self.robots[recording.robot].add(recording, recording.topics)
        for topic in recording.topics:
            self.topics[topic.topic].add(recording, [topic])

    def merge(self, later: TrendColumn) -> None:
        """Add a column of a later time."""
        self.last = later.last
        self.steps |= later.steps
        self.total.merge(later.total)
        for own, others in ((self.topics, later.topics), (self.robots, later.robots)):
            for name, sums in others.items():
                own[name].merge(sums)


@dataclass(slots=True)
class Trend:
    """Columns of recordings; memory is bounded by days, hours and topics, whatever number of recordings."""

    _day: int | None = None
    _days: dict[int, TrendColumn] = field(default_factory=dict)
    _days_each: int = 1
    _hours: dict[int, TrendColumn] | None = field(default_factory=dict)
    _recordings: list[tuple[int, TrendColumn]] | None = field(default_factory=list)

    def add(self, recording: RecordingNumbers) -> None:
        """Add a recording."""
        day = recording.span.start_ns // _DAY_NS
        if self._day is None:
            self._day = day
        if day != self._day:
            self._hours = self._recordings = None
        self._add_day(day, recording)
        if self._hours is not None:
            hour = recording.span.start_ns // _HOUR_NS
            text = _time(recording.span.start_ns // _HOUR_NS * _HOUR_NS, "%H:%M")
            self._hours.setdefault(hour, TrendColumn(first=text, last=text)).add(recording)
        if self._recordings is not None:
            column = TrendColumn(first=_time(recording.span.start_ns, "%H:%M"), last=recording.a)
            column.add(recording)
            self._recordings.append((recording.span.start_ns, column))
            if len(self._recordings) > MOST_COLUMNS:
                self._recordings = None

    @property
    def day(self) -> str:
        """The day of the first recording."""
        return "" if self._day is None else _date(self._day)

    @property
    def step(self) -> Step:
        """The meaning of a column that is not joined from several."""
        if self._recordings is not None:
            return Step.RECORDING
        return Step.DAY if self._hours is None else Step.HOUR

    def columns(self) -> Sequence[TrendColumn]:
        """The columns in the order of time, at most ``MOST_COLUMNS``."""
        if self._recordings is not None:
            in_order = sorted(self._recordings, key=lambda recording: recording[0])
            return [column for _, column in in_order]
        found = self._days if self._hours is None else self._hours
        columns = [found[key] for key in sorted(found)]
        each = -(-len(columns) // MOST_COLUMNS) or 1
        return [_joined(columns[start : start + each]) for start in range(0, len(columns), each)]

    def _add_day(self, day: int, recording: RecordingNumbers) -> None:
        key = day // self._days_each
        text = _date(day)
        column = self._days.setdefault(key, TrendColumn(first=text, last=text))
        column.first, column.last = min(column.first, text), max(column.last, text)
        column.add(recording)
        if len(self._days) > _MOST_DAYS:
            self._halve()

    def _halve(self) -> None:
        self._days_each *= 2
        days, self._days = self._days, {}
        for key in sorted(days):
            if key // 2 in self._days:
                self._days[key // 2].merge(days[key])
            else:
                self._days[key // 2] = days[key]


def _joined(columns: Sequence[TrendColumn]) -> TrendColumn:
    if len(columns) == 1:
        return columns[0]
    joined = TrendColumn(first=columns[0].first, last=columns[0].last)
    for column in columns:
        joined.merge(column)
    return joined


def _date(day: int) -> str:
    return _time(day * _DAY_NS, "%Y-%m-%d")


def _time(stamp_ns: int, form: str) -> str:
    return f"{_EPOCH + timedelta(microseconds=stamp_ns // 1000):{form}}"


MOST_ROWS = 100
"""Recordings, failures and notices that are kept; the others are counted."""


@dataclass(slots=True, kw_only=True)
class Lines:
    """The first lines of many, and how many there are."""

    first: list[str] = field(default_factory=list)
    count: int = 0

    def add(self, line: str) -> None:
        """Take one more."""
        self.count += 1
        if len(self.first) < MOST_ROWS:
            self.first.append(line)


@dataclass(slots=True, kw_only=True)
class FleetTotals:
    """Adds up recordings, which are pairs where ``are_pairs``; memory does not grow with their number.

    ``bounds`` are by picture, bound and unit.
    """

    are_pairs: bool
    all: Sums = field(default_factory=Sums)
    topics: dict[str, Sums] = field(default_factory=lambda: defaultdict(Sums))
    robots: dict[str, Sums] = field(default_factory=lambda: defaultdict(Sums))
    rules: dict[str, RuleSums] = field(default_factory=lambda: defaultdict(RuleSums))
    bounds: dict[tuple[str, float, str], BoundSums] = field(default_factory=lambda: defaultdict(BoundSums))
    trend: Trend = field(default_factory=Trend)
    unmatched: frozenset[str] = frozenset()
    failures: Lines = field(default_factory=Lines)
    notices: Lines = field(default_factory=Lines)
    _worst: list[tuple[tuple[int, ...], int, RecordingNumbers]] = field(default_factory=list)

    def add(self, recording: RecordingNumbers) -> None:
        """Add the numbers of a recording."""
        is_first = not self.all.recordings
        self.unmatched = recording.unmatched if is_first else self.unmatched & recording.unmatched
        for notice in recording.notices:
            self.notices.add(notice if notice.startswith(recording.a) else f"{recording.a}: {notice}")
        self.all.add(recording, recording.topics)
        if recording.robot:
            self.robots[recording.robot].add(recording, recording.topics)
        for topic in recording.topics:
            self.topics[topic.topic].add(recording, [topic])
        for rule in recording.rules:
            self.rules[rule.rule].add(rule)
        for bound in recording.bounds:
            self.bounds[bound.picture, bound.bound, bound.unit].add(bound)
        if not recording.span.is_empty:
            self.trend.add(recording)
        keep = heapq.heappush if len(self._worst) < MOST_ROWS else heapq.heappushpop
        keep(self._worst, (self.rank(of_recording(recording)), -self.all.recordings, recording))

    def rank(self, sums: Volume) -> tuple[int, ...]:
        """How bad it is: first by what was lost, where that is known, then by what it cost."""
        return (sums.lost, sums.received_bytes) if self.are_pairs else (sums.size_bytes,)

    @property
    def worst(self) -> list[RecordingNumbers]:
        """At most ``MOST_ROWS`` recordings, the worst first."""
        return [
            recording
            for _, _, recording in sorted(
                self._worst, key=lambda ranked: (ranked[0], ranked[1]), reverse=True
            )
        ]
