# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Figures of a run as files, the same bytes for the same run."""

from __future__ import annotations

import io
from collections.abc import Callable, Collection, Iterator, Mapping
from itertools import chain
from pathlib import Path

from matplotlib import rc_context
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from smarttestudo.files.whole_file import not_written, whole_binary_file
from smarttestudo.report.figures.charts import (
    accuracy_figure,
    bandwidth_figure,
    intervals_figure,
    rates_figure,
    topic_rate_figures,
    total_figure,
)
from smarttestudo.report.figures.path import path_figure, zones_figure
from smarttestudo.report.figures.styles import SETTINGS
from smarttestudo.report.run_report import FigureKind, RunReport

_DPI = 200
# Neither format may hold a date or a version, which would make each run's bytes differ.
_METADATA: Mapping[str, dict[str, None]] = {"png": {"Software": None}, "svg": {"Date": None, "Creator": None}}


_DRAWN: Mapping[FigureKind, Callable[[RunReport], Figure | None]] = {
    FigureKind.RATES: rates_figure,
    FigureKind.BANDWIDTH: bandwidth_figure,
    FigureKind.TOTAL: total_figure,
    FigureKind.INTERVALS: intervals_figure,
    FigureKind.PATH: path_figure,
    FigureKind.ACCURACY: accuracy_figure,
}


def draw_figures(report: RunReport, kinds: Collection[FigureKind], folder: Path) -> list[Path]:
    """Draw each of ``kinds`` that there is something to see of, as PNG and SVG in ``folder``.

    Raises:
        OutputFileError: a file cannot be written.
    """
    written = []
    with rc_context(SETTINGS):
        for kind in FigureKind:
            figure = _DRAWN[kind](report) if kind in kinds else None
            if figure is not None:
                written += _save(figure, folder, kind.value)
    return written


def figure_files(folder: Path) -> list[Path]:
    """All that ``draw_figures`` may write into ``folder``."""
    return [folder / f"{kind.value}.{form}" for kind in FigureKind for form in _METADATA]


def draw_topics(report: RunReport, folder: Path, file_names: Mapping[str, str]) -> list[Path]:
    """Draw the rate of each topic and the map of zones, each as a PNG in ``folder``.

    ``file_names`` are by topic, that of the map by an empty name; topics without one are left out.

    Raises:
        OutputFileError: a file cannot be written.
    """
    written = []
    with rc_context(SETTINGS):
        figures: Iterator[tuple[str, Figure | None]] = chain(
            topic_rate_figures(report), [("", zones_figure(report))]
        )
        for topic, figure in figures:
            if figure is not None and topic in file_names:
                path = folder / file_names[topic]
                _save_as(figure, path, "png")
                written.append(path)
    return written


def _save(figure: Figure, folder: Path, name: str) -> list[Path]:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise not_written(folder, "the figures", error) from error
    paths = [folder / f"{name}.{form}" for form in _METADATA]
    for path, form in zip(paths, _METADATA, strict=True):
        _save_as(figure, path, form)
    return paths


def _save_as(figure: Figure, path: Path, form: str) -> None:
    FigureCanvasAgg(figure)
    with whole_binary_file(path, "the figure") as write:
        drawn = io.BytesIO()
        figure.savefig(drawn, format=form, dpi=_DPI, metadata=_METADATA[form], bbox_inches="tight")
        write(drawn.getvalue())
