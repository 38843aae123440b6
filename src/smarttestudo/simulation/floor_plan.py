# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A building's floor as data, for the simulated LiDAR and camera, for maps and for 3-D worlds alike."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum

from smarttestudo.simulation.geometry import Point


@dataclass(frozen=True, slots=True, kw_only=True)
class Rectangle:
    """An upright rectangle of the floor, in metres."""

    min_x_m: float
    max_x_m: float
    min_y_m: float
    max_y_m: float

    @property
    def corners(self) -> tuple[Point, Point, Point, Point]:
        """The corners, anticlockwise from the least x and y."""
        return (
            Point(self.min_x_m, self.min_y_m),
            Point(self.max_x_m, self.min_y_m),
            Point(self.max_x_m, self.max_y_m),
            Point(self.min_x_m, self.max_y_m),
        )

    def contains(self, point: Point) -> bool:
        """Whether ``point`` lies inside; the border does not belong to the rectangle."""
        return self.min_x_m < point.x_m < self.max_x_m and self.min_y_m < point.y_m < self.max_y_m

    def distance_m(self, point: Point) -> float:
        """From ``point`` to the nearest place of the rectangle; 0 inside."""
        return math.hypot(
            max(self.min_x_m - point.x_m, 0.0, point.x_m - self.max_x_m),
            max(self.min_y_m - point.y_m, 0.0, point.y_m - self.max_y_m),
        )


class ObstacleKind(Enum):
    """What stands on the floor."""

    WALL = "wall"
    RACK = "rack"
    UPRIGHT = "upright"


@dataclass(frozen=True, slots=True, kw_only=True)
class Obstacle:
    """A box that the robot must not touch and that its sensors see."""

    kind: ObstacleKind
    footprint: Rectangle
    height_m: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Zone:
    """A security zone, named as the rule that belongs to it."""

    number: int
    name: str
    area: Rectangle


@dataclass(frozen=True, slots=True, kw_only=True)
class FloorPlan:
    """One floor: its inner bounds, what stands on it, and its zones.

    Whatever no zone covers is ``open_floor``, the number of the least guarded zone.
    """

    bounds: Rectangle
    obstacles: tuple[Obstacle, ...]
    zones: tuple[Zone, ...]
    open_floor: int = 1

    def zone_number(self, point: Point) -> int:
        """The number of the zone that ``point`` lies in."""
        return next((zone.number for zone in self.zones if zone.area.contains(point)), self.open_floor)

    def clearance_m(self, point: Point) -> float:
        """From ``point`` to the nearest obstacle; 0 inside one."""
        return min(obstacle.footprint.distance_m(point) for obstacle in self.obstacles)
