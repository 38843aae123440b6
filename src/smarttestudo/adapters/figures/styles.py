# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Colours, lines and hatches that differ in grey too."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

from matplotlib.axes import Axes

from smarttestudo.visualizer.report.rule_styles import DEFAULTS, OTHERS, RuleStyle

INK, QUIET, FAINT, WALL, RACK = "#1d2430", "#5d6878", "#e6e8ec", "#525c6b", "#c9cfd8"
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

Dash = Literal["-"] | tuple[int, tuple[int, ...]]


@dataclass(frozen=True, slots=True, kw_only=True)
class LineLook:
    """How a line is told from others, on a screen and in grey."""

    colour: str
    dash: Dash
    width: float


@dataclass(frozen=True, slots=True, kw_only=True)
class AreaLook:
    """How an area is told from others."""

    colour: str
    hatch: str


BEFORE = LineLook(colour="#8a93a0", dash=(0, (4, 1)), width=1.1)
AFTER = LineLook(colour=INK, dash="-", width=1.1)
BUDGET = LineLook(colour="#c2410c", dash=(0, (6, 2, 1, 2)), width=1.2)

AREAS = (
    AreaLook(colour="#2f5d82", hatch=""),
    AreaLook(colour="#9cc3dd", hatch="///"),
    AreaLook(colour="#e8d9a0", hatch=""),
    AreaLook(colour="#e2a36b", hatch="\\\\\\"),
    AreaLook(colour="#f3e3d3", hatch="..."),
    AreaLook(colour="#b96a5a", hatch="xxx"),
    AreaLook(colour="#e6e8ec", hatch=""),
)

_LABEL_CHARACTERS = 60
_RULES = (
    LineLook(colour="#0a66b0", dash="-", width=2.6),
    LineLook(colour="#e08a00", dash=(0, (5, 1)), width=2.6),
    LineLook(colour="#00785c", dash=(0, (1, 1)), width=2.6),
    LineLook(colour="#c25b9b", dash=(0, (5, 1, 1, 1)), width=2.6),
    LineLook(colour="#4aa8de", dash=(0, (3, 1)), width=2.6),
    LineLook(colour="#c2410c", dash=(0, (5, 1, 1, 1, 1, 1)), width=2.6),
)
_DEFAULTS = LineLook(colour="#8b95a4", dash="-", width=1.3)
_OTHERS = LineLook(colour=QUIET, dash=(0, (1, 3)), width=2.6)


def rule_look(style: RuleStyle) -> LineLook:
    """The look of a rule's line, in the colour that it has in the report."""
    if style == DEFAULTS:
        return _DEFAULTS
    if style == OTHERS:
        return _OTHERS
    return _RULES[int(style.css_class.rpartition("-")[2]) - 1]


def plain(text: str) -> str:
    """``text`` for a label, in which a dollar sign does not begin a formula; the middle of a long one is cut.

    A figure grows with its widest label, and its memory with its area.
    """
    if len(text) > _LABEL_CHARACTERS:
        half = _LABEL_CHARACTERS // 2
        text = f"{text[:half]}…{text[-half:]}"
    return text.replace("$", r"\$")


def label_time(axes: Axes) -> None:
    """Write what the horizontal axis is."""
    axes.set_xlabel("Time in s")
