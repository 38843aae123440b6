# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The floor with the robot's path in the colours of the deciding rules."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import chain, groupby, pairwise

from smarttestudo.bags.incident_record import IncidentMark
from smarttestudo.bags.robot_path import PathPoint
from smarttestudo.domain.floor_plan import FloorPlan, FloorZone, OccupancyMap, Rectangle
from smarttestudo.report.axes import Scale, foot_axis, label, multiples, round_step, value_axis
from smarttestudo.report.markup import Markup, coordinate, tag
from smarttestudo.report.rule_timeline import DecidingBlock, RuleSpan, RuleStyle, RuleStyles, block_at

_WIDTH = 600.0
_TALLEST = 690.0
_LEFT, _RIGHT, _TOP, _BOTTOM = 48.0, 8.0, 8.0, 46.0
_LEAST_SPAN_M = 2.0
_LEAST_REACH_M = 20.0
_GRID_LINES = 8


@dataclass(frozen=True, slots=True, kw_only=True)
class MapFrame:
    """The map's scales, one metre as long in x as in y, and its size."""

    x: Scale
    y: Scale
    width: float
    height: float

    @property
    def per_m(self) -> float:
        """How long a metre is on the map."""
        (left, right), (low_m, high_m) = self.x.places, self.x.values
        return (right - left) / (high_m - low_m)

    def place(self, point: PathPoint) -> tuple[float, float]:
        """Where ``point`` is on the map."""
        return self.x(point.x_m), self.y(point.y_m)

    def points(self, path: Iterable[PathPoint]) -> str:
        """``path`` as the points of a polyline."""
        return " ".join(f"{coordinate(x)},{coordinate(y)}" for x, y in map(self.place, path))

    def rectangle(self, area: Rectangle, css_class: str) -> Markup:
        """``area`` as an element."""
        left, right = self.x(area.min_x_m), self.x(area.max_x_m)
        top, bottom = self.y(area.max_y_m), self.y(area.min_y_m)
        return tag("rect", class_=css_class, x=left, y=top, width=right - left, height=bottom - top)


def map_frame(plan: FloorPlan, places: Sequence[PathPoint]) -> MapFrame | None:
    """A frame around everything, with a margin; ``None`` where there is nothing."""
    footprints = [_sides_m(obstacle.footprint) for obstacle in plan.obstacles]
    zones = [_sides_m(zone.area) for zone in plan.zones]
    core = [*_corners_m(plan.occupancy), *((place.x_m, place.y_m) for place in places), *chain(*footprints)]
    xs_m = _with_near_sides([x_m for x_m, _ in core], [x_m for zone in zones for x_m, _ in zone])
    ys_m = _with_near_sides([y_m for _, y_m in core], [y_m for zone in zones for _, y_m in zone])
    if not xs_m or not ys_m:
        return None
    margin_m = 0.02 * max(max(xs_m) - min(xs_m), max(ys_m) - min(ys_m), _LEAST_SPAN_M)
    min_x_m, max_x_m = _widened(xs_m, margin_m)
    min_y_m, max_y_m = _widened(ys_m, margin_m)
    per_m = min(
        (_WIDTH - _LEFT - _RIGHT) / (max_x_m - min_x_m), (_TALLEST - _TOP - _BOTTOM) / (max_y_m - min_y_m)
    )
    right, bottom = _LEFT + per_m * (max_x_m - min_x_m), _TOP + per_m * (max_y_m - min_y_m)
    return MapFrame(
        x=Scale(values=(min_x_m, max_x_m), places=(_LEFT, right)),
        y=Scale(values=(min_y_m, max_y_m), places=(bottom, _TOP)),
        width=right + _RIGHT,
        height=bottom + _BOTTOM,
    )


def axes(frame: MapFrame) -> Iterator[Markup]:
    """Lines at round metres, labelled, with the axes' titles."""
    (left, right), (bottom, top) = frame.x.places, frame.y.places
    (min_x_m, max_x_m), (min_y_m, max_y_m) = frame.x.values, frame.y.values
    step_m = round_step(max(max_x_m - min_x_m, max_y_m - min_y_m) / _GRID_LINES)
    yield from foot_axis(
        ((label(x_m), frame.x(x_m)) for x_m in multiples(step_m, min_x_m, max_x_m)), top=top, foot=bottom
    )
    yield from value_axis(
        ((label(y_m), frame.y(y_m)) for y_m in multiples(step_m, min_y_m, max_y_m)), left=left, right=right
    )
    yield tag("text", "x in m", class_="axis", x=right, y=bottom + 40, text_anchor="end")
    turned = f"translate(12 {coordinate(top)}) rotate(-90)"
    yield tag("text", "y in m", class_="axis", transform=turned, text_anchor="end")


def _sides_m(area: Rectangle) -> tuple[tuple[float, float], tuple[float, float]]:
    return (area.min_x_m, area.min_y_m), (area.max_x_m, area.max_y_m)


def _with_near_sides(core_m: Sequence[float], sides_m: Iterable[float]) -> list[float]:
    """``core_m`` with the sides of zones that are near it; rules may put one anywhere."""
    finite_m = filter(math.isfinite, sides_m)
    if not core_m:
        return list(finite_m)
    low_m, high_m = min(core_m), max(core_m)
    reach_m = max(2 * (high_m - low_m), _LEAST_REACH_M)
    return [*core_m, *(side_m for side_m in finite_m if low_m - reach_m <= side_m <= high_m + reach_m)]


def _corners_m(occupancy: OccupancyMap | None) -> Iterator[tuple[float, float]]:
    """The corners of a map that may be turned."""
    if occupancy is None:
        return
    cos, sin = math.cos(occupancy.yaw_rad), math.sin(occupancy.yaw_rad)
    for along_m in (0.0, occupancy.width_m):
        for up_m in (0.0, occupancy.height_m):
            yield (
                occupancy.origin_x_m + cos * along_m - sin * up_m,
                occupancy.origin_y_m + sin * along_m + cos * up_m,
            )


def _widened(values_m: Sequence[float], margin_m: float) -> tuple[float, float]:
    """The extent of ``values_m`` with a margin at both ends, at least 2 m."""
    low_m, high_m = min(values_m), max(values_m)
    more_m = margin_m + max(0.0, _LEAST_SPAN_M - (high_m - low_m)) / 2
    return low_m - more_m, high_m + more_m


_TIME_LABELS = 5
_LABEL_SPACE = 30.0
_LABEL_ASIDE = 8.0
_NAME_SPACE = 90.0
_LONGEST_NAME = 24
_CHARACTER_WIDTH = 8.0
_LINE_HEIGHT = 24.0
# The names of start and end cover places to one side of these.
_MARKED, _MARKED_STEPS = 12.0, 12


def zone_names(zones: Sequence[FloorZone], places: Sequence[PathPoint], frame: MapFrame) -> Iterator[Markup]:
    """Put each zone's name in the corner of the zone that the path leaves free."""
    path = [frame.place(point) for point in places]
    shifts = [_MARKED * step for step in range(-_MARKED_STEPS, _MARKED_STEPS)]
    beside_ends = [(x + shift, y) for x, y in (*path[:1], *path[-1:]) for shift in shifts]
    for zone in zones:
        left, right = frame.x(zone.area.min_x_m), frame.x(zone.area.max_x_m)
        top, bottom = frame.y(zone.area.max_y_m), frame.y(zone.area.min_y_m)
        width = _CHARACTER_WIDTH * (len(zone.name) + 1)
        corners = [(x, y) for y in (top, bottom - _LINE_HEIGHT) for x in (left, right - width)]
        x, y = min(corners, key=lambda corner: _passages([*path, *beside_ends], corner, width))
        if x == left:
            yield tag("text", zone.name, class_="zone-name", x=x + 8, y=y + 17)
        else:
            yield tag("text", zone.name, class_="zone-name", x=right - 8, y=y + 17, text_anchor="end")


@dataclass(frozen=True, slots=True, kw_only=True)
class NamedPlace:
    """Where something happened on the path, and what."""

    name: str
    point: PathPoint


def markers(
    places: Sequence[PathPoint], frame: MapFrame, happened: NamedPlace | None = None
) -> Iterator[Markup]:
    """Start and end, as one where they nearly meet, and round times in between where there is room.

    Also what ``happened``.
    """
    if not places:
        return
    first, last = frame.place(places[0]), frame.place(places[-1])
    taken = [first, last]
    if happened is not None:
        x, y = frame.place(happened.point)
        taken.append((x, y))
        yield tag("path", class_="happened", d=f"M{coordinate(x)} {coordinate(y - 8)}l8 8l-8 8l-8 -8z")
        name = happened.name
        cut = name if len(name) <= _LONGEST_NAME else f"{name[: _LONGEST_NAME - 1]}…"
        yield _beside(cut, (x, y), frame, lift=14.0)
    for time_s, point in _at_round_times(places):
        x, y = frame.place(point)
        if all(_apart((x, y), other) for other in taken):
            taken.append((x, y))
            yield tag("circle", class_="passing", cx=x, cy=y, r=3.0)
            yield tag("text", f"{label(time_s)} s", class_="passing-time", x=x + 7, y=y - 6)
    meets = not _apart(first, last)
    aside = _LABEL_ASIDE if abs(first[1] - last[1]) < _LINE_HEIGHT and not meets else 0.0
    lift = aside if first[1] < last[1] else -aside
    yield tag("circle", class_="start", cx=first[0], cy=first[1], r=6.0)
    yield _beside("Start, end" if meets else "Start", first, frame, lift=lift)
    if not meets:
        yield tag("rect", class_="end", x=last[0] - 5, y=last[1] - 5, width=10.0, height=10.0)
        yield _beside("End", last, frame, lift=-lift)


def _passages(path: Sequence[tuple[float, float]], corner: tuple[float, float], width: float) -> int:
    """How many places of ``path`` a line of text whose upper left corner is ``corner`` would cover."""
    left, top = corner
    return sum(left <= x <= left + width and top <= y <= top + _LINE_HEIGHT for x, y in path)


def _apart(one: tuple[float, float], other: tuple[float, float]) -> bool:
    return abs(one[0] - other[0]) + abs(one[1] - other[1]) >= _LABEL_SPACE


def _beside(name: str, place: tuple[float, float], frame: MapFrame, *, lift: float) -> Markup:
    """``name`` to the right of a marker, to its left where there is no room, ``lift`` higher."""
    x, y = place[0], place[1] + 4 - lift
    if x > frame.width - max(_NAME_SPACE, _CHARACTER_WIDTH * len(name)):
        return tag("text", name, class_="marker-name", x=x - 11, y=y, text_anchor="end")
    return tag("text", name, class_="marker-name", x=x + 11, y=y)


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


MAX_POINTS = 1000
_FARTHEST_M = 1e7


@dataclass(frozen=True, slots=True, kw_only=True)
class PathPiece:
    """A stretch of the path over which one block decided; ``None`` stands for the defaults."""

    block: DecidingBlock | None
    points: tuple[PathPoint, ...]


def known_places(path: Iterable[PathPoint]) -> list[PathPoint]:
    """``path`` without the points whose place is unknown or beyond any map."""
    return [place for place in path if abs(place.x_m) < _FARTHEST_M and abs(place.y_m) < _FARTHEST_M]


def thinned(path: Sequence[PathPoint], max_points: int = MAX_POINTS) -> list[PathPoint]:
    """``path`` with points left out that lie within a thousandth of its length of the last kept one."""
    if len(path) <= max_points:
        return list(path)
    spacing_m = sum(_distance_m(a, b) for a, b in pairwise(path)) / max_points
    kept = [path[0]]
    for point in path[1:-1]:
        if _distance_m(kept[-1], point) > spacing_m:
            kept.append(point)
    return [*kept, path[-1]]


def path_pieces(path: Sequence[PathPoint], spans: Sequence[RuleSpan]) -> Iterator[PathPiece]:
    """``path`` cut where another block begins to decide; each piece starts where the last one ended."""
    points: list[PathPoint] = []
    block: DecidingBlock | None = None
    for point in path:
        now = block_at(spans, point.t_s)
        if points and now != block:
            yield PathPiece(block=block, points=(*points, point))
            points = []
        block = now
        points.append(point)
    if points:
        yield PathPiece(block=block, points=tuple(points))


def _distance_m(a: PathPoint, b: PathPoint) -> float:
    return math.hypot(b.x_m - a.x_m, b.y_m - a.y_m)


MOST_STRIPS = 5000


def occupied_cells(occupancy: OccupancyMap, frame: MapFrame) -> Markup:
    """The occupied cells as a path of strips; neighbouring cells are joined until it is short enough."""
    joined = 1
    while len(strips := list(_strips(_coarser(occupancy.rows, joined)))) > MOST_STRIPS:
        joined *= 2
    outline = "".join(f"M{start} {row}h{length}v1h-{length}z" for row, start, length in strips)
    return tag("path", class_="occupied", d=outline, transform=_from_cells(occupancy, joined, frame))


def _from_cells(occupancy: OccupancyMap, joined: int, frame: MapFrame) -> str:
    """From cells, counted from the lower left, to places on the map."""
    per_m = frame.per_m
    left, bottom = frame.x(occupancy.origin_x_m), frame.y(occupancy.origin_y_m)
    cell = occupancy.cell_m * joined * per_m
    turn = -math.degrees(occupancy.yaw_rad)
    return (
        f"translate({coordinate(left)} {coordinate(bottom)}) rotate({turn:.3f}) scale({cell:.4f} {-cell:.4f})"
    )


def _coarser(rows: Sequence[Sequence[bool]], joined: int) -> list[list[bool]]:
    """Squares of ``joined`` cells as one, occupied if any of them is."""
    if joined == 1:
        return [list(row) for row in rows]
    return [
        [
            any(any(row[left : left + joined]) for row in rows[top : top + joined])
            for left in range(0, len(rows[top]), joined)
        ]
        for top in range(0, len(rows), joined)
    ]


def _strips(rows: Sequence[Sequence[bool]]) -> Iterator[tuple[int, int, int]]:
    """Row, start and length of each run of occupied cells."""
    for number, row in enumerate(rows):
        start = 0
        for is_occupied, run in groupby(row):
            length = sum(1 for _ in run)
            if is_occupied:
                yield number, start, length
            start += length


@dataclass(frozen=True, slots=True, kw_only=True)
class FloorMap:
    """The map, the same in whichever form it is drawn.

    ``zones`` and ``pieces`` of the path have the styles of their blocks; ``known`` are all places that are
    known, ``line`` as many of them as are drawn. ``happened`` is an incident, if the run is one.
    """

    plan: FloorPlan
    frame: MapFrame
    known: tuple[PathPoint, ...]
    line: tuple[PathPoint, ...]
    zones: tuple[tuple[FloorZone, RuleStyle], ...]
    pieces: tuple[tuple[tuple[PathPoint, ...], RuleStyle], ...]
    happened: NamedPlace | None = None

    @property
    def places(self) -> Iterator[tuple[float, float, float]]:
        """When the robot was where on the drawing."""
        return ((point.t_s, *self.frame.place(point)) for point in self.line)


def floor_map(
    plan: FloorPlan | None,
    path: Sequence[PathPoint],
    spans: Sequence[RuleSpan],
    styles: RuleStyles,
    *,
    incident: IncidentMark | None = None,
) -> FloorMap | None:
    """The map; ``None`` where there is neither a floor plan nor a known place."""
    plan = plan or FloorPlan()
    known = known_places(path)
    frame = map_frame(plan, known)
    if frame is None:
        return None
    line = thinned(known)
    return FloorMap(
        plan=plan,
        frame=frame,
        known=tuple(known),
        line=tuple(line),
        zones=tuple((zone, styles.of_zone(zone.name)) for zone in plan.zones),
        pieces=tuple((piece.points, styles.of(piece.block)) for piece in path_pieces(line, spans)),
        happened=None if incident is None else _place_of(incident, known),
    )


def _place_of(incident: IncidentMark, known: Sequence[PathPoint]) -> NamedPlace | None:
    """The first place that is known from the incident on."""
    point = next((point for point in known if point.t_s >= incident.at_s), None)
    return None if point is None else NamedPlace(name=incident.name, point=point)


def draw_floor_map(floor: FloorMap) -> Markup:
    """The map as an SVG element."""
    frame = floor.frame
    return tag(
        "svg",
        *axes(frame),
        *_floor(floor),
        tag("polyline", class_="path-edge", points=frame.points(floor.line)),
        *(
            tag("polyline", class_=f"path {style.css_class}", points=frame.points(points))
            for points, style in floor.pieces
        ),
        *zone_names(floor.plan.zones, floor.line, frame),
        *markers(floor.known, frame, floor.happened),
        class_="map",
        viewBox=f"0 0 {coordinate(frame.width)} {coordinate(frame.height)}",
        role="img",
        aria_label="Floor plan with the robot's path, coloured by deciding rule",
    )


def _floor(floor: FloorMap) -> Iterator[Markup]:
    for zone, style in floor.zones:
        yield floor.frame.rectangle(zone.area, f"zone {style.css_class}")
    if floor.plan.occupancy is not None:
        yield occupied_cells(floor.plan.occupancy, floor.frame)
    for obstacle in floor.plan.obstacles:
        yield floor.frame.rectangle(obstacle.footprint, obstacle.kind.value)
