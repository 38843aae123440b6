# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Drawing what a camera sees of a floor plan, column by column."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from smarttestudo.simulation.floor_plan import FloorPlan, ObstacleKind
from smarttestudo.simulation.geometry import Point
from smarttestudo.simulation.ray_casting import Floats, RayCaster
from smarttestudo.simulation.readings import Lens, Pixels

_SIGHT_M = 60.0
_FADING_M = 15.0
_CEILING = (70.0, 74.0, 82.0)
_FLOOR = (150.0, 148.0, 142.0)
_GRAIN = 6


@dataclass(frozen=True, slots=True, kw_only=True)
class Viewpoint:
    """Where a level camera stands and looks."""

    place: Point
    yaw_rad: float
    height_m: float


def render(
    plan: FloorPlan, caster: RayCaster, viewpoint: Viewpoint, lens: Lens, noise: np.random.Generator
) -> Pixels:
    """The image that ``lens`` gives of ``plan``, height × width × RGB, with the grain of a sensor.

    One ray a column finds the obstacle; its height over its distance gives the rows that it covers.
    """
    width, height = lens.image_size
    focal_px = lens.focal_px / lens.binning
    slopes = (width / 2 - 0.5 - np.arange(width)) / focal_px
    angles = np.arctan(slopes)
    hits = caster.cast(viewpoint.place, viewpoint.yaw_rad + angles, range_m=_SIGHT_M)
    depths_m = hits.distances_m * np.cos(angles)
    heights_m = np.array([obstacle.height_m for obstacle in plan.obstacles])[hits.obstacles]
    colours = np.array([_colour(obstacle.kind) for obstacle in plan.obstacles])[hits.obstacles]

    below_horizon_px = np.arange(height) + 0.5 - height / 2
    top_px = -focal_px * (heights_m - viewpoint.height_m) / depths_m
    foot_px = focal_px * viewpoint.height_m / depths_m
    with np.errstate(divide="ignore"):
        floor_m = np.abs(focal_px * viewpoint.height_m / below_horizon_px)
    background = np.where((below_horizon_px < 0)[:, None], _CEILING, _faded(np.array(_FLOOR), floor_m))
    covered = (below_horizon_px[:, None] >= top_px) & (below_horizon_px[:, None] < foot_px)
    scene = np.where(covered[..., None], _faded(colours, depths_m), background[:, None, :])
    grain = noise.integers(-_GRAIN, _GRAIN, scene.shape, endpoint=True, dtype=np.int8)
    return np.clip(scene + grain, 0, 255).astype(np.uint8)


def _faded(colours: Floats, distances_m: Floats) -> Floats:
    """Colours, darker with distance."""
    return colours * (1 / (1 + distances_m / _FADING_M))[:, None]


def _colour(kind: ObstacleKind) -> tuple[float, float, float]:
    match kind:
        case ObstacleKind.WALL:
            return (214.0, 208.0, 196.0)
        case ObstacleKind.RACK:
            return (38.0, 96.0, 170.0)
        case ObstacleKind.UPRIGHT:
            return (236.0, 176.0, 32.0)
