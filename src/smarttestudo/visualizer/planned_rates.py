# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What was received beside what was planned."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from smarttestudo.domain.decision import Decision
from smarttestudo.visualizer.comparison import Comparison, TopicComparison
from smarttestudo.visualizer.rule_timeline import by_topic
from smarttestudo.visualizer.targets import mean_target, target_spans


def with_targets(comparison: Comparison, decisions: Sequence[Decision], *, end_s: float) -> Comparison:
    """``comparison`` with what ``decisions`` planned for its topics until ``end_s``, by the first's names."""
    planned = by_topic(decisions)

    def targeted(pair: TopicComparison) -> TopicComparison:
        own = planned.get(pair.topic)
        if own is None or pair.before is None:
            return pair
        return replace(pair, target=mean_target(target_spans(own, end_s), pair.before.mean_hz))

    return Comparison(topics=tuple(map(targeted, comparison.topics)))
