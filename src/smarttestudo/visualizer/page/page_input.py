# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Everything that the page of one run shows."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum

from smarttestudo.domain.decision import Decision
from smarttestudo.visualizer.comparison import Comparison
from smarttestudo.visualizer.comparison_tables import RunNames
from smarttestudo.visualizer.rate_series import RatePoint


@dataclass(frozen=True, slots=True, kw_only=True)
class Rectangle:
    """An upright rectangle of the floor, in metres."""

    min_x_m: float
    max_x_m: float
    min_y_m: float
    max_y_m: float


class ObstacleKind(Enum):
    """What stands on the floor."""

    WALL = "wall"
    RACK = "rack"
    UPRIGHT = "upright"


@dataclass(frozen=True, slots=True, kw_only=True)
class Obstacle:
    """Something that stands on the floor."""

    kind: ObstacleKind
    footprint: Rectangle


@dataclass(frozen=True, slots=True, kw_only=True)
class Zone:
    """A named part of the floor; one named as a rule is drawn in the rule's colour."""

    name: str
    area: Rectangle


@dataclass(frozen=True, slots=True, kw_only=True)
class FloorPlan:
    """The floor under the path."""

    obstacles: tuple[Obstacle, ...] = ()
    zones: tuple[Zone, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class PathPoint:
    """Where the robot was, ``t_s`` seconds after the run's start."""

    t_s: float
    x_m: float
    y_m: float


@dataclass(frozen=True, slots=True, kw_only=True)
class TopicSeries:
    """A topic's rate over time in both runs; empty where a run does not have it."""

    topic: str
    before: tuple[RatePoint, ...] = ()
    after: tuple[RatePoint, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleText:
    """A rule file as its author wrote it."""

    path: str
    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Fact:
    """One line about where the page comes from: a recording, a version, a seed."""

    label: str
    value: str


@dataclass(frozen=True, slots=True, kw_only=True)
class PageInput:
    """One run. Every text may come from a stranger; floor plan and path are optional.

    Times are in seconds since the run's start, those of ``decisions`` too.
    """

    title: str
    duration_s: float
    comparison: Comparison
    series: tuple[TopicSeries, ...]
    decisions: tuple[Decision, ...]
    names: RunNames = field(default_factory=RunNames)
    rules: tuple[RuleText, ...] = ()
    provenance: tuple[Fact, ...] = ()
    floor_plan: FloorPlan | None = None
    path: tuple[PathPoint, ...] = ()
