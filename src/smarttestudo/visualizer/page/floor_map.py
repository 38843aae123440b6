# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The floor plan with the robot's path in the colours of the deciding blocks."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from smarttestudo.visualizer.page.markup import Markup, coordinate, tag
from smarttestudo.visualizer.page.page_input import FloorPlan, PathPoint, Rectangle
from smarttestudo.visualizer.page.path_line import known_places, path_pieces, thinned
from smarttestudo.visualizer.page.rule_styles import RuleStyles
from smarttestudo.visualizer.page.scale import Scale, label, linear, multiples, round_step
from smarttestudo.visualizer.rule_timeline import RuleSpan

_WIDTH = 600.0
_TALLEST = 690.0
_LEFT, _RIGHT, _TOP, _BOTTOM = 40.0, 8.0, 8.0, 38.0
_LEAST_SPAN_M = 2.0
_GRID_LINES = 8
_TIME_LABELS = 5
_LABEL_SPACE = 30.0


@dataclass(frozen=True, slots=True, kw_only=True)
class _Frame:
    """Metres to places in the picture; one metre is as long in x as in y."""

    x: Scale
    y: Scale
    width: float
    height: float

    def rectangle(self, area: Rectangle, css_class: str) -> Markup:
        left, right = self.x(area.min_x_m), self.x(area.max_x_m)
        top, bottom = self.y(area.max_y_m), self.y(area.min_y_m)
        return tag("rect", class_=css_class, x=left, y=top, width=right - left, height=bottom - top)


def floor_map(
    plan: FloorPlan | None, path: Sequence[PathPoint], spans: Sequence[RuleSpan], styles: RuleStyles
) -> Markup | None:
    """The map as an SVG element; ``None`` where there is neither a floor plan nor a known place."""
    plan = plan or FloorPlan()
    places = thinned(known_places(path))
    bounds = _bounds(plan, places)
    if bounds is None:
        return None
    frame = _frame(bounds)
    return tag(
        "svg",
        *_grid(frame),
        *_floor(plan, frame, styles),
        *_path(places, frame, spans, styles),
        *_zone_names(plan, frame),
        *_markers(places, frame),
        class_="map",
        viewBox=f"0 0 {coordinate(frame.width)} {coordinate(frame.height)}",
        role="img",
        aria_label="Floor plan with the robot's path, coloured by deciding rule",
    )


def _bounds(plan: FloorPlan, places: Sequence[PathPoint]) -> Rectangle | None:
    """What the map must show, with a margin; at least 2 m each way."""
    areas = [*(one.footprint for one in plan.obstacles), *(zone.area for zone in plan.zones)]
    xs = [x_m for area in areas for x_m in (area.min_x_m, area.max_x_m)] + [one.x_m for one in places]
    ys = [y_m for area in areas for y_m in (area.min_y_m, area.max_y_m)] + [one.y_m for one in places]
    if not xs:
        return None
    margin_m = 0.02 * max(max(xs) - min(xs), max(ys) - min(ys), _LEAST_SPAN_M)
    more_x_m = margin_m + max(0.0, _LEAST_SPAN_M - (max(xs) - min(xs))) / 2
    more_y_m = margin_m + max(0.0, _LEAST_SPAN_M - (max(ys) - min(ys))) / 2
    return Rectangle(
        min_x_m=min(xs) - more_x_m,
        max_x_m=max(xs) + more_x_m,
        min_y_m=min(ys) - more_y_m,
        max_y_m=max(ys) + more_y_m,
    )


def _frame(bounds: Rectangle) -> _Frame:
    span_x_m, span_y_m = bounds.max_x_m - bounds.min_x_m, bounds.max_y_m - bounds.min_y_m
    per_m = min((_WIDTH - _LEFT - _RIGHT) / span_x_m, (_TALLEST - _TOP - _BOTTOM) / span_y_m)
    right, bottom = _LEFT + per_m * span_x_m, _TOP + per_m * span_y_m
    return _Frame(
        x=linear((bounds.min_x_m, bounds.max_x_m), (_LEFT, right)),
        y=linear((bounds.min_y_m, bounds.max_y_m), (bottom, _TOP)),
        width=right + _RIGHT,
        height=bottom + _BOTTOM,
    )


def _grid(frame: _Frame) -> Iterator[Markup]:
    """Lines at round metres, labelled, with the axes' titles."""
    (left, right), (bottom, top) = frame.x.places, frame.y.places
    (min_x_m, max_x_m), (min_y_m, max_y_m) = frame.x.values, frame.y.values
    step_m = round_step(max(max_x_m - min_x_m, max_y_m - min_y_m) / _GRID_LINES)
    for x_m in multiples(step_m, min_x_m, max_x_m):
        at = frame.x(x_m)
        yield tag("line", class_="grid", x1=at, x2=at, y1=top, y2=bottom)
        yield tag("text", label(x_m), class_="tick", x=at, y=bottom + 15, text_anchor="middle")
    for y_m in multiples(step_m, min_y_m, max_y_m):
        at = frame.y(y_m)
        yield tag("line", class_="grid", x1=left, x2=right, y1=at, y2=at)
        yield tag("text", label(y_m), class_="tick", x=left - 6, y=at + 3.5, text_anchor="end")
    yield tag("text", "x in m", class_="axis", x=right, y=bottom + 31, text_anchor="end")
    turned = f"translate(12 {coordinate(top)}) rotate(-90)"
    yield tag("text", "y in m", class_="axis", transform=turned, text_anchor="end")


def _floor(plan: FloorPlan, frame: _Frame, styles: RuleStyles) -> Iterator[Markup]:
    for zone in plan.zones:
        yield frame.rectangle(zone.area, f"zone {styles.of_zone(zone.name).css_class}")
    for obstacle in plan.obstacles:
        yield frame.rectangle(obstacle.footprint, obstacle.kind.value)


def _zone_names(plan: FloorPlan, frame: _Frame) -> Iterator[Markup]:
    for zone in plan.zones:
        x, y = frame.x(zone.area.min_x_m) + 8, frame.y(zone.area.max_y_m) + 17
        yield tag("text", zone.name, class_="zone-name", x=x, y=y)


def _path(
    places: Sequence[PathPoint], frame: _Frame, spans: Sequence[RuleSpan], styles: RuleStyles
) -> Iterator[Markup]:
    for piece in path_pieces(places, spans):
        points = " ".join(f"{coordinate(frame.x(p.x_m))},{coordinate(frame.y(p.y_m))}" for p in piece.points)
        style = styles.of(piece.block)
        yield tag("polyline", class_="path-edge", points=points)
        yield tag("polyline", class_=f"path {style.css_class}", points=points)


def _markers(places: Sequence[PathPoint], frame: _Frame) -> Iterator[Markup]:
    """Start, end, and the time at round seconds in between where there is room for it."""
    if not places:
        return
    first, last = places[0], places[-1]
    taken = [(frame.x(one.x_m), frame.y(one.y_m)) for one in (first, last)]
    for point in _at_round_times(places):
        x, y = frame.x(point.x_m), frame.y(point.y_m)
        if any(abs(x - other_x) + abs(y - other_y) < _LABEL_SPACE for other_x, other_y in taken):
            continue
        taken.append((x, y))
        yield tag("circle", class_="passing", cx=x, cy=y, r=3.0)
        yield tag("text", f"{label(round(point.t_s))} s", class_="passing-time", x=x + 7, y=y - 6)
    (first_x, first_y), (last_x, last_y) = taken[:2]
    yield tag("circle", class_="start", cx=first_x, cy=first_y, r=6.0)
    yield tag("text", "Start", class_="marker-name", x=first_x + 11, y=first_y + 4)
    yield tag("rect", class_="end", x=last_x - 5, y=last_y - 5, width=10.0, height=10.0)
    below = 16 if abs(first_x - last_x) + abs(first_y - last_y) < _LABEL_SPACE and last_y >= first_y else 0
    yield tag("text", "End", class_="marker-name", x=last_x + 11, y=last_y + 4 + below)


def _at_round_times(places: Sequence[PathPoint]) -> Iterator[PathPoint]:
    """The first place at or after each round time."""
    duration_s = places[-1].t_s - places[0].t_s
    if duration_s <= 0:
        return
    step_s = round_step(duration_s / _TIME_LABELS)
    due_s = step_s * math.ceil(places[0].t_s / step_s)
    for point in places:
        if point.t_s >= due_s:
            yield point
            due_s = step_s * (math.floor(point.t_s / step_s) + 1)
