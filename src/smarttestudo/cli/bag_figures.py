# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``--figures`` of the actions of ``testudo bag``."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping, Sequence
from enum import Enum
from pathlib import Path

from smarttestudo.cli.arguments import budget_kb_per_s, file_path
from smarttestudo.cli.output import progress, write_line
from smarttestudo.cli.recordings import Asked, outputs_of_each, recordings_in
from smarttestudo.domain.errors import TestudoError
from smarttestudo.files.outputs import require_separate


class Drawn(Enum):
    """Content of an action's figures."""

    RATES = "rates over time and a histogram of the times between messages"
    BANDWIDTH = "bandwidth over time, and all topics stacked"
    BOTH = "rates and bandwidth over time, all topics stacked, and a histogram of the times between messages"


def add_figures(action: argparse.ArgumentParser, drawn: Drawn) -> None:
    """Add ``--figures``, and where bandwidth is drawn ``--budget``."""
    add_figures_folder(action, drawn.value)
    if drawn is not Drawn.RATES:
        add_budget(action)
    action.set_defaults(drawn=drawn)


def add_figures_folder(action: argparse.ArgumentParser, content: str) -> None:
    """Add ``--figures``; ``content`` is what they show."""
    action.add_argument(
        "--figures", metavar="DIR", type=file_path, help=f"write figures (PNG and SVG): {content}"
    )


def add_budget(action: argparse.ArgumentParser) -> None:
    action.add_argument(
        "--budget",
        metavar="N",
        type=budget_kb_per_s,
        help="KB/s that all topics together may take: a line in the figures",
    )


def with_figures(asked: Sequence[Asked], figures: Path) -> list[Asked]:
    """``asked`` with the folder for the figures of each, which must not harm a recording."""
    there = [one for one in asked if not isinstance(one, TestudoError)]
    folders = [figures] if len(asked) == 1 else [*outputs_of_each(there, figures)]
    require_separate(
        {"--figures": [file for folder in folders for file in figure_files(folder)]},
        [path for one in there for path in recordings_in(one).values()],
    )
    left = iter(folders)
    return [one if isinstance(one, TestudoError) else {**one, "figures": next(left)} for one in asked]


def figure_files(folder: Path) -> Sequence[Path]:
    """All that may be written into ``folder``."""
    from smarttestudo.report.figures import draw  # noqa: PLC0415  needs packages a robot lacks

    return draw.figure_files(folder)


def draw_pair(
    arguments: argparse.Namespace, a: Path, b: Path | None, *, mapping: Mapping[str, str], folder: Path
) -> None:
    """Draw the bag ``a``, with ``b`` over it if there is one, and say where."""
    from smarttestudo.report import bag_report as report  # noqa: PLC0415  needs packages a robot lacks
    from smarttestudo.report.bag_report import ReportRequest  # noqa: PLC0415
    from smarttestudo.report.comparison_tables import RunNames  # noqa: PLC0415

    kinds = {
        Drawn.RATES: report.RATES,
        Drawn.BANDWIDTH: report.BANDWIDTH,
        Drawn.BOTH: report.RATES | report.BANDWIDTH,
    }
    request = ReportRequest(
        a=a,
        b=b,
        title=str(a),
        names=RunNames(before="A", after="B"),
        mapping=mapping,
        topics=arguments.topics,
        budget_kb_per_s=getattr(arguments, "budget", None),
        progress=progress,
    )
    print_written(report.draw_over_time(request, kinds[arguments.drawn], folder))


def print_written(paths: Sequence[Path]) -> None:
    """Say which figures there are, where they do not disturb what a program reads."""
    for path in paths:
        write_line(f"wrote {path}", sys.stderr)
