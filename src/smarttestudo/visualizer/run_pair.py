# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a robot published beside what the operator received of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from smarttestudo.domain.decision import Decision
from smarttestudo.visualizer.comparison import Comparison, compare
from smarttestudo.visualizer.page import TopicSeries
from smarttestudo.visualizer.rate_series import rate_series
from smarttestudo.visualizer.rule_timeline import by_topic
from smarttestudo.visualizer.statistics import RecordingSpan, TopicStatistics
from smarttestudo.visualizer.targets import mean_target, target_spans
from smarttestudo.visualizer.trace import TraceAccumulator


def compare_runs(
    published: Mapping[str, TopicStatistics],
    received: Mapping[str, TopicStatistics],
    decisions: Sequence[Decision],
    *,
    end_s: float,
) -> Comparison:
    """Both runs by topic, against what was planned until ``end_s``, counted from the first one's start."""
    targets = {
        topic: mean_target(target_spans(own, end_s), published[topic].mean_hz)
        for topic, own in by_topic(decisions).items()
        if topic in published
    }
    return compare(published, received, targets)


def paired_series(
    before: Mapping[str, TraceAccumulator], after: Mapping[str, TraceAccumulator], span: RecordingSpan
) -> tuple[TopicSeries, ...]:
    """The rates over ``span`` of each topic before; empty after where the topic is missing there."""
    return tuple(
        TopicSeries(
            topic=topic,
            before=rate_series(trace, span),
            after=rate_series(after[topic], span) if topic in after else (),
        )
        for topic, trace in before.items()
    )
