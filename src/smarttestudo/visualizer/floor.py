# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The floor under a robot, and where it went."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


@dataclass(frozen=True, slots=True, kw_only=True)
class Rectangle:
    """An upright rectangle of the floor, in metres; a side may be infinitely far."""

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
        """Length of a row."""
        return self.cell_m * max(map(len, self.rows), default=0)

    @property
    def height_m(self) -> float:
        """Length of a column."""
        return self.cell_m * len(self.rows)


@dataclass(frozen=True, slots=True, kw_only=True)
class FloorPlan:
    """The floor under the path."""

    obstacles: tuple[Obstacle, ...] = ()
    zones: tuple[Zone, ...] = ()
    occupancy: OccupancyMap | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class PathPoint:
    """Where the robot was, ``t_s`` seconds after the run's start."""

    t_s: float
    x_m: float
    y_m: float
