# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The floor with the robot's path in the colours of the deciding rules."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise

from smarttestudo.bags.floor import PathPoint
from smarttestudo.bags.incident_mark import IncidentMark
from smarttestudo.domain.floor_plan import FloorPlan, FloorZone, OccupancyMap
from smarttestudo.report.map_frame import (
    MapFrame,
    NamedPlace,
    axes,
    map_frame,
    markers,
    zone_names,
)
from smarttestudo.report.markup import Markup, coordinate, tag
from smarttestudo.report.rule_timeline import DecidingBlock, RuleSpan, RuleStyle, RuleStyles, block_at

MAX_POINTS = 1000
_FARTHEST_M = 1e7


@dataclass(frozen=True, slots=True, kw_only=True)
class PathPiece:
    """A stretch of the path over which one block decided; ``None`` stands for the defaults."""

    block: DecidingBlock | None
    points: tuple[PathPoint, ...]


def known_places(path: Iterable[PathPoint]) -> list[PathPoint]:
    """``path`` without the points whose place is unknown or beyond any map."""
    return [one for one in path if abs(one.x_m) < _FARTHEST_M and abs(one.y_m) < _FARTHEST_M]


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
