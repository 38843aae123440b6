# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Missions on disk: the waypoints of the simulated robot's tour, as TOML, every complaint with its line."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path

from smarttestudo.domain.errors import MissionError, ProfileError
from smarttestudo.domain.floor_plan import FloorPlan, Point
from smarttestudo.files.input_file import read_input
from smarttestudo.files.toml_text import parse_toml
from smarttestudo.simulation.robot import DriveModel
from smarttestudo.simulation.route import CRUISE_M_PER_S
from smarttestudo.simulation.tour import CORNER_RADIUS_M, Tour, Waypoint

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
    x_m, y_m = (_number(one, "at_m", -_MOST_M, _MOST_M, place) for one in at_m)
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
    arcs_m = [
        0.0 if waypoint.pause_s or index == 0 else _arc_m(index, waypoints)
        for index, waypoint in enumerate(waypoints)
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


def _arc_m(index: int, waypoints: Sequence[Waypoint]) -> float:
    """How far before and after the corner at a waypoint its arc begins and ends."""
    before, after = waypoints[index - 1].place, waypoints[(index + 1) % len(waypoints)].place
    here = waypoints[index].place
    turn = math.atan2(after.y_m - here.y_m, after.x_m - here.x_m) - math.atan2(
        here.y_m - before.y_m, here.x_m - before.x_m
    )
    return CORNER_RADIUS_M * abs(math.tan(math.remainder(turn, math.tau) / 2))


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
