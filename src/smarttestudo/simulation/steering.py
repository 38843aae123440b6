# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Steering along a way.

Numbers are those that Nav2's ``nav2_params.yaml`` gives a TurtleBot3's regulated pure pursuit and velocity
smoother, except for a smaller tolerance of the goal.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Generic

from smarttestudo.domain.floor_plan import Point
from smarttestudo.domain.units import NS_PER_S, ns_from_s
from smarttestudo.simulation.geometry import BodyVelocity, Pose, bearing_rad, clamped
from smarttestudo.simulation.messages import Published, RobotTopic, command
from smarttestudo.simulation.robot import Body, BodyT, DriveModel
from smarttestudo.simulation.route import CRUISE_M_PER_S, SPACING_M, Goal, Route, Tour

LOOKAHEAD_M = 0.4
SEARCH_M = 0.5
_SLOW_BELOW_RADIUS_M = 0.9
_SLOWEST_SHARE = 0.4


class PurePursuit:
    """Pure pursuit (Coulter 1992), slower in tight turns as Nav2's regulated one (Macenski et al. 2023)."""

    __slots__ = ("_model", "_route", "travelled_m")

    def __init__(self, route: Route, model: DriveModel) -> None:
        self._route = route
        self._model = model
        self.travelled_m = 0.0

    def command(self, body: Body) -> BodyVelocity:
        """The velocity that brings the robot back to the route one lookahead further on."""
        place = body.pose.place
        self.travelled_m = self._route.nearest_m(place, from_m=self.travelled_m, window_m=SEARCH_M)
        goal = self._route.at(self.travelled_m + LOOKAHEAD_M)
        return towards(goal, body.pose, self._model, cruise_m_per_s=CRUISE_M_PER_S)


def towards(goal: Point, pose: Pose, model: DriveModel, *, cruise_m_per_s: float) -> BodyVelocity:
    """The arc from ``pose`` to ``goal``, at ``cruise_m_per_s`` where it is not tight."""
    bearing = bearing_rad(pose.place, goal) - pose.yaw_rad
    curvature_per_m = 2 * math.sin(bearing) / pose.place.distance_m(goal)
    share = min(1.0, max(_SLOWEST_SHARE, 1 / max(abs(curvature_per_m) * _SLOW_BELOW_RADIUS_M, 1e-9)))
    linear = min(cruise_m_per_s * share, model.max_linear_m_per_s)
    return BodyVelocity(linear, clamped(linear * curvature_per_m, model.max_angular_rad_per_s))


Steer = Callable[[BodyT], BodyVelocity]
OTHERS_NS = 2 * NS_PER_S
"""How long after a command of another publisher the robot's own navigator goes on."""


class Navigator(Generic[BodyT]):
    """Steers the robot and publishes what it asks of the wheels, but for two seconds after others did so."""

    rate_hz = 10.0

    def __init__(self, steer: Steer[BodyT]) -> None:
        self._steer = steer
        self._others_until_ns = 0

    def obey(self, velocity: BodyVelocity, body: BodyT) -> None:
        """Have the robot follow the command of another publisher for now."""
        self._others_until_ns = body.now_ns + OTHERS_NS
        body.command(velocity)

    def sample(self, body: BodyT) -> Published:
        if body.now_ns < self._others_until_ns:
            return []
        velocity = self._steer(body)
        body.command(velocity)
        return [(RobotTopic.CMD_VEL, command(velocity))]


_GOAL_TOLERANCE_M = 0.05
_APPROACH_M = 0.6
_LEAST_APPROACH_M_PER_S = 0.05
_TURN_FROM_RAD = 0.785
_TURNED_RAD = 0.05
_TURN_RAD_PER_S = 1.8
_LINEAR_M_PER_S2 = 2.5
_ANGULAR_RAD_PER_S2 = 3.2
_PERIOD_S = 1 / Navigator.rate_hz


class WaypointFollower:
    """Drives a tour: pure pursuit on the legs, slower towards a stop, turning on the spot after it."""

    __slots__ = ("_is_turning", "_last", "_model", "_paused_until_ns", "_tour", "travelled_m")

    def __init__(self, tour: Tour, model: DriveModel) -> None:
        self._tour = tour
        self._model = model
        self._last = BodyVelocity(0.0, 0.0)
        self._is_turning = False
        self._paused_until_ns: int | None = None
        self.travelled_m = 0.0

    def command(self, drive: Body) -> BodyVelocity:
        """The velocity to make for now; called ten times a second."""
        wanted = self._wanted(drive.pose, drive.now_ns)
        last, linear, angular = self._last, _LINEAR_M_PER_S2 * _PERIOD_S, _ANGULAR_RAD_PER_S2 * _PERIOD_S
        self._last = BodyVelocity(
            _within(wanted.linear_m_per_s, last.linear_m_per_s, linear),
            _within(wanted.angular_rad_per_s, last.angular_rad_per_s, angular),
        )
        return self._last

    def _wanted(self, pose: Pose, now_ns: int) -> BodyVelocity:
        if self._paused_until_ns is None:
            self._paused_until_ns = now_ns + ns_from_s(self._tour.first_pause_s)
        if now_ns < self._paused_until_ns:
            return BodyVelocity(0.0, 0.0)
        stop = self._tour.stop_after(self.travelled_m)
        left_m = self._advance(pose, stop)
        if stop is not None and left_m <= _GOAL_TOLERANCE_M:
            self.travelled_m = stop.at_m
            self._paused_until_ns = now_ns + ns_from_s(stop.pause_s)
            self._is_turning = True
            return BodyVelocity(0.0, 0.0)
        carrot = self._carrot(left_m)
        turn = self._turn(carrot, pose)
        if turn is not None:
            return turn
        speed_m_per_s = self._tour.goal_after(self.travelled_m).speed_m_per_s
        approach_m_per_s = max(_LEAST_APPROACH_M_PER_S, speed_m_per_s * min(1.0, left_m / _APPROACH_M))
        return towards(carrot, pose, self._model, cruise_m_per_s=min(speed_m_per_s, approach_m_per_s))

    def _advance(self, pose: Pose, stop: Goal | None) -> float:
        """Find the robot on the route; how many metres are left to the stop."""
        left_m = math.inf if stop is None else stop.at_m - self.travelled_m
        self.travelled_m = self._tour.route.nearest_m(
            pose.place, from_m=self.travelled_m, window_m=min(SEARCH_M, left_m)
        )
        return math.inf if stop is None else stop.at_m - self.travelled_m

    def _carrot(self, left_m: float) -> Point:
        """The place on the route to steer for; beyond a stop, straight on."""
        route = self._tour.route
        if left_m >= LOOKAHEAD_M:
            return route.at(self.travelled_m + LOOKAHEAD_M)
        end_m = self.travelled_m + left_m
        before, end = route.at(end_m - SPACING_M), route.at(end_m - 1e-9)
        return Pose(end.x_m, end.y_m, bearing_rad(before, end)).ahead(LOOKAHEAD_M - left_m)

    def _turn(self, carrot: Point, pose: Pose) -> BodyVelocity | None:
        """The turn on the spot, while the way on is too far aside."""
        aside_rad = math.remainder(bearing_rad(pose.place, carrot) - pose.yaw_rad, math.tau)
        self._is_turning = abs(aside_rad) > (_TURNED_RAD if self._is_turning else _TURN_FROM_RAD)
        if not self._is_turning:
            return None
        # As fast as it can still be stopped in time, with one period of delay.
        fastest = math.sqrt(2 * _ANGULAR_RAD_PER_S2 * abs(aside_rad)) / 2
        return BodyVelocity(0.0, math.copysign(min(_TURN_RAD_PER_S, fastest), aside_rad))


def _within(wanted: float, last: float, change: float) -> float:
    return min(max(wanted, last - change), last + change)


def steering(route: Route | Tour, model: DriveModel) -> Steer[Body]:
    """Function that steers a robot along ``route`` by its true pose."""
    if isinstance(route, Tour):
        return WaypointFollower(route, model).command
    return PurePursuit(route, model).command
