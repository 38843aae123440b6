# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The simulated warehouse as the report draws it."""

from __future__ import annotations

from smarttestudo.simulation import floor_plan
from smarttestudo.simulation.warehouse import warehouse
from smarttestudo.visualizer.floor import FloorPlan, Obstacle, ObstacleKind, Rectangle


def warehouse_floor() -> FloorPlan:
    """What stands in it; its zones are those of the rules."""
    return FloorPlan(
        obstacles=tuple(
            Obstacle(kind=ObstacleKind(obstacle.kind.value), footprint=_rectangle(obstacle.footprint))
            for obstacle in warehouse().obstacles
        )
    )


def _rectangle(rectangle: floor_plan.Rectangle) -> Rectangle:
    return Rectangle(
        min_x_m=rectangle.min_x_m,
        max_x_m=rectangle.max_x_m,
        min_y_m=rectangle.min_y_m,
        max_y_m=rectangle.max_y_m,
    )
