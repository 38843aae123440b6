# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the demo's report shows."""

from __future__ import annotations

from collections.abc import Sequence

from smarttestudo.composition.demo_measure import MeasuredRun
from smarttestudo.domain.decision import Decision
from smarttestudo.simulation import floor_plan
from smarttestudo.visualizer.comparison import Comparison
from smarttestudo.visualizer.page import (
    Fact,
    FloorPlan,
    Obstacle,
    ObstacleKind,
    PageInput,
    Rectangle,
    RuleText,
    Zone,
)
from smarttestudo.visualizer.run_pair import paired_series

_TITLE = "A TurtleBot3 patrols a warehouse"


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
    return PageInput(
        title=_TITLE,
        duration_s=baseline.span.duration_s,
        comparison=comparison,
        series=paired_series(baseline.traces, adaptive.traces, baseline.span),
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
