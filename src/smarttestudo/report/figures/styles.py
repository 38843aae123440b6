# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Colours, lines and hatches that differ in grey too."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

from matplotlib.lines import Line2D

from smarttestudo.report.rule_timeline import DEFAULTS, RuleStyle
from smarttestudo.report.styles import BUDGET_DASH, DASHES, DEFAULTS_WIDTH, ON_PAPER, PATH_WIDTH

INK, QUIET, FAINT = ON_PAPER["ink"], ON_PAPER["quiet"], ON_PAPER["faint"]
SETTINGS: dict[Any, Any] = {
    "font.family": "DejaVu Sans",
    "font.size": 8.0,
    "axes.titlesize": 8.0,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.edgecolor": QUIET,
    "axes.labelcolor": INK,
    "axes.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": FAINT,
    "grid.linewidth": 0.6,
    "xtick.color": QUIET,
    "ytick.color": QUIET,
    "xtick.major.size": 0.0,
    "ytick.major.size": 0.0,
    "legend.frameon": False,
    "hatch.linewidth": 0.6,
    "figure.facecolor": "white",
    # Ids of shapes are drawn from this, and so are the same each time.
    "svg.hashsalt": "smarttestudo",
}

Dash = Literal["-"] | tuple[int, tuple[float, ...]]


@dataclass(frozen=True, slots=True, kw_only=True)
class LineStyle:
    """How a line is told from others, on a screen and in grey."""

    colour: str
    dash: Dash
    width: float


BEFORE = LineStyle(colour=ON_PAPER["before"], dash="-", width=1.1)
AFTER = LineStyle(colour=INK, dash="-", width=1.1)
TARGET = LineStyle(colour="#0003", dash="-", width=4.0)
_PER_PX = 0.65
BUDGET = LineStyle(colour=INK, dash=(0, BUDGET_DASH), width=1.2)
INCIDENT = LineStyle(colour=INK, dash=(0, (2.5, 1.3)), width=1.2)
HATCHES = ("", "///", "", "\\\\\\", "...", "xxx", "")
"""Of the layers of a stack, from its foot on."""
_LABEL_CHARACTERS = 60


def rule_line(style: RuleStyle) -> LineStyle:
    """The style of a rule's line, as it is in the report."""
    dash = tuple(length / PATH_WIDTH for length in DASHES.get(style.colour, ()))
    width = DEFAULTS_WIDTH if style == DEFAULTS else PATH_WIDTH
    return LineStyle(colour=ON_PAPER[style.colour], dash=(0, dash) if dash else "-", width=_PER_PX * width)


def handle(name: str, style: LineStyle) -> Line2D:
    """The entry of a line in a legend."""
    return Line2D(
        [],
        [],
        color=style.colour,
        linestyle=style.dash,
        linewidth=style.width,
        dash_capstyle="round",
        label=plain(name),
    )


def plain(text: str) -> str:
    """``text`` for a label, in which a dollar sign does not begin a formula; the middle of a long one is cut.

    A figure grows with its widest label, and its memory with its area.
    """
    if len(text) > _LABEL_CHARACTERS:
        half = _LABEL_CHARACTERS // 2
        text = f"{text[:half]}…{text[-half:]}"
    return text.replace("$", r"\$")
