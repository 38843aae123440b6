# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A run as one HTML file that needs nothing else: no network, no script."""

from smarttestudo.visualizer.page.page import render_page
from smarttestudo.visualizer.page.page_input import (
    Fact,
    FloorPlan,
    Obstacle,
    ObstacleKind,
    PageInput,
    PathPoint,
    Rectangle,
    RuleText,
    TopicSeries,
    Zone,
)

__all__ = [
    "Fact",
    "FloorPlan",
    "Obstacle",
    "ObstacleKind",
    "PageInput",
    "PathPoint",
    "Rectangle",
    "RuleText",
    "TopicSeries",
    "Zone",
    "render_page",
]
