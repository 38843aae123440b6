# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The robot's LiDAR."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from smarttestudo.simulation.drive import DifferentialDrive
from smarttestudo.simulation.ray_casting import RayCaster
from smarttestudo.simulation.readings import Reading, Scan, Topic

_RAYS = 360


class Lidar:
    """The LDS-01: 360 rays, 0.12 to 3.5 m, five turns a second.

    A turn is a snapshot, as in Gazebo. Out of range reads as REP 117 has it: infinite beyond, minus
    infinite below. The noise is that of ``turtlebot3_gazebo``.
    """

    rate_hz = 5.0
    range_min_m = 0.12
    range_max_m = 3.5
    noise_m = 0.01

    def __init__(self, caster: RayCaster, noise: np.random.Generator) -> None:
        self._caster = caster
        self._noise = noise
        self._bearings_rad = np.linspace(0.0, 2 * np.pi, _RAYS, endpoint=False)

    def sample(self, drive: DifferentialDrive) -> Sequence[tuple[Topic, Reading]]:
        """One turn from where the robot is now."""
        origin = drive.pose.ahead(drive.model.scan_x_m)
        # Noise may bring a hit just beyond the range back into it.
        reach_m = self.range_max_m + 4 * self.noise_m
        hits = self._caster.cast(origin, self._bearings_rad + drive.pose.yaw_rad, range_m=reach_m)
        ranges_m = hits.distances_m + self._noise.normal(0.0, self.noise_m, _RAYS)
        ranges_m[ranges_m > self.range_max_m] = np.inf
        ranges_m[ranges_m < self.range_min_m] = -np.inf
        reading = Scan(
            stamp_ns=drive.now_ns,
            ranges_m=ranges_m.astype(np.float32),
            range_min_m=self.range_min_m,
            range_max_m=self.range_max_m,
            turn_s=1 / self.rate_hz,
        )
        return [(Topic.SCAN, reading)]
