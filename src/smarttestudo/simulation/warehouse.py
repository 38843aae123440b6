# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The warehouse: three security zones, and a patrol through all of them.

The two zone rectangles are those of the evaluation rules in ``warehouse.adirf``. South and east lies the
open hall with its racks, in the middle the corridor, north the area where scaffolding stands.
"""

from __future__ import annotations

from smarttestudo.domain.floor_plan import FloorPlan, FloorZone, Obstacle, ObstacleKind, Point, Rectangle
from smarttestudo.simulation.route import Route

_WALL_HEIGHT_M = 4.0
_RACK_HEIGHT_M = 2.5
_SCAFFOLD_HEIGHT_M = 3.0
_UPRIGHT_M = 0.1
_BAY_LENGTH_M = 2.0
_BAY_DEPTH_M = 1.0

_WALLS_M = (
    (-13.2, 14.2, -8.2, -8.0),
    (-13.2, 14.2, 25.5, 25.7),
    (-13.2, -13.0, -8.2, 25.7),
    (14.0, 14.2, -8.2, 25.7),
    (-13.0, -8.0, 0.8, 1.0),
    (-6.8, 6.0, 0.8, 1.0),
    (-13.0, -5.8, 5.6, 5.8),
    (-4.2, 6.0, 5.6, 5.8),
)
_RACKS_M = (
    (-11.0, -5.6, -6.5, -5.4),
    (-11.0, -5.6, -3.2, -2.1),
    (-3.5, 1.9, -6.5, -5.4),
    (-3.5, 1.9, -3.2, -2.1),
    (8.5, 9.6, -2.0, 2.1),
    (8.5, 9.6, 3.9, 7.6),
    (12.8, 13.9, -3.0, 2.4),
    (12.8, 13.9, 4.0, 9.4),
    (12.8, 13.9, 12.0, 17.4),
    (8.5, 9.6, 12.0, 20.0),
)
_SCAFFOLDS_M = (
    (-3.2, 8.5),
    (0.3, 10.5),
    (4.2, 9.3),
    (0.3, 7.2),
    (-6.9, 9.0),
    (-10.0, 8.5),
    (-3.2, 12.7),
    (0.3, 13.2),
    (3.4, 13.2),
    (-9.0, 14.0),
    (-6.0, 18.5),
    (0.0, 17.5),
    (2.5, 21.0),
)
_PATROL_M = (
    (10.8, 8.8),
    (10.8, 3.0),
    (-5.0, 3.0),
    (-5.0, 11.0),
    (-1.5, 11.0),
    (-1.5, 8.8),
    (2.0, 8.8),
    (2.0, 11.5),
    (4.8, 11.5),
    (7.2, 8.8),
)
_CORNER_RADIUS_M = 0.8


def warehouse() -> FloorPlan:
    """The floor plan of the demo's warehouse."""
    return FloorPlan(
        obstacles=(
            *(
                Obstacle(kind=ObstacleKind.WALL, footprint=_rectangle(*s), height_m=_WALL_HEIGHT_M)
                for s in _WALLS_M
            ),
            *(
                Obstacle(kind=ObstacleKind.RACK, footprint=_rectangle(*s), height_m=_RACK_HEIGHT_M)
                for s in _RACKS_M
            ),
            *(upright for x_m, y_m in _SCAFFOLDS_M for upright in _scaffold(x_m, y_m)),
        ),
        zones=(
            FloorZone(name="Warehouse Corridor", area=_rectangle(-13.0, 6.0, 1.0, 5.4)),
            FloorZone(name="Scaffolding", area=_rectangle(-13.0, 6.0, 6.0, 25.5)),
        ),
    )


def warehouse_bounds() -> Rectangle:
    """The floor between the outer walls."""
    return _rectangle(-13.0, 14.0, -8.0, 25.5)


def patrol() -> Route:
    """The robot's round: hall, corridor, scaffolding, and back through the hall."""
    return Route.through([Point(x_m, y_m) for x_m, y_m in _PATROL_M], corner_radius_m=_CORNER_RADIUS_M)


def _rectangle(min_x_m: float, max_x_m: float, min_y_m: float, max_y_m: float) -> Rectangle:
    return Rectangle(min_x_m=min_x_m, max_x_m=max_x_m, min_y_m=min_y_m, max_y_m=max_y_m)


def _scaffold(x_m: float, y_m: float) -> list[Obstacle]:
    """The four uprights of one bay around its middle."""
    half_m = _UPRIGHT_M / 2
    centres = [
        (x_m + side * _BAY_LENGTH_M / 2, y_m + end * _BAY_DEPTH_M / 2) for side in (-1, 1) for end in (-1, 1)
    ]
    return [
        Obstacle(
            kind=ObstacleKind.UPRIGHT,
            footprint=_rectangle(cx_m - half_m, cx_m + half_m, cy_m - half_m, cy_m + half_m),
            height_m=_SCAFFOLD_HEIGHT_M,
        )
        for cx_m, cy_m in centres
    ]
