# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Tours: routes on which the robot pauses, turns on the spot, and is in more or less of a hurry.

Numbers are those that Nav2's ``nav2_params.yaml`` gives a TurtleBot3's regulated pure pursuit and velocity
smoother, except for a smaller tolerance of the goal.
"""

from __future__ import annotations

import itertools
import math
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass

from smarttestudo.domain.floor_plan import Point
from smarttestudo.domain.units import ns_from_s
from smarttestudo.simulation.geometry import BodyVelocity, Pose
from smarttestudo.simulation.robot import Body, DriveModel
from smarttestudo.simulation.route import (
    CRUISE_M_PER_S,
    LOOKAHEAD_M,
    SEARCH_M,
    Navigator,
    PurePursuit,
    Route,
    Steer,
    towards,
)

CORNER_RADIUS_M = 0.8
_SPACING_M = 0.05


@dataclass(frozen=True, slots=True, kw_only=True)
class Waypoint:
    """A place, the speed on the way to it, and how long the robot pauses there; at 0 it passes by."""

    place: Point
    speed_m_per_s: float = CRUISE_M_PER_S
    pause_s: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Goal:
    """The end of a leg: how far along the round it is, and what the waypoint there asks for."""

    at_m: float
    speed_m_per_s: float
    pause_s: float


class Tour:
    """Rounds through waypoints, from the first one back to it; the robot begins with the pause there."""

    __slots__ = ("_goals", "route")

    def __init__(self, waypoints: Sequence[Waypoint]) -> None:
        """At least three waypoints; legs must be long enough for arcs of 0.8 m where it does not pause."""
        places = [waypoint.place for waypoint in waypoints]
        radii_m = [0.0 if waypoint.pause_s else CORNER_RADIUS_M for waypoint in waypoints]
        self.route = Route.from_first(places, corner_radii_m=radii_m)
        self._goals: list[Goal] = []
        at_m = 0.0
        for before, waypoint in itertools.pairwise(waypoints):
            leg_m = before.place.distance_m(waypoint.place)
            at_m = self.route.nearest_m(waypoint.place, from_m=at_m, window_m=leg_m + _SPACING_M)
            self._goals.append(_goal(waypoint, at_m))
        self._goals.append(_goal(waypoints[0], self.route.length_m))

    @property
    def start(self) -> Pose:
        """The first waypoint, heading for the second."""
        return self.route.start

    @property
    def first_pause_s(self) -> float:
        """How long the robot stands at the start."""
        return self._goals[-1].pause_s

    def goal_after(self, travelled_m: float) -> Goal:
        """The end of the leg on which the robot is after so many metres, counted round after round."""
        rounds, rest_m = divmod(travelled_m, self.route.length_m)
        index = bisect_right([goal.at_m for goal in self._goals], rest_m)
        goal = self._goals[min(index, len(self._goals) - 1)]
        at_m = rounds * self.route.length_m + goal.at_m
        return Goal(at_m=at_m, speed_m_per_s=goal.speed_m_per_s, pause_s=goal.pause_s)

    def stop_after(self, travelled_m: float) -> Goal | None:
        """The next goal with a pause, if there is one within a round."""
        goal = self.goal_after(travelled_m)
        for _ in self._goals:
            if goal.pause_s:
                return goal
            goal = self.goal_after(goal.at_m)
        return None


def _goal(waypoint: Waypoint, at_m: float) -> Goal:
    return Goal(at_m=at_m, speed_m_per_s=waypoint.speed_m_per_s, pause_s=waypoint.pause_s)


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
        here = Point(pose.x_m, pose.y_m)
        self.travelled_m = self._tour.route.nearest_m(
            here, from_m=self.travelled_m, window_m=min(SEARCH_M, left_m)
        )
        return math.inf if stop is None else stop.at_m - self.travelled_m

    def _carrot(self, left_m: float) -> Point:
        """The place on the route to steer for; beyond a stop, straight on."""
        route = self._tour.route
        if left_m >= LOOKAHEAD_M:
            return route.at(self.travelled_m + LOOKAHEAD_M)
        end_m = self.travelled_m + left_m
        before, end = route.at(end_m - _SPACING_M), route.at(end_m - 1e-9)
        heading_rad = math.atan2(end.y_m - before.y_m, end.x_m - before.x_m)
        return Pose(end.x_m, end.y_m, heading_rad).ahead(LOOKAHEAD_M - left_m)

    def _turn(self, carrot: Point, pose: Pose) -> BodyVelocity | None:
        """The turn on the spot, while the way on is too far aside."""
        bearing_rad = math.atan2(carrot.y_m - pose.y_m, carrot.x_m - pose.x_m) - pose.yaw_rad
        bearing_rad = math.remainder(bearing_rad, math.tau)
        self._is_turning = abs(bearing_rad) > (_TURNED_RAD if self._is_turning else _TURN_FROM_RAD)
        if not self._is_turning:
            return None
        # As fast as it can still be stopped in time, with one period of delay.
        fastest = math.sqrt(2 * _ANGULAR_RAD_PER_S2 * abs(bearing_rad)) / 2
        return BodyVelocity(0.0, math.copysign(min(_TURN_RAD_PER_S, fastest), bearing_rad))


def _within(wanted: float, last: float, change: float) -> float:
    return min(max(wanted, last - change), last + change)


def steering(route: Route | Tour, model: DriveModel) -> Steer[Body]:
    """Function that steers a robot along ``route`` by its true pose."""
    if isinstance(route, Tour):
        return WaypointFollower(route, model).command
    return PurePursuit(route, model).command
