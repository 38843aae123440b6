# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the demo's report shows."""

from __future__ import annotations

from collections.abc import Sequence

from smarttestudo.composition.demo_measure import MeasuredRun
from smarttestudo.domain.decision import Decision
from smarttestudo.simulation import floor_plan
from smarttestudo.visualizer.comparison import Comparison, compare
from smarttestudo.visualizer.page import (
    Fact,
    FloorPlan,
    Obstacle,
    ObstacleKind,
    PageInput,
    Rectangle,
    RuleText,
    TopicSeries,
    Zone,
)
from smarttestudo.visualizer.rate_series import rate_series
from smarttestudo.visualizer.rule_timeline import by_topic
from smarttestudo.visualizer.targets import mean_target, target_spans

_TITLE = "A TurtleBot3 patrols a warehouse"


def compare_runs(baseline: MeasuredRun, adaptive: MeasuredRun, decisions: Sequence[Decision]) -> Comparison:
    """What the robot published against what the operator received, with what was planned in between."""
    targets = {
        topic: mean_target(target_spans(own, baseline.span.duration_s), baseline.statistics[topic].mean_hz)
        for topic, own in by_topic(decisions).items()
    }
    return compare(baseline.statistics, adaptive.statistics, targets)


def demo_page(
    *,
    baseline: MeasuredRun,
    adaptive: MeasuredRun,
    comparison: Comparison,
    decisions: Sequence[Decision],
    rules: RuleText,
    plan: floor_plan.FloorPlan,
    provenance: Sequence[Fact],
) -> PageInput:
    """The page of a demo; times count from the start of the baseline."""
    series = tuple(
        TopicSeries(
            topic=topic,
            before=rate_series(trace, baseline.span),
            after=rate_series(adaptive.traces[topic], baseline.span),
        )
        for topic, trace in baseline.traces.items()
    )
    return PageInput(
        title=_TITLE,
        duration_s=baseline.span.duration_s,
        comparison=comparison,
        series=series,
        decisions=tuple(decisions),
        rules=(rules,),
        provenance=tuple(provenance),
        floor_plan=_page_plan(plan),
        path=baseline.path,
    )


def _page_plan(plan: floor_plan.FloorPlan) -> FloorPlan:
    return FloorPlan(
        obstacles=tuple(
            Obstacle(kind=ObstacleKind(obstacle.kind.value), footprint=_page_rectangle(obstacle.footprint))
            for obstacle in plan.obstacles
        ),
        zones=tuple(Zone(name=zone.name, area=_page_rectangle(zone.area)) for zone in plan.zones),
    )


def _page_rectangle(rectangle: floor_plan.Rectangle) -> Rectangle:
    return Rectangle(
        min_x_m=rectangle.min_x_m,
        max_x_m=rectangle.max_x_m,
        min_y_m=rectangle.min_y_m,
        max_y_m=rectangle.max_y_m,
    )
