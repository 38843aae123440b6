# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The floor that a robot drives on, as data: for simulated sensors, for maps and for 3-D worlds alike."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum


@dataclass(frozen=True, slots=True)
class Point:
    """A place on the floor, in metres."""

    x_m: float
    y_m: float

    def distance_m(self, other: Point) -> float:
        return math.hypot(other.x_m - self.x_m, other.y_m - self.y_m)


@dataclass(frozen=True, slots=True, kw_only=True)
class Rectangle:
    """An upright rectangle of the floor, in metres; a side may be infinitely far."""

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
    """Kind of obstacle on the floor."""

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
class FloorZone:
    """A named part of the floor; one named as a rule is drawn in the rule's colour."""

    name: str
    area: Rectangle


@dataclass(frozen=True, slots=True, kw_only=True)
class OccupancyMap:
    """A map as robots drive by: a grid of cells, each free or occupied; unknown ones count as free.

    ``rows`` run from the lowest to the highest, ``True`` where a cell is occupied. The lower left corner of
    the first cell lies at (``origin_x_m``, ``origin_y_m``); the grid is turned about it by ``yaw_rad``.
    """

    rows: tuple[tuple[bool, ...], ...]
    cell_m: float
    origin_x_m: float
    origin_y_m: float
    yaw_rad: float = 0.0

    @property
    def width_m(self) -> float:
        return self.cell_m * max(map(len, self.rows), default=0)

    @property
    def height_m(self) -> float:
        return self.cell_m * len(self.rows)


@dataclass(frozen=True, slots=True, kw_only=True)
class FloorPlan:
    """One floor: what stands on it, its zones, and a map of it."""

    obstacles: tuple[Obstacle, ...] = ()
    zones: tuple[FloorZone, ...] = ()
    occupancy: OccupancyMap | None = None

    def clearance_m(self, point: Point) -> float:
        """From ``point`` to the nearest obstacle; 0 inside one, infinite where there is none."""
        return min((obstacle.footprint.distance_m(point) for obstacle in self.obstacles), default=math.inf)
