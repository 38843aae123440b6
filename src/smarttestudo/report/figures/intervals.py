# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How often which time lay between two messages of a topic."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import LogLocator, NullLocator

from smarttestudo.bags.statistics import IntervalBin
from smarttestudo.report.figures.styles import INK, plain
from smarttestudo.report.run_report import RunReport, charted_series

_WIDTH_IN = 7.2
_COLUMNS = 3
_ROW_IN = 1.45
_MARGIN_IN = 0.75
_MS_PER_S = 1000.0
_HALF_A_DECADE = math.sqrt(10.0)
_WIDE = 50.0


@dataclass(frozen=True, slots=True, kw_only=True)
class _BarStyle:
    face: str
    edge: str
    width: float
    hatch: str


_BEFORE = _BarStyle(face="#b9c0ca", edge="#b9c0ca", width=0.3, hatch="")
_AFTER = _BarStyle(face="none", edge=INK, width=0.8, hatch="/////")


def intervals_figure(report: RunReport) -> Figure | None:
    """A histogram for each topic, over a logarithmic axis of the time between messages."""
    shown = [one for one in charted_series(report) if one.before.intervals or one.after.intervals]
    if not shown:
        return None
    rows = -(-len(shown) // _COLUMNS)
    figure = Figure(figsize=(_WIDTH_IN, rows * _ROW_IN + _MARGIN_IN), layout="constrained")
    grid = figure.subplots(rows, min(_COLUMNS, len(shown)), squeeze=False)
    for axes, one in zip(grid.flat, shown, strict=False):
        axes.set_title(plain(one.topic), fontsize=7)
        _bars(axes, one.before.intervals, _BEFORE)
        _bars(axes, one.after.intervals, _AFTER)
        _scale(axes)
    for axes in grid.flat[len(shown) :]:
        axes.set_axis_off()
    figure.supxlabel("Time between two messages in ms", fontsize=8)
    figure.supylabel("Share of all in %", fontsize=8)
    if report.is_pair:
        handles = [_handle(report.names.before, _BEFORE), _handle(report.names.after, _AFTER)]
        figure.legend(handles=handles, loc="outside upper right", ncols=2)
    return figure


def _bars(axes: Axes, bins: Sequence[IntervalBin], style: _BarStyle) -> None:
    count = sum(one.count for one in bins)
    axes.bar(
        [one.from_s * _MS_PER_S for one in bins],
        [100 * one.count / count for one in bins],
        width=[(one.to_s - one.from_s) * _MS_PER_S for one in bins],
        align="edge",
        facecolor=style.face,
        edgecolor=style.edge,
        linewidth=style.width,
        hatch=style.hatch,
    )


def _scale(axes: Axes) -> None:
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


def _handle(name: str, style: _BarStyle) -> Patch:
    return Patch(
        facecolor=style.face,
        edgecolor=style.edge,
        linewidth=style.width,
        hatch=style.hatch,
        label=plain(name),
    )
