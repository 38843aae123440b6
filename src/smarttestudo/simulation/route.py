# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Ways through the warehouse: routes, tours on which the robot pauses, and tours in files."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import accumulate, pairwise
from pathlib import Path

from smarttestudo.domain.errors import MissionError, ProfileError
from smarttestudo.domain.floor_plan import FloorPlan, Point
from smarttestudo.files.input_file import read_input
from smarttestudo.files.toml_text import parse_toml
from smarttestudo.simulation.geometry import Pose, bearing_rad
from smarttestudo.simulation.robot import DriveModel

SPACING_M = 0.05


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
        middle = _between(waypoints[0], waypoints[1], 0.5)
        corners = (*waypoints[1:], waypoints[0])
        return Route.from_first((middle, *corners), corner_radii_m=(0.0, *(corner_radius_m for _ in corners)))

    @staticmethod
    def from_first(waypoints: Sequence[Point], *, corner_radii_m: Sequence[float]) -> Route:
        """A round from the first of ``waypoints`` through the others and back.

        Each corner is an arc of its radius; 0 leaves it a corner, as the first one always is.
        """
        points = [waypoints[0]]
        corners = zip(
            waypoints, waypoints[1:], (*waypoints[2:], waypoints[0]), corner_radii_m[1:], strict=False
        )
        for before, corner, after, radius_m in corners:
            points += _arc(before, corner, after, radius_m) if radius_m else (corner,)
        return Route(points)

    @property
    def start(self) -> Pose:
        """The first place, heading along the route."""
        first, second = self.points[:2]
        return Pose(first.x_m, first.y_m, bearing_rad(first, second))

    def at(self, travelled_m: float) -> Point:
        rest_m = travelled_m % self.length_m
        index = min(bisect_right(self._starts_m, rest_m), len(self.points) - 1)
        start_m, end_m = self._starts_m[index - 1 : index + 1]
        return _between(self.points[index - 1], self.points[index], (rest_m - start_m) / (end_m - start_m))

    def nearest_m(self, point: Point, *, from_m: float, window_m: float) -> float:
        """How far along the route is nearest to ``point``, between ``from_m`` and ``window_m`` later."""
        steps = round(window_m / SPACING_M)
        candidates = [from_m + step * SPACING_M for step in range(steps + 1)]
        return min(candidates, key=lambda travelled_m: self.at(travelled_m).distance_m(point))


def _between(start: Point, end: Point, share: float) -> Point:
    return Point(start.x_m + share * (end.x_m - start.x_m), start.y_m + share * (end.y_m - start.y_m))


def _arc(before: Point, corner: Point, after: Point, radius_m: float) -> Iterator[Point]:
    """Points on the arc that touches both lines of a corner."""
    heading_in, turn = bearing_rad(before, corner), _turn_rad(before, corner, after)
    side = math.copysign(1.0, turn)
    start = Pose(corner.x_m, corner.y_m, heading_in).ahead(-_arc_m(turn, radius_m))
    centre = Pose(start.x_m, start.y_m, heading_in + side * math.pi / 2).ahead(radius_m)
    count = max(2, math.ceil(abs(turn) * radius_m / SPACING_M))
    for step in range(count + 1):
        bearing = heading_in - side * math.pi / 2 + turn * step / count
        yield Pose(centre.x_m, centre.y_m, bearing).ahead(radius_m)


def _turn_rad(before: Point, corner: Point, after: Point) -> float:
    return math.remainder(bearing_rad(corner, after) - bearing_rad(before, corner), math.tau)


def _arc_m(turn_rad: float, radius_m: float) -> float:
    """How far before and after a corner its arc begins and ends."""
    return radius_m * abs(math.tan(turn_rad / 2))


CRUISE_M_PER_S = 0.25
CORNER_RADIUS_M = 0.8


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
        for before, waypoint in pairwise(waypoints):
            leg_m = before.place.distance_m(waypoint.place)
            at_m = self.route.nearest_m(waypoint.place, from_m=at_m, window_m=leg_m + SPACING_M)
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
        return replace(goal, at_m=rounds * self.route.length_m + goal.at_m)

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


_MOST_BYTES = 100_000
_MOST_WAYPOINTS = 1000
_MOST_PAUSE_S = 86_400.0
_LEAST_M_PER_S = 0.05
_MOST_M = 1000.0
_CHECKED_M = 0.05
_KEYS = ("at_m", "speed_m_per_s", "pause_s")


def load_mission(path: Path, plan: FloorPlan) -> Tour:
    """The tour in the TOML file at ``path``, clear of everything on ``plan``.

    Raises ``MissionError`` where the file cannot be read, holds something else, or leads through an obstacle.
    """
    try:
        data = read_input(path, _MOST_BYTES + 1)
        text = data.decode("utf-8-sig")
    except OSError as error:
        cause = f"the mission cannot be read: {error.strerror}"
        raise MissionError(cause, place=str(path), remedy="give the path of a TOML file") from error
    except UnicodeDecodeError as error:
        raise MissionError(
            "the mission is not UTF-8 text", place=str(path), remedy="save it as UTF-8"
        ) from error
    if len(data) > _MOST_BYTES:
        raise MissionError(
            "the mission is larger than 100 KB", place=str(path), remedy="is it the right file?"
        )
    try:
        values, _ = parse_toml(text, path)
    except ProfileError as error:
        raise MissionError(error.cause, place=error.place, remedy=error.remedy) from error
    waypoints = _waypoints(values, path)
    _require_room(waypoints, path)
    tour = Tour(waypoints)
    _require_clear(tour, plan, path)
    return tour


def _waypoints(values: Mapping[str, object], path: Path) -> list[Waypoint]:
    tables = values.get("waypoints")
    remedy = "write at least three tables [[waypoints]] with at_m = [x, y] each, and nothing else"
    is_list = isinstance(tables, list) and set(values) == {"waypoints"}
    if not is_list or not isinstance(tables, list) or not 3 <= len(tables) <= _MOST_WAYPOINTS:
        raise MissionError("not the waypoints of a mission", place=str(path), remedy=remedy)
    return [_waypoint(table, f"{path}: waypoint {number}") for number, table in enumerate(tables, start=1)]


def _waypoint(table: object, place: str) -> Waypoint:
    if not isinstance(table, Mapping) or not set(table) <= set(_KEYS) or "at_m" not in table:
        remedy = f"it must have at_m, and can have {_KEYS[1]} and {_KEYS[2]}"
        raise MissionError("not a waypoint", place=place, remedy=remedy)
    at_m = table["at_m"]
    if not isinstance(at_m, list) or len(at_m) != 2:
        raise MissionError("at_m must be [x, y] in metres", place=place)
    x_m, y_m = (_number(coordinate, "at_m", -_MOST_M, _MOST_M, place) for coordinate in at_m)
    fastest = DriveModel().max_linear_m_per_s
    return Waypoint(
        place=Point(x_m, y_m),
        speed_m_per_s=_number(
            table.get("speed_m_per_s", CRUISE_M_PER_S), "speed_m_per_s", _LEAST_M_PER_S, fastest, place
        ),
        pause_s=_number(table.get("pause_s", 0.0), "pause_s", 0.0, _MOST_PAUSE_S, place),
    )


def _number(value: object, key: str, least: float, most: float, place: str) -> float:
    if isinstance(value, int | float) and not isinstance(value, bool) and least <= value <= most:
        return float(value)
    raise MissionError(f"{key} must be a number from {least:g} to {most:g}", place=place)


def _require_room(waypoints: Sequence[Waypoint], path: Path) -> None:
    """Refuse legs that are shorter than the arcs at their ends."""
    places = [waypoint.place for waypoint in waypoints]
    corners = zip(places[-1:] + places, places, places[1:] + places[:1], strict=False)
    arcs_m = [
        0.0 if waypoint.pause_s or index == 0 else _arc_m(_turn_rad(*corner), CORNER_RADIUS_M)
        for index, (waypoint, corner) in enumerate(zip(waypoints, corners, strict=True))
    ]
    for index, start in enumerate(waypoints):
        after = (index + 1) % len(waypoints)
        leg_m = start.place.distance_m(waypoints[after].place)
        if leg_m <= max(arcs_m[index] + arcs_m[after], _CHECKED_M):
            raise MissionError(
                f"the way from waypoint {index + 1} to the next is {leg_m:.2f} m, too short for its corners",
                place=str(path),
                remedy=f"where the robot does not pause it takes corners in arcs of {CORNER_RADIUS_M:g} m; "
                "move them apart, or let it pause",
            )


def _require_clear(tour: Tour, plan: FloorPlan, path: Path) -> None:
    """Refuse a way on which the robot would touch something."""
    radius_m = DriveModel().radius_m
    for step in range(math.ceil(tour.route.length_m / _CHECKED_M)):
        place = tour.route.at(step * _CHECKED_M)
        if plan.clearance_m(place) <= radius_m:
            raise MissionError(
                f"the robot would touch something at {place.x_m:.1f}, {place.y_m:.1f} m",
                place=str(path),
                remedy="lead it around: the warehouse is on the map examples/warehouse_map.yaml",
            )
