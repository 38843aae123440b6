# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Following a route."""

from __future__ import annotations

import math

from smarttestudo.simulation.geometry import BodyVelocity, Point, Pose
from smarttestudo.simulation.robot import RobotModel
from smarttestudo.simulation.route import Route

_LOOKAHEAD_M = 0.4
_SEARCH_M = 0.5
_CRUISE_M_PER_S = 0.25
_SLOW_BELOW_RADIUS_M = 0.9
_SLOWEST_SHARE = 0.4


class PurePursuit:
    """Pure pursuit (Coulter 1992), slower in tight turns as Nav2's regulated one (Macenski et al. 2023)."""

    __slots__ = ("_model", "_route", "travelled_m")

    def __init__(self, route: Route, model: RobotModel) -> None:
        self._route = route
        self._model = model
        self.travelled_m = 0.0

    def command(self, pose: Pose) -> BodyVelocity:
        """The velocity that brings a robot at ``pose`` back to the route one lookahead further on."""
        here = Point(pose.x_m, pose.y_m)
        self.travelled_m = self._route.nearest_m(here, from_m=self.travelled_m, window_m=_SEARCH_M)
        goal = self._route.at(self.travelled_m + _LOOKAHEAD_M)
        bearing = math.atan2(goal.y_m - pose.y_m, goal.x_m - pose.x_m) - pose.yaw_rad
        curvature_per_m = 2 * math.sin(bearing) / here.distance_m(goal)
        share = min(1.0, max(_SLOWEST_SHARE, 1 / max(abs(curvature_per_m) * _SLOW_BELOW_RADIUS_M, 1e-9)))
        linear = min(_CRUISE_M_PER_S * share, self._model.max_linear_m_per_s)
        limit = self._model.max_angular_rad_per_s
        return BodyVelocity(linear, min(max(linear * curvature_per_m, -limit), limit))
