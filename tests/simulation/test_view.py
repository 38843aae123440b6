# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import numpy as np
import pytest

from smarttestudo.domain.floor_plan import FloorPlan, Obstacle, ObstacleKind, Rectangle
from smarttestudo.simulation.camera import FrameSize, raspberry_pi_lens, render
from smarttestudo.simulation.geometry import Pose
from smarttestudo.simulation.sensors import RayCaster


def _view(distance_m: float) -> np.ndarray:
    rack = Rectangle(min_x_m=distance_m, max_x_m=distance_m + 1, min_y_m=-9, max_y_m=0.0)
    plan = FloorPlan(
        obstacles=(Obstacle(kind=ObstacleKind.RACK, footprint=rack, height_m=0.5),),
    )
    lens = raspberry_pi_lens(FrameSize.FULL)
    return render(RayCaster(plan), Pose(0.0, 0.0, 0.0), 0.1, lens, np.random.default_rng(0))


def _is_blue(pixels: np.ndarray) -> np.ndarray:
    blue: np.ndarray = pixels[..., 2].astype(int) - pixels[..., 0] > 40
    return blue


def test_what_stands_to_the_right_is_on_the_right_of_the_image() -> None:
    blue = _is_blue(_view(2.0))

    assert not blue[:, :950].any()
    assert blue[:, 970:].any(axis=0).all()


@pytest.mark.parametrize("distance_m", [1.0, 2.0, 4.0])
def test_an_obstacle_covers_focal_length_times_height_over_distance(distance_m: float) -> None:
    focal_px = raspberry_pi_lens(FrameSize.FULL).focal_px

    rows = np.flatnonzero(_is_blue(_view(distance_m))[:, 965])

    assert rows.min() == pytest.approx(max(0, 540 - focal_px * 0.4 / distance_m), abs=0.5)
    assert rows.max() + 1 == pytest.approx(540 + focal_px * 0.1 / distance_m, abs=0.5)
