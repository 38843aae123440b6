# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The floor plan with the robot's path in the colours of the deciding blocks."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from smarttestudo.visualizer.page.map_frame import MapFrame, axes, map_frame
from smarttestudo.visualizer.page.map_labels import markers, zone_names
from smarttestudo.visualizer.page.markup import Markup, coordinate, tag
from smarttestudo.visualizer.page.page_input import FloorPlan, PathPoint
from smarttestudo.visualizer.page.path_line import known_places, path_pieces, thinned
from smarttestudo.visualizer.page.rule_styles import RuleStyles
from smarttestudo.visualizer.rule_timeline import RuleSpan


def floor_map(
    plan: FloorPlan | None, path: Sequence[PathPoint], spans: Sequence[RuleSpan], styles: RuleStyles
) -> Markup | None:
    """The map as an SVG element; ``None`` where there is neither a floor plan nor a known place."""
    plan = plan or FloorPlan()
    places = known_places(path)
    frame = map_frame(plan, places)
    if frame is None:
        return None
    line = thinned(places)
    return tag(
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


def _floor(plan: FloorPlan, frame: MapFrame, styles: RuleStyles) -> Iterator[Markup]:
    for zone in plan.zones:
        yield frame.rectangle(zone.area, f"zone {styles.of_zone(zone.name).css_class}")
    for obstacle in plan.obstacles:
        yield frame.rectangle(obstacle.footprint, obstacle.kind.value)


def _path(
    places: Sequence[PathPoint], frame: MapFrame, spans: Sequence[RuleSpan], styles: RuleStyles
) -> Iterator[Markup]:
    yield tag("polyline", class_="path-edge", points=frame.points(places))
    for piece in path_pieces(places, spans):
        look = styles.of(piece.block).css_class
        yield tag("polyline", class_=f"path {look}", points=frame.points(piece.points))
