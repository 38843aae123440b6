# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The robot's path over the floor, in the style of the deciding rules."""

from __future__ import annotations

from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle as Patch
from matplotlib.patheffects import withStroke
from matplotlib.transforms import Affine2D

from smarttestudo.domain.floor_plan import FloorZone, ObstacleKind, OccupancyMap, Rectangle
from smarttestudo.report.figures.styles import FAINT, INK, handle, plain, rule_line
from smarttestudo.report.floor_map import FloorMap, floor_map
from smarttestudo.report.rule_timeline import RuleStyle, deciding_spans, styles_of
from smarttestudo.report.run_report import RunReport
from smarttestudo.report.styles import ON_PAPER

_WIDTH_IN = 5.6
_TALLEST_IN = 7.5
_OBSTACLES = {
    ObstacleKind.WALL: ON_PAPER["wall"],
    ObstacleKind.UPRIGHT: ON_PAPER["wall"],
    ObstacleKind.RACK: ON_PAPER["rack"],
}


def path_figure(report: RunReport) -> Figure | None:
    """The path over the floor plan; ``None`` where no place of the robot is known."""
    styles = styles_of(report.decisions, report.duration_s)
    spans = deciding_spans(report.decisions, report.duration_s)
    floor = floor_map(report.floor_plan, report.path, spans, styles, incident=report.incident)
    if floor is None or not floor.known:
        return None
    figure, axes = _floor_figure(floor)
    _draw_path(axes, floor)
    first, last = floor.known[0], floor.known[-1]
    ends = [
        *axes.plot(first.x_m, first.y_m, "o", color="white", markeredgecolor=INK, label="start"),
        *axes.plot(last.x_m, last.y_m, "s", color=INK, markersize=5, label="end"),
    ]
    if floor.happened is not None:
        name, at = plain(floor.happened.name), floor.happened.point
        ends += axes.plot(at.x_m, at.y_m, "D", color=INK, markeredgecolor="white", label=name)
    shown = {style for _, style in floor.pieces} if spans else set()
    rules = [handle(style.name, rule_line(style)) for style in styles.all if style in shown]
    axes.legend(handles=[*rules, *ends], loc="upper left", bbox_to_anchor=(1.0, 1.0), fontsize=7)
    return figure


def zones_figure(report: RunReport) -> Figure | None:
    """The zones of the rules on the floor plan; ``None`` where there is neither."""
    styles = styles_of(report.decisions, report.duration_s)
    floor = floor_map(report.floor_plan, report.path, (), styles)
    return None if floor is None else _floor_figure(floor)[0]


def _floor_figure(floor: FloorMap) -> tuple[Figure, Axes]:
    (left, right), (low, high) = floor.frame.x.values, floor.frame.y.values
    height_in = min(_WIDTH_IN * (high - low) / (right - left) + 0.5, _TALLEST_IN)
    figure = Figure(figsize=(_WIDTH_IN, height_in), layout="constrained")
    axes = figure.subplots()
    axes.set_xlim(left, right)
    axes.set_ylim(low, high)
    axes.set_aspect("equal")
    axes.set_xlabel("x in m")
    axes.set_ylabel("y in m")
    axes.grid(color=FAINT, linewidth=0.5)
    _draw_floor(axes, floor)
    return figure, axes


def _draw_floor(axes: Axes, floor: FloorMap) -> None:
    if floor.plan.occupancy is not None:
        _draw_occupancy(axes, floor.plan.occupancy)
    for zone, style in floor.zones:
        _draw_zone(axes, zone, style)
    for obstacle in floor.plan.obstacles:
        axes.add_patch(_patch(obstacle.footprint, color=_OBSTACLES[obstacle.kind], linewidth=0))


def _draw_zone(axes: Axes, zone: FloorZone, style: RuleStyle) -> None:
    colour = ON_PAPER[style.colour]
    area = _clipped(zone.area, axes)
    axes.add_patch(_patch(area, facecolor=colour, alpha=0.12, linewidth=0))
    axes.add_patch(_patch(area, fill=False, edgecolor=colour, linewidth=0.8, linestyle=":"))
    axes.annotate(
        plain(zone.name),
        (area.min_x_m, area.max_y_m),
        xytext=(4, -9),
        textcoords="offset points",
        fontsize=7,
        path_effects=[withStroke(linewidth=2, foreground="white")],
        zorder=5,
    )


def _patch(area: Rectangle, **style: Any) -> Patch:
    return Patch(
        (area.min_x_m, area.min_y_m), area.max_x_m - area.min_x_m, area.max_y_m - area.min_y_m, **style
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


def _draw_path(axes: Axes, floor: FloorMap) -> None:
    axes.plot(
        [place.x_m for place in floor.line], [place.y_m for place in floor.line], color="white", linewidth=4.5
    )
    for points, style in floor.pieces:
        drawn = rule_line(style)
        axes.plot(
            [point.x_m for point in points],
            [point.y_m for point in points],
            color=drawn.colour,
            linestyle=drawn.dash,
            linewidth=drawn.width,
            dash_capstyle="round",
        )


def _clipped(area: Rectangle, axes: Axes) -> Rectangle:
    """``area`` without what lies beyond the figure, which may be infinitely much."""
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    return Rectangle(
        min_x_m=max(area.min_x_m, left),
        max_x_m=min(area.max_x_m, right),
        min_y_m=max(area.min_y_m, low),
        max_y_m=min(area.max_y_m, high),
    )
