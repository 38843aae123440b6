# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The robot's path over the floor, in the look of the deciding rules."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle as Patch
from matplotlib.patheffects import withStroke
from matplotlib.transforms import Affine2D

from smarttestudo.adapters.figures.styles import FAINT, INK, RACK, WALL, plain, rule_look
from smarttestudo.domain.floor_plan import FloorPlan, ObstacleKind, OccupancyMap, Rectangle
from smarttestudo.visualizer.floor import PathPoint
from smarttestudo.visualizer.report import RunReport
from smarttestudo.visualizer.report.floor_map import known_places, path_pieces, thinned
from smarttestudo.visualizer.report.map_frame import map_frame
from smarttestudo.visualizer.report.rule_styles import RuleStyles, styles_of
from smarttestudo.visualizer.rule_timeline import RuleSpan, deciding_spans

_WIDTH_IN = 5.6
_TALLEST_IN = 7.5
_OBSTACLES = {ObstacleKind.WALL: WALL, ObstacleKind.UPRIGHT: WALL, ObstacleKind.RACK: RACK}


def path_figure(report: RunReport) -> Figure | None:
    """The path over the floor plan; ``None`` where no place of the robot is known."""
    places = known_places(report.path)
    plan = report.floor_plan or FloorPlan()
    frame = map_frame(plan, places)
    if frame is None or not places:
        return None
    (left, right), (low, high) = frame.x.values, frame.y.values
    height_in = min(_WIDTH_IN * (high - low) / (right - left) + 0.5, _TALLEST_IN)
    figure = Figure(figsize=(_WIDTH_IN, height_in), layout="constrained")
    axes = figure.subplots()
    axes.set_xlim(left, right)
    axes.set_ylim(low, high)
    axes.set_aspect("equal")
    axes.set_xlabel("x in m")
    axes.set_ylabel("y in m")
    styles = styles_of(report.decisions, report.duration_s)
    _draw_floor(axes, plan, styles)
    spans = deciding_spans(report.decisions, report.duration_s)
    _draw_path(axes, thinned(places), spans, styles)
    axes.plot(places[0].x_m, places[0].y_m, "o", color="white", markeredgecolor=INK, label="start")
    axes.plot(places[-1].x_m, places[-1].y_m, "s", color=INK, markersize=5, label="end")
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), fontsize=7)
    return figure


def _draw_floor(axes: Axes, plan: FloorPlan, styles: RuleStyles) -> None:
    if plan.occupancy is not None:
        _draw_occupancy(axes, plan.occupancy)
    for zone in plan.zones:
        look = rule_look(styles.of_zone(zone.name))
        area = _clipped(zone.area, axes)
        corner = (area.min_x_m, area.min_y_m)
        size = (area.max_x_m - area.min_x_m, area.max_y_m - area.min_y_m)
        axes.add_patch(Patch(corner, *size, facecolor=look.colour, alpha=0.12, linewidth=0))
        axes.add_patch(Patch(corner, *size, fill=False, edgecolor=look.colour, linewidth=0.8, linestyle=":"))
        axes.annotate(
            plain(zone.name),
            (area.min_x_m, area.max_y_m),
            xytext=(4, -9),
            textcoords="offset points",
            fontsize=7,
            path_effects=[withStroke(linewidth=2, foreground="white")],
            zorder=5,
        )
    for obstacle in plan.obstacles:
        area = obstacle.footprint
        width, height = area.max_x_m - area.min_x_m, area.max_y_m - area.min_y_m
        axes.add_patch(
            Patch((area.min_x_m, area.min_y_m), width, height, color=_OBSTACLES[obstacle.kind], linewidth=0)
        )


def _draw_occupancy(axes: Axes, occupancy: OccupancyMap) -> None:
    """The cells as an image, turned as the map is."""
    turned = (
        Affine2D()
        .scale(occupancy.cell_m)
        .rotate(occupancy.yaw_rad)
        .translate(occupancy.origin_x_m, occupancy.origin_y_m)
    )
    limits = axes.get_xlim(), axes.get_ylim()
    rows = [[0.35 if is_occupied else 1.0 for is_occupied in row] for row in occupancy.rows]
    width = max(map(len, occupancy.rows))
    image = axes.imshow(
        rows,
        cmap="gray",
        vmin=0,
        vmax=1,
        origin="lower",
        interpolation="nearest",
        extent=(0, width, 0, len(occupancy.rows)),
    )
    image.set_transform(turned + axes.transData)
    axes.set_xlim(*limits[0])
    axes.set_ylim(*limits[1])


def _draw_path(axes: Axes, line: Sequence[PathPoint], spans: Sequence[RuleSpan], styles: RuleStyles) -> None:
    xs_m, ys_m = [point.x_m for point in line], [point.y_m for point in line]
    axes.plot(xs_m, ys_m, color="white", linewidth=4.5)
    shown = set()
    for piece in path_pieces(line, spans):
        style = styles.of(piece.block)
        look = rule_look(style)
        shown.add(style)
        axes.add_line(
            Line2D(
                [point.x_m for point in piece.points],
                [point.y_m for point in piece.points],
                color=look.colour,
                linestyle=look.dash,
                linewidth=look.width,
            )
        )
    for style in styles.all:
        if spans and style in shown:
            look = rule_look(style)
            axes.plot(
                [], [], color=look.colour, linestyle=look.dash, linewidth=look.width, label=plain(style.name)
            )
    axes.grid(color=FAINT, linewidth=0.5)


def _clipped(area: Rectangle, axes: Axes) -> Rectangle:
    """``area`` without what lies beyond the figure, which may be infinitely much."""
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    return Rectangle(
        min_x_m=max(area.min_x_m, left),
        max_x_m=min(area.max_x_m, right),
        min_y_m=max(area.min_y_m, low),
        max_y_m=min(area.max_y_m, high),
    )
