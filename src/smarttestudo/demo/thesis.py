# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The tables and figures of the thesis's evaluation, of a demo's run."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from smarttestudo.demo.thesis_files import BANDWIDTH_TABLE, FREQUENCY_TABLE, figure_names
from smarttestudo.files.whole_file import whole_file
from smarttestudo.report.comparison_tables import RunNames
from smarttestudo.report.figures.draw import draw_topics
from smarttestudo.report.run_report import RunReport
from smarttestudo.report.table import Table
from smarttestudo.report.table_files import csv_table, markdown_table
from smarttestudo.report.thesis_tables import bandwidth_as_in_thesis, frequency_as_in_thesis

_FIGURE_NAMES = RunNames(before="Without adaptive monitoring", after="With it")


def write_thesis(report: RunReport, folder: Path) -> None:
    """Write Tables 7.1 and 7.2, the rate of each topic over time, and the map of zones into a new ``folder``.

    Raises:
        OutputFileError: a file cannot be written.
    """
    folder.mkdir()
    tables = {
        FREQUENCY_TABLE: frequency_as_in_thesis(report.comparison),
        BANDWIDTH_TABLE: bandwidth_as_in_thesis(report.comparison),
    }
    for name, table in tables.items():
        _write(table, folder, name)
    draw_topics(replace(report, names=_FIGURE_NAMES), folder, figure_names())


def _write(table: Table, folder: Path, name: str) -> None:
    for form, text in (("md", markdown_table(table)), ("csv", csv_table(table))):
        with whole_file(folder / f"{name}.{form}", "the table") as write:
            write(text)
