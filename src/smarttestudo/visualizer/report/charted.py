# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Which topics of a large recording have a chart."""

from __future__ import annotations

from smarttestudo.visualizer.report.run_report import RunReport, TopicSeries
from smarttestudo.visualizer.rule_timeline import by_topic

MAX_CHARTS = 24


def charted_series(report: RunReport) -> list[TopicSeries]:
    """At most ``MAX_CHARTS`` topics: those with decisions, then those that carry most."""
    decided = by_topic(report.decisions)

    def rank(series: TopicSeries) -> tuple[bool, float]:
        points = (*series.before.kb_per_s, *series.after.kb_per_s)
        return series.topic not in decided, -sum(point.mean for point in points)

    chosen = {series.topic for series in sorted(report.series, key=rank)[:MAX_CHARTS]}
    return [series for series in report.series if series.topic in chosen]
