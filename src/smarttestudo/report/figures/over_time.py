# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rates and bandwidth over time: topic by topic, and all together against a budget."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke

from smarttestudo.bags.incident_mark import IncidentMark
from smarttestudo.report.axes import tick_label
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
from smarttestudo.report.run_report import RunReport
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
    rows = -(-len(shown) // _COLUMNS)
    figure = Figure(figsize=(_WIDTH_IN, rows * _ROW_IN + _MARGIN_IN), layout="constrained")
    grid = figure.subplots(rows, min(_COLUMNS, len(shown)), squeeze=False, sharex=True)
    for axes, chart in zip(grid.flat, shown, strict=False):
        _draw(axes, chart)
        axes.set_title(plain(chart.name), fontsize=7)
    for axes in grid.flat[len(shown) :]:
        axes.set_axis_off()
    figure.supxlabel("Time in s", fontsize=8)
    figure.supylabel(label, fontsize=8)
    if len(handles) > 1:
        figure.legend(handles=handles, loc="outside upper right", ncols=min(len(handles), 4), fontsize=7)
    return figure


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
