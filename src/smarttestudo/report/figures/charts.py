# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Figures of topics: rates and bandwidth over time, times between messages, messages against accuracy."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.patheffects import withStroke
from matplotlib.ticker import FixedLocator, LogLocator, NullLocator

from smarttestudo.bags.incident_record import IncidentMark
from smarttestudo.bags.statistics import IntervalBin
from smarttestudo.report.accuracy_curve import Sent, accuracy_chart
from smarttestudo.report.axes import LogScale, tick_label
from smarttestudo.report.figures.styles import (
    AFTER,
    BEFORE,
    BUDGET,
    HATCHES,
    INCIDENT,
    INK,
    QUIET,
    TARGET,
    LineStyle,
    handle,
    plain,
    rule_line,
)
from smarttestudo.report.rule_timeline import DEFAULTS, styles_of
from smarttestudo.report.run_report import RunReport, charted_series
from smarttestudo.report.styles import ON_PAPER
from smarttestudo.report.summary import bandwidth_text
from smarttestudo.report.time_chart import (
    ChartLine,
    Run,
    TimeChart,
    bandwidth_charts,
    rate_charts,
    stacked_chart,
    stacked_tops,
)

_WIDTH_IN = 7.2
_COLUMNS = 3
_RATE_LABEL = "Rate in Hz"
_ROW_IN = 1.45
_TOPIC_IN = 3.2
_MARGIN_IN = 0.75
_STYLES = {Run.BEFORE: BEFORE, Run.AFTER: AFTER}
_STRIP_AT, _BELOW_STRIP = -0.04, 7.0
_GAP_WIDTH, _GAP_HEIGHT = 0.02, 0.015


def rates_figure(report: RunReport) -> Figure | None:
    """The rate of each topic, one recording over the other, with what was planned and which rule decided."""
    return _by_topic(rate_charts(report), _RATE_LABEL, _rate_handles(report))


def topic_rate_figures(report: RunReport) -> Iterator[tuple[str, Figure]]:
    """The contents of ``rates_figure`` as a figure of each topic, with its name."""
    handles = _rate_handles(report)
    for chart in rate_charts(report):
        if chart.is_empty:
            continue
        figure = Figure(figsize=(_WIDTH_IN, _TOPIC_IN), layout="constrained")
        axes = figure.subplots()
        _draw(axes, chart)
        axes.tick_params(axis="x", pad=2 * _BELOW_STRIP)
        axes.set_title(plain(chart.name))
        axes.set_xlabel("Time in s")
        axes.set_ylabel(_RATE_LABEL)
        figure.legend(handles=handles, loc="outside lower center", ncols=min(len(handles), 5), fontsize=7)
        yield chart.name, figure


def _rate_handles(report: RunReport) -> list[Artist]:
    handles = list(_run_handles(report))
    if report.decisions:
        styles = styles_of(report.decisions, report.duration_s).all
        handles += [handle("Target", TARGET), *(handle(style.name, rule_line(style)) for style in styles)]
    return handles


def bandwidth_figure(report: RunReport) -> Figure | None:
    """The bandwidth of each topic, one recording over the other."""
    return _by_topic(bandwidth_charts(report), "Bandwidth in KB/s", list(_run_handles(report)))


def total_figure(report: RunReport) -> Figure | None:
    """All topics stacked in each recording, each to its own scale, against the budget if there is one."""
    charts = [stacked_chart(report, run) for run in (Run if report.is_pair else (Run.BEFORE,))]
    if all(chart.is_empty for chart in charts):
        return None
    figure = Figure(figsize=(_WIDTH_IN, 2.6 * len(charts)), layout="constrained")
    grid = figure.subplots(len(charts), 1, squeeze=False, sharex=True)
    for axes, chart in zip(grid[:, 0], charts, strict=True):
        _draw(axes, chart)
        axes.set_title(plain(chart.name) if report.is_pair else "All topics")
        axes.set_ylabel("Bandwidth in KB/s")
        axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), fontsize=7, reverse=True)
    grid[-1, 0].set_xlabel("Time in s")
    return figure


def _by_topic(charts: Sequence[TimeChart], label: str, handles: Sequence[Artist]) -> Figure | None:
    shown = [chart for chart in charts if not chart.is_empty]
    if not shown:
        return None
    figure, grid = _grid([chart.name for chart in shown], "Time in s", label, shares_x=True)
    for axes, chart in zip(grid, shown, strict=True):
        _draw(axes, chart)
    if len(handles) > 1:
        figure.legend(handles=handles, loc="outside upper right", ncols=min(len(handles), 4), fontsize=7)
    return figure


def _grid(
    names: Sequence[str], x_label: str, y_label: str, *, shares_x: bool
) -> tuple[Figure, Sequence[Axes]]:
    """A figure with a small chart of each name."""
    rows = -(-len(names) // _COLUMNS)
    figure = Figure(figsize=(_WIDTH_IN, rows * _ROW_IN + _MARGIN_IN), layout="constrained")
    grid = figure.subplots(rows, min(_COLUMNS, len(names)), squeeze=False, sharex=shares_x)
    for axes, name in zip(grid.flat, names, strict=False):
        axes.set_title(plain(name), fontsize=7)
    for axes in grid.flat[len(names) :]:
        axes.set_axis_off()
    figure.supxlabel(x_label, fontsize=8)
    figure.supylabel(y_label, fontsize=8)
    return figure, [*grid.flat[: len(names)]]


def _draw(axes: Axes, chart: TimeChart) -> None:
    if chart.tints:
        _tints(axes, chart)
        axes.tick_params(axis="x", pad=_BELOW_STRIP)
    for line in chart.lines:
        _line(axes, chart, line)
    targets = [span for span in chart.targets if not span.rate.is_full]
    axes.hlines(
        [chart.heights(span.rate.hz) for span in targets],
        [span.start_s for span in targets],
        [span.end_s for span in targets],
        colors=TARGET.colour,
        linewidth=TARGET.width,
    )
    _layers(axes, chart)
    if chart.budget is not None:
        _budget(axes, chart, chart.budget)
    if chart.incident is not None:
        _incident(axes, chart.incident)
    axes.set_xlim(0, chart.duration_s)
    axes.set_ylim(0, chart.top)
    axes.set_yticks(
        [chart.heights(value) for value in chart.ticks], labels=[tick_label(value) for value in chart.ticks]
    )
    if chart.gap is not None:
        _gap(axes, chart.gap / chart.top)


def _tints(axes: Axes, chart: TimeChart) -> None:
    """A tint behind the chart and a line under it, in the style of the block that decided the topic."""
    for style in {span.style: None for span in chart.tints}:
        own = [span for span in chart.tints if span.style == style]
        drawn = rule_line(style)
        if style != DEFAULTS:
            stretches = [(span.start_s, span.end_s - span.start_s) for span in own]
            axes.broken_barh(stretches, (0, chart.top), facecolor=drawn.colour, alpha=0.1, linewidth=0)
        axes.hlines(
            [_STRIP_AT] * len(own),
            [span.start_s for span in own],
            [span.end_s for span in own],
            colors=drawn.colour,
            linestyles=drawn.dash,
            linewidth=drawn.width,
            transform=axes.get_xaxis_transform(),
            clip_on=False,
        )


def _line(axes: Axes, chart: TimeChart, line: ChartLine) -> None:
    style = _STYLES[line.run]
    times_s = [point.t_s for point in line.points]
    top = [chart.heights(point.highest) for point in line.points]
    if line.is_band:
        lowest = [chart.heights(point.lowest) for point in line.points]
        axes.fill_between(times_s, lowest, top, color=style.colour, alpha=0.35, linewidth=0)
    axes.plot(times_s, top, color=style.colour, linestyle=style.dash, linewidth=style.width)


def _layers(axes: Axes, chart: TimeChart) -> None:
    foot: Sequence[float] | float = 0.0
    tops = stacked_tops([layer.points for layer in chart.layers])
    for index, (layer, top) in enumerate(zip(chart.layers, tops, strict=True)):
        axes.fill_between(
            [point.t_s for point in layer.points],
            foot,
            top,
            facecolor=ON_PAPER[f"share-{index + 1}"],
            hatch=HATCHES[index],
            edgecolor=INK,
            linewidth=0.3,
            label=f"{plain(layer.name)}  {bandwidth_text(layer.mean_kb_per_s)}",
        )
        foot = top


def _budget(axes: Axes, chart: TimeChart, budget_kb_per_s: float) -> None:
    axes.axhline(
        chart.heights(budget_kb_per_s),
        color=BUDGET.colour,
        linestyle=BUDGET.dash,
        linewidth=BUDGET.width,
        path_effects=[withStroke(linewidth=3 * BUDGET.width, foreground="white")],
        label=f"budget  {bandwidth_text(budget_kb_per_s)}",
    )


def _incident(axes: Axes, mark: IncidentMark) -> None:
    axes.axvline(
        mark.at_s,
        color=INCIDENT.colour,
        linestyle=INCIDENT.dash,
        linewidth=INCIDENT.width,
        path_effects=[withStroke(linewidth=3 * INCIDENT.width, foreground="white")],
        label=plain(mark.name),
    )


def _gap(axes: Axes, at: float) -> None:
    """Two short strokes on the axis of values, where it leaves some out."""
    for place in (at - _GAP_HEIGHT, at + _GAP_HEIGHT):
        axes.plot(
            [-_GAP_WIDTH, _GAP_WIDTH],
            [place - _GAP_HEIGHT, place + _GAP_HEIGHT],
            color=QUIET,
            linewidth=0.8,
            transform=axes.transAxes,
            clip_on=False,
        )


def _run_handles(report: RunReport) -> Iterator[Artist]:
    names: tuple[tuple[str, LineStyle], ...] = ((report.names.before, BEFORE), (report.names.after, AFTER))
    for name, style in names if report.is_pair else names[:1]:
        yield handle(name, style)
    if report.incident is not None:
        yield handle(report.incident.name, INCIDENT)


_MS_PER_S = 1000.0
_HALF_A_DECADE = math.sqrt(10.0)
_WIDE = 50.0


_BEFORE_BARS: Mapping[str, Any] = {"facecolor": "#b9c0ca", "edgecolor": "#b9c0ca", "linewidth": 0.3}
_AFTER_BARS: Mapping[str, Any] = {"facecolor": "none", "edgecolor": INK, "linewidth": 0.8, "hatch": "/////"}


def intervals_figure(report: RunReport) -> Figure | None:
    """A histogram for each topic, over a logarithmic axis of the time between messages."""
    shown = [
        topic_series
        for topic_series in charted_series(report)
        if topic_series.before.intervals or topic_series.after.intervals
    ]
    if not shown:
        return None
    names = [topic_series.topic for topic_series in shown]
    figure, grid = _grid(names, "Time between two messages in ms", "Share of all in %", shares_x=False)
    for axes, topic_series in zip(grid, shown, strict=True):
        _bars(axes, topic_series.before.intervals, _BEFORE_BARS)
        _bars(axes, topic_series.after.intervals, _AFTER_BARS)
        _scale_intervals(axes)
    if report.is_pair:
        before = Patch(label=plain(report.names.before), **_BEFORE_BARS)
        after = Patch(label=plain(report.names.after), **_AFTER_BARS)
        figure.legend(handles=[before, after], loc="outside upper right", ncols=2)
    return figure


def _bars(axes: Axes, bins: Sequence[IntervalBin], style: Mapping[str, Any]) -> None:
    count = sum(bin_.count for bin_ in bins)
    axes.bar(
        [bin_.from_s * _MS_PER_S for bin_ in bins],
        [100 * bin_.count / count for bin_ in bins],
        width=[(bin_.to_s - bin_.from_s) * _MS_PER_S for bin_ in bins],
        align="edge",
        **style,
    )


def _scale_intervals(axes: Axes) -> None:
    """A logarithmic axis of at least a decade, with few labels."""
    axes.set_xscale("log")
    low, high = axes.get_xlim()
    middle = math.sqrt(low * high)
    low, high = min(low, middle / _HALF_A_DECADE), max(high, middle * _HALF_A_DECADE)
    axes.set_xlim(low, high)
    is_wide = high / low > _WIDE
    axes.xaxis.set_major_locator(LogLocator(subs=(1.0,) if is_wide else (1.0, 2.0, 5.0)))
    axes.xaxis.set_major_formatter("{x:g}")
    axes.xaxis.set_minor_locator(NullLocator())


_SIZE_IN = (7.2, 2.6)
_RECKONED = (0, (3.0, 2.0))
_MARK = 3.0
_SAMPLE_LENGTH = 5.0


def accuracy_figure(report: RunReport) -> Figure | None:
    """The worst error of the robot's position over the messages that it takes, on logarithmic axes."""
    chart = None if report.accuracy_curve is None else accuracy_chart(report.accuracy_curve)
    if chart is None:
        return None
    figure = Figure(figsize=_SIZE_IN, layout="constrained")
    axes = figure.subplots()
    axes.set_title(plain(chart.name))
    for line in chart.lines:
        style = AFTER if line.sent is Sent.WITHIN else BEFORE
        axes.plot(
            [messages for messages, _ in line.points],
            [error for _, error in line.points],
            color=style.colour,
            linewidth=style.width,
            linestyle=_RECKONED if line.reckons else style.dash,
            marker="o",
            markersize=_MARK,
            label=line.name,
        )
    axes.set_xscale("log")
    axes.set_yscale("log")
    _scale(axes.xaxis, chart.messages)
    _scale(axes.yaxis, chart.errors)
    axes.set_xlim(chart.messages.low, chart.messages.high)
    axes.set_ylim(chart.errors.low, chart.errors.high)
    axes.set_xlabel("Messages")
    axes.set_ylabel(f"Worst error in {plain(chart.unit)}" if chart.unit else "Worst error")
    axes.legend(fontsize=7, handlelength=_SAMPLE_LENGTH)
    return figure


def _scale(axis: Axis, scale: LogScale) -> None:
    axis.set_major_locator(FixedLocator(scale.ticks))
    axis.set_major_formatter("{x:g}")
    axis.set_minor_locator(NullLocator())
