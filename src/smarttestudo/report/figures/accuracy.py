# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Messages against accuracy, under bounds and at fixed rates."""

from __future__ import annotations

from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, NullLocator

from smarttestudo.report.accuracy_chart import Sent, accuracy_chart
from smarttestudo.report.axes import LogScale
from smarttestudo.report.figures.styles import AFTER, BEFORE, plain
from smarttestudo.report.run_report import RunReport

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
