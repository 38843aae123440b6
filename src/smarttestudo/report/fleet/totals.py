# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The numbers of many recordings added up, one recording after the other."""

from __future__ import annotations

import heapq
from collections import defaultdict
from dataclasses import dataclass, field

from smarttestudo.report.fleet.recording_numbers import RecordingNumbers
from smarttestudo.report.fleet.sums import BoundSums, RuleSums, Sums, Volume, of_recording
from smarttestudo.report.fleet.trend import Trend

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


class FleetTotals:
    """Adds up recordings, which are pairs where ``are_pairs``; memory does not grow with their number."""

    def __init__(self, *, are_pairs: bool) -> None:
        self.are_pairs = are_pairs
        self.all = Sums()
        self.topics: dict[str, Sums] = defaultdict(Sums)
        self.robots: dict[str, Sums] = defaultdict(Sums)
        self.rules: dict[str, RuleSums] = defaultdict(RuleSums)
        self.bounds: dict[tuple[str, float, str], BoundSums] = defaultdict(BoundSums)
        """By picture, bound and unit."""
        self.trend = Trend()
        self.unmatched: frozenset[str] = frozenset()
        self.failures = Lines()
        self.notices = Lines()
        self._worst: list[tuple[tuple[int, ...], int, RecordingNumbers]] = []

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
        if not recording.is_empty:
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
            for _, _, recording in sorted(self._worst, key=lambda one: (one[0], one[1]), reverse=True)
        ]
