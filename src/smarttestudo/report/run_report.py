# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The contents of a report: one run, or two beside each other."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from smarttestudo.accuracy.accuracy_curve import AccuracyCurve
from smarttestudo.accuracy.comparison import AccuracyComparison
from smarttestudo.accuracy.loss_report import LossReport
from smarttestudo.bags.comparison import Comparison
from smarttestudo.bags.floor import PathPoint
from smarttestudo.bags.incident_mark import IncidentMark
from smarttestudo.bags.statistics import IntervalBin
from smarttestudo.domain.decision import Decision
from smarttestudo.domain.floor_plan import FloorPlan
from smarttestudo.report.comparison_tables import RunNames, bandwidth_table, frequency_table
from smarttestudo.report.link_history import LinkHistory
from smarttestudo.report.rule_timeline import by_topic
from smarttestudo.report.series import Series
from smarttestudo.report.table import Table

MAX_CHARTS = 24


def charted_series(report: RunReport) -> list[TopicSeries]:
    """At most ``MAX_CHARTS`` topics: those with decisions, then those that carry most."""
    decided = by_topic(report.decisions)

    def rank(series: TopicSeries) -> tuple[bool, float]:
        points = (*series.before.kb_per_s, *series.after.kb_per_s)
        return series.topic not in decided, -sum(point.mean for point in points)

    chosen = {series.topic for series in sorted(report.series, key=rank)[:MAX_CHARTS]}
    return [series for series in report.series if series.topic in chosen]


@dataclass(frozen=True, slots=True, kw_only=True)
class TopicHistory:
    """A topic over time in one recording; empty where the recording does not have it."""

    rate_hz: Series = ()
    kb_per_s: Series = ()
    intervals: tuple[IntervalBin, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class TopicSeries:
    """A topic over time in both recordings."""

    topic: str
    before: TopicHistory = field(default_factory=TopicHistory)
    after: TopicHistory = field(default_factory=TopicHistory)


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleText:
    """A rule file as its author wrote it."""

    path: str
    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Fact:
    """One line about where the report comes from: a recording, a version, a seed."""

    label: str
    value: str


@dataclass(frozen=True, slots=True, kw_only=True)
class RunReport:
    """One recording, or two beside each other. Every text may come from a stranger.

    Times are in seconds since the first recording's start, those of ``decisions`` too. ``explanation`` says
    what is compared; ``total`` is the bandwidth of all topics together, ``accuracy_curve`` what
    bounds of the robot's position cost; ``incident`` is known where the first recording is one. Of a pair,
    ``tables`` may be left empty for the usual two.
    """

    title: str
    duration_s: float
    comparison: Comparison
    series: tuple[TopicSeries, ...]
    decisions: tuple[Decision, ...]
    explanation: str = ""
    total: TopicSeries = field(default_factory=lambda: TopicSeries(topic="All topics"))
    names: RunNames = field(default_factory=RunNames)
    tables: tuple[Table[Any], ...] = ()
    budget_kb_per_s: float | None = None
    loss: LossReport | None = None
    accuracy: AccuracyComparison | None = None
    accuracy_curve: AccuracyCurve | None = None
    link: LinkHistory | None = None
    rules: tuple[RuleText, ...] = ()
    provenance: tuple[Fact, ...] = ()
    notices: tuple[str, ...] = ()
    incident: IncidentMark | None = None
    floor_plan: FloorPlan | None = None
    path: tuple[PathPoint, ...] = ()

    @property
    def is_pair(self) -> bool:
        """Whether there is a second recording."""
        return any(pair.after is not None for pair in self.comparison.topics)

    @property
    def shown_tables(self) -> tuple[Table[Any], ...]:
        """``tables``, or those of the comparison."""
        usual = (frequency_table, bandwidth_table)
        return self.tables or tuple(table(self.comparison, self.names) for table in usual)
