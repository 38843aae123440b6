# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Odometry that drifts, as real odometry does."""

from __future__ import annotations

import math

import numpy as np

from smarttestudo.simulation.geometry import BodyVelocity, Pose
from smarttestudo.simulation.robot import DriveModel

TICKS_PER_TURN = 4096
RADIUS_ERROR = 0.0004
SEPARATION_ERROR = 0.002
"""Standard deviations of what the robot believes of its wheels, as shares."""


class WheelOdometry:
    """Dead reckoning from the ticks of two encoders, by wheels that are not quite as they are believed to be.

    Slipping wheels turn without moving the robot, and this cannot see it.
    """

    def __init__(self, model: DriveModel, start: Pose, noise: np.random.Generator) -> None:
        left, right, separation = noise.standard_normal(3).tolist()
        self._left_m = model.wheel_radius_m * (1 + RADIUS_ERROR * left)
        self._right_m = model.wheel_radius_m * (1 + RADIUS_ERROR * right)
        self._separation_m = model.wheel_separation_m * (1 + SEPARATION_ERROR * separation)
        self._last: tuple[int, int] | None = None
        self.pose = start
        self.velocity = BodyVelocity(0.0, 0.0)

    def update(self, angles_rad: tuple[float, ...], dt_s: float) -> None:
        """Take the angles of the left and the right wheel, ``dt_s`` after the last ones."""
        left, right = (math.floor(angle / math.tau * TICKS_PER_TURN) for angle in angles_rad)
        before, self._last = self._last or (left, right), (left, right)
        rolled_left_m = (left - before[0]) / TICKS_PER_TURN * math.tau * self._left_m
        rolled_right_m = (right - before[1]) / TICKS_PER_TURN * math.tau * self._right_m
        forward_m = (rolled_left_m + rolled_right_m) / 2
        turn_rad = (rolled_right_m - rolled_left_m) / self._separation_m
        middle = Pose(self.pose.x_m, self.pose.y_m, self.pose.yaw_rad + turn_rad / 2).ahead(forward_m)
        self.pose = Pose(middle.x_m, middle.y_m, self.pose.yaw_rad + turn_rad)
        self.velocity = BodyVelocity(forward_m / dt_s, turn_rad / dt_s)


POSITION_WALK_M = 0.01
YAW_WALK_RAD = 0.002
"""How far visual odometry strays in the first second; after n seconds √n times as far."""


class DriftWalk:
    """How far visual odometry is off: a random walk of x, y, z and heading."""

    def __init__(self, noise: np.random.Generator) -> None:
        self._noise = noise
        self.offset = np.zeros(4)
        self._per_s = np.array((POSITION_WALK_M, POSITION_WALK_M, POSITION_WALK_M, YAW_WALK_RAD))

    def update(self, dt_s: float) -> None:
        """Stray for ``dt_s`` more."""
        self.offset += self._noise.standard_normal(4) * self._per_s * math.sqrt(dt_s)
