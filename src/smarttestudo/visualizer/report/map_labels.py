# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What is written on the map: names of zones, start and end, and when the robot passed."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from smarttestudo.visualizer.floor import PathPoint, Zone
from smarttestudo.visualizer.report.map_frame import MapFrame
from smarttestudo.visualizer.report.markup import Markup, tag
from smarttestudo.visualizer.report.scale import label, round_step

_TIME_LABELS = 5
_LABEL_SPACE = 30.0
_NAME_SPACE = 90.0
_CHARACTER_WIDTH = 8.0
_LINE_HEIGHT = 24.0


def zone_names(zones: Sequence[Zone], places: Sequence[PathPoint], frame: MapFrame) -> Iterator[Markup]:
    """Each zone's name in the corner of the zone that the path leaves free."""
    path = [frame.place(point) for point in places]
    for zone in zones:
        left, right = frame.x(zone.area.min_x_m), frame.x(zone.area.max_x_m)
        top, bottom = frame.y(zone.area.max_y_m), frame.y(zone.area.min_y_m)
        width = _CHARACTER_WIDTH * (len(zone.name) + 1)
        corners = [(x, y) for y in (top, bottom - _LINE_HEIGHT) for x in (left, right - width)]
        x, y = min(corners, key=lambda corner: _passages(path, corner, width))
        yield tag("text", zone.name, class_="zone-name", x=x + 8, y=y + 17)


def markers(places: Sequence[PathPoint], frame: MapFrame) -> Iterator[Markup]:
    """Start and end, as one where they nearly meet, and round times in between where there is room."""
    if not places:
        return
    first, last = frame.place(places[0]), frame.place(places[-1])
    taken = [first, last]
    for time_s, point in _at_round_times(places):
        x, y = frame.place(point)
        if all(_apart((x, y), other) for other in taken):
            taken.append((x, y))
            yield tag("circle", class_="passing", cx=x, cy=y, r=3.0)
            yield tag("text", f"{label(time_s)} s", class_="passing-time", x=x + 7, y=y - 6)
    meets = not _apart(first, last)
    yield tag("circle", class_="start", cx=first[0], cy=first[1], r=6.0)
    yield _beside("Start, end" if meets else "Start", first, frame)
    if not meets:
        yield tag("rect", class_="end", x=last[0] - 5, y=last[1] - 5, width=10.0, height=10.0)
        yield _beside("End", last, frame)


def _passages(path: Sequence[tuple[float, float]], corner: tuple[float, float], width: float) -> int:
    """How many places of ``path`` a line of text whose upper left corner is ``corner`` would cover."""
    left, top = corner
    return sum(left <= x <= left + width and top <= y <= top + _LINE_HEIGHT for x, y in path)


def _apart(one: tuple[float, float], other: tuple[float, float]) -> bool:
    return abs(one[0] - other[0]) + abs(one[1] - other[1]) >= _LABEL_SPACE


def _beside(name: str, place: tuple[float, float], frame: MapFrame) -> Markup:
    """``name`` to the right of a marker, to its left where there is no room."""
    x, y = place
    if x > frame.width - _NAME_SPACE:
        return tag("text", name, class_="marker-name", x=x - 11, y=y + 4, text_anchor="end")
    return tag("text", name, class_="marker-name", x=x + 11, y=y + 4)


def _at_round_times(places: Sequence[PathPoint]) -> Iterator[tuple[float, PathPoint]]:
    """Round times, each with the first place from then on."""
    duration_s = places[-1].t_s - places[0].t_s
    if duration_s <= 0:
        return
    step_s = round_step(duration_s / _TIME_LABELS)
    due_s = step_s * math.ceil(places[0].t_s / step_s)
    for point in places:
        if point.t_s >= due_s:
            yield due_s, point
            due_s = step_s * (math.floor(point.t_s / step_s) + 1)
