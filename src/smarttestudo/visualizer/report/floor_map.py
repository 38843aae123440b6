# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The floor plan with the robot's path in the colours of the deciding blocks."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from smarttestudo.visualizer.floor import FloorPlan, PathPoint
from smarttestudo.visualizer.report.map_frame import MapFrame, axes, map_frame
from smarttestudo.visualizer.report.map_labels import markers, zone_names
from smarttestudo.visualizer.report.markup import Markup, coordinate, tag
from smarttestudo.visualizer.report.occupancy import occupied_cells
from smarttestudo.visualizer.report.path_line import known_places, path_pieces, thinned
from smarttestudo.visualizer.report.rule_styles import RuleStyles
from smarttestudo.visualizer.rule_timeline import RuleSpan


@dataclass(frozen=True, slots=True, kw_only=True)
class FloorMap:
    """The drawing, the frame that it is drawn in, and the path as far as it is drawn."""

    drawing: Markup
    frame: MapFrame
    line: tuple[PathPoint, ...]


def floor_map(
    plan: FloorPlan | None, path: Sequence[PathPoint], spans: Sequence[RuleSpan], styles: RuleStyles
) -> FloorMap | None:
    """The map; ``None`` where there is neither a floor plan nor a known place."""
    plan = plan or FloorPlan()
    places = known_places(path)
    frame = map_frame(plan, places)
    if frame is None:
        return None
    line = thinned(places)
    drawing = tag(
        "svg",
        *axes(frame),
        *_floor(plan, frame, styles),
        *_path(line, frame, spans, styles),
        *zone_names(plan.zones, line, frame),
        *markers(places, frame),
        class_="map",
        viewBox=f"0 0 {coordinate(frame.width)} {coordinate(frame.height)}",
        role="img",
        aria_label="Floor plan with the robot's path, coloured by deciding rule",
    )
    return FloorMap(drawing=drawing, frame=frame, line=tuple(line))


def _floor(plan: FloorPlan, frame: MapFrame, styles: RuleStyles) -> Iterator[Markup]:
    for zone in plan.zones:
        yield frame.rectangle(zone.area, f"zone {styles.of_zone(zone.name).css_class}")
    if plan.occupancy is not None:
        yield occupied_cells(plan.occupancy, frame)
    for obstacle in plan.obstacles:
        yield frame.rectangle(obstacle.footprint, obstacle.kind.value)


def _path(
    places: Sequence[PathPoint], frame: MapFrame, spans: Sequence[RuleSpan], styles: RuleStyles
) -> Iterator[Markup]:
    yield tag("polyline", class_="path-edge", points=frame.points(places))
    for piece in path_pieces(places, spans):
        look = styles.of(piece.block).css_class
        yield tag("polyline", class_=f"path {look}", points=frame.points(piece.points))
