# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Routes, and following them."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable, Iterator, Sequence
from itertools import accumulate, pairwise
from typing import Generic

from smarttestudo.domain.floor_plan import Point
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.simulation.geometry import BodyVelocity, Pose
from smarttestudo.simulation.messages import Published, Topic, command
from smarttestudo.simulation.robot import Body, BodyT, DriveModel

_SPACING_M = 0.05


class Route:
    """A closed line; places on it are named by the distance travelled, round after round."""

    __slots__ = ("_starts_m", "length_m", "points")

    def __init__(self, points: Sequence[Point]) -> None:
        """A round over ``points``, which ends where it starts."""
        self.points = (*points, points[0])
        self._starts_m = [0.0, *accumulate(a.distance_m(b) for a, b in pairwise(self.points))]
        self.length_m = self._starts_m[-1]

    @staticmethod
    def through(waypoints: Sequence[Point], *, corner_radius_m: float) -> Route:
        """A round along the straight lines between ``waypoints``, each corner an arc of the given radius.

        It starts in the middle of the first line. Lines must be long enough for the arcs at both ends.
        """
        count = len(waypoints)
        points = [_between(waypoints[0], waypoints[1], 0.5)]
        for index in range(1, count + 1):
            before, corner, after = (
                waypoints[index - 1],
                waypoints[index % count],
                waypoints[(index + 1) % count],
            )
            points += _arc(before, corner, after, corner_radius_m)
        return Route(points)

    @staticmethod
    def from_first(waypoints: Sequence[Point], *, corner_radii_m: Sequence[float]) -> Route:
        """A round from the first of ``waypoints`` through the others and back.

        Each corner is an arc of its radius; 0 leaves it a corner, as the first one always is.
        """
        points = [waypoints[0]]
        for index in range(1, len(waypoints)):
            before, corner, after = (
                waypoints[index - 1],
                waypoints[index],
                waypoints[(index + 1) % len(waypoints)],
            )
            radius_m = corner_radii_m[index]
            points += _arc(before, corner, after, radius_m) if radius_m else (corner,)
        return Route(points)

    @property
    def start(self) -> Pose:
        """The first place, heading along the route."""
        first, second = self.points[:2]
        return Pose(first.x_m, first.y_m, math.atan2(second.y_m - first.y_m, second.x_m - first.x_m))

    def at(self, travelled_m: float) -> Point:
        """The place after ``travelled_m`` metres."""
        rest_m = travelled_m % self.length_m
        index = min(bisect_right(self._starts_m, rest_m), len(self.points) - 1)
        start_m, end_m = self._starts_m[index - 1 : index + 1]
        return _between(self.points[index - 1], self.points[index], (rest_m - start_m) / (end_m - start_m))

    def nearest_m(self, point: Point, *, from_m: float, window_m: float) -> float:
        """How far along the route is nearest to ``point``, between ``from_m`` and ``window_m`` later."""
        steps = round(window_m / _SPACING_M)
        candidates = [from_m + step * _SPACING_M for step in range(steps + 1)]
        return min(candidates, key=lambda travelled_m: self.at(travelled_m).distance_m(point))


def _between(start: Point, end: Point, share: float) -> Point:
    return Point(start.x_m + share * (end.x_m - start.x_m), start.y_m + share * (end.y_m - start.y_m))


def _arc(before: Point, corner: Point, after: Point, radius_m: float) -> Iterator[Point]:
    """Points on the arc that touches both lines of a corner."""
    heading_in = math.atan2(corner.y_m - before.y_m, corner.x_m - before.x_m)
    heading_out = math.atan2(after.y_m - corner.y_m, after.x_m - corner.x_m)
    turn = math.remainder(heading_out - heading_in, math.tau)
    side = math.copysign(1.0, turn)
    start = Pose(corner.x_m, corner.y_m, heading_in).ahead(-radius_m * abs(math.tan(turn / 2)))
    centre = Pose(start.x_m, start.y_m, heading_in + side * math.pi / 2).ahead(radius_m)
    count = max(2, math.ceil(abs(turn) * radius_m / _SPACING_M))
    for step in range(count + 1):
        bearing = heading_in - side * math.pi / 2 + turn * step / count
        yield Pose(centre.x_m, centre.y_m, bearing).ahead(radius_m)


LOOKAHEAD_M = 0.4
SEARCH_M = 0.5
CRUISE_M_PER_S = 0.25
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
        pose = body.pose
        here = Point(pose.x_m, pose.y_m)
        self.travelled_m = self._route.nearest_m(here, from_m=self.travelled_m, window_m=SEARCH_M)
        goal = self._route.at(self.travelled_m + LOOKAHEAD_M)
        return towards(goal, pose, self._model, cruise_m_per_s=CRUISE_M_PER_S)


def towards(goal: Point, pose: Pose, model: DriveModel, *, cruise_m_per_s: float) -> BodyVelocity:
    """The arc from ``pose`` to ``goal``, at ``cruise_m_per_s`` where it is not tight."""
    bearing = math.atan2(goal.y_m - pose.y_m, goal.x_m - pose.x_m) - pose.yaw_rad
    curvature_per_m = 2 * math.sin(bearing) / Point(pose.x_m, pose.y_m).distance_m(goal)
    share = min(1.0, max(_SLOWEST_SHARE, 1 / max(abs(curvature_per_m) * _SLOW_BELOW_RADIUS_M, 1e-9)))
    linear = min(cruise_m_per_s * share, model.max_linear_m_per_s)
    limit = model.max_angular_rad_per_s
    return BodyVelocity(linear, min(max(linear * curvature_per_m, -limit), limit))


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
        """Command the robot anew."""
        if body.now_ns < self._others_until_ns:
            return []
        velocity = self._steer(body)
        body.command(velocity)
        return [(Topic.CMD_VEL, command(velocity))]
