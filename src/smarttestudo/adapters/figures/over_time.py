# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rates and bandwidth over time: topic by topic, and all together against a budget."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import accumulate

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke

from smarttestudo.adapters.figures.styles import (
    AFTER,
    AREAS,
    BEFORE,
    BUDGET,
    INK,
    LineLook,
    label_time,
    plain,
)
from smarttestudo.visualizer.report import RunReport, TopicHistory, TopicSeries
from smarttestudo.visualizer.report.bandwidth_chart import Layer, layers
from smarttestudo.visualizer.report.run_report import charted_series
from smarttestudo.visualizer.series import Series
from smarttestudo.visualizer.summary import bandwidth_text

_WIDTH_IN = 7.2
_COLUMNS = 3
_ROW_IN = 1.45
_MARGIN_IN = 0.75
_HEADROOM = 1.12

SeriesOf = Callable[[TopicHistory], Series]


def rates_figure(report: RunReport) -> Figure | None:
    """The rate of each topic, one recording over the other."""
    return _by_topic(report, lambda history: history.rate_hz, "Rate in Hz")


def bandwidth_figure(report: RunReport) -> Figure | None:
    """The bandwidth of each topic, one recording over the other."""
    return _by_topic(report, lambda history: history.kb_per_s, "Bandwidth in KB/s")


def total_figure(report: RunReport) -> Figure | None:
    """All topics stacked in each recording, each to its own scale, against the budget if there is one."""
    stacks = [(report.names.before, layers(report, of_second=False))]
    if report.is_pair:
        stacks.append((report.names.after, layers(report, of_second=True)))
    if not any(layer.points for _, stack in stacks for layer in stack):
        return None
    figure = Figure(figsize=(_WIDTH_IN, 2.6 * len(stacks)), layout="constrained")
    grid = figure.subplots(len(stacks), 1, squeeze=False, sharex=True)
    for axes, (name, stack) in zip(grid[:, 0], stacks, strict=True):
        _stack(axes, stack, report)
        axes.set_title(plain(name) if report.is_pair else "All topics")
        axes.set_ylabel("Bandwidth in KB/s")
        axes.yaxis.set_major_formatter("{x:,.6g}")
    label_time(grid[-1, 0])
    return figure


def _by_topic(report: RunReport, series_of: SeriesOf, label: str) -> Figure | None:
    shown = [one for one in charted_series(report) if series_of(one.before) or series_of(one.after)]
    if not shown:
        return None
    rows = -(-len(shown) // _COLUMNS)
    figure = Figure(figsize=(_WIDTH_IN, rows * _ROW_IN + _MARGIN_IN), layout="constrained")
    grid = figure.subplots(rows, min(_COLUMNS, len(shown)), squeeze=False, sharex=True)
    for axes, one in zip(grid.flat, shown, strict=False):
        _lines(axes, one, series_of)
        axes.set_xlim(0, max(report.duration_s, 1e-3))
    for axes in grid.flat[len(shown) :]:
        axes.set_axis_off()
    figure.supxlabel("Time in s", fontsize=8)
    figure.supylabel(label, fontsize=8)
    if report.is_pair:
        figure.legend(handles=list(_run_handles(report)), loc="outside upper right", ncols=2)
    return figure


def _lines(axes: Axes, one: TopicSeries, series_of: SeriesOf) -> None:
    axes.set_title(plain(one.topic), fontsize=7)
    highest = 0.0
    for history, look in ((one.before, BEFORE), (one.after, AFTER)):
        points = series_of(history)
        times_s = [point.t_s for point in points]
        lowest, top = [point.lowest for point in points], [point.highest for point in points]
        highest = max(highest, *top, 0.0) if top else highest
        if lowest != top:
            axes.fill_between(times_s, lowest, top, color=look.colour, alpha=0.35, linewidth=0)
        axes.plot(times_s, top, color=look.colour, linestyle=look.dash, linewidth=look.width)
    axes.set_ylim(0, highest * _HEADROOM or 1.0)


def _stack(axes: Axes, stack: Sequence[Layer], report: RunReport) -> None:
    times_s = [point.t_s for point in stack[0].points] if stack else []
    means = [[point.mean for point in layer.points] for layer in stack]
    sums = list(
        accumulate(means, lambda below, own: [low + mean for low, mean in zip(below, own, strict=True)])
    )
    foots = [[0.0] * len(times_s), *sums]
    for layer, look, foot, top in zip(stack, AREAS, foots, sums, strict=False):
        axes.fill_between(
            times_s,
            foot,
            top,
            facecolor=look.colour,
            hatch=look.hatch,
            edgecolor=INK,
            linewidth=0.3,
            label=f"{plain(layer.name)}  {bandwidth_text(layer.mean_kb_per_s)}",
        )
    if report.budget_kb_per_s is not None:
        axes.axhline(
            report.budget_kb_per_s,
            color=BUDGET.colour,
            linestyle=BUDGET.dash,
            linewidth=BUDGET.width,
            path_effects=[withStroke(linewidth=3 * BUDGET.width, foreground="white")],
            label=f"budget  {bandwidth_text(report.budget_kb_per_s)}",
        )
    axes.set_xlim(0, max(report.duration_s, 1e-3))
    axes.set_ylim(bottom=0)
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), fontsize=7, reverse=True)


def _run_handles(report: RunReport) -> Iterator[Line2D]:
    for name, look in ((report.names.before, BEFORE), (report.names.after, AFTER)):
        yield _handle(plain(name), look)


def _handle(name: str, look: LineLook) -> Line2D:
    return Line2D([], [], color=look.colour, linestyle=look.dash, linewidth=look.width, label=name)
