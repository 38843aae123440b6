# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Figures of recordings as files."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path

from smarttestudo.adapters.figures import FigureKind, draw_figures
from smarttestudo.composition.bag_report import ReportRequest, bag_courses
from smarttestudo.visualizer.report import RunReport

RATES = frozenset({FigureKind.RATES, FigureKind.INTERVALS})
BANDWIDTH = frozenset({FigureKind.BANDWIDTH, FigureKind.TOTAL})
EVERYTHING = frozenset(FigureKind)


def draw_courses(request: ReportRequest, kinds: Collection[FigureKind], folder: Path) -> list[Path]:
    """Measure the recordings, without their payloads, and draw what came when.

    Raises:
        RecordingError: one cannot be read or is empty, or they share no topic.
        OutputFileError: a figure cannot be written.
    """
    return draw_figures(bag_courses(request), kinds, folder)


def draw_report(report: RunReport, folder: Path) -> list[Path]:
    """Draw everything that ``report`` shows over time or on the floor. Raises ``OutputFileError``."""
    return draw_figures(report, EVERYTHING, folder)
