# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Tables in a terminal: with rich where it is installed, in plain text everywhere else."""

from __future__ import annotations

import shutil
import sys
from typing import TYPE_CHECKING, Any, TextIO

from smarttestudo.cli.output import write_line, write_lines
from smarttestudo.cli.terminal import is_unicode
from smarttestudo.domain.texts import visible
from smarttestudo.report.table import Table, plain_table, table_parts

if TYPE_CHECKING:
    from rich.table import Table as RichTable


def print_table(table: Table[Any], stream: TextIO | None = None) -> None:
    """Write ``table`` to ``stream`` (default: standard output), no wider than a terminal, whole in a pipe."""
    stream = stream or sys.stdout
    if not stream.isatty():
        write_lines(plain_table(table).split("\n"), stream)
        return
    width = shutil.get_terminal_size().columns
    for number, part in enumerate(table_parts(table, width)):
        if number:
            write_line(stream=stream)
        if not is_unicode(stream) or not _print_rich(part, stream):
            write_lines(plain_table(part, width=width).split("\n"), stream)


def _print_rich(table: Table[Any], stream: TextIO) -> bool:
    """Write ``table`` with rich; false where rich is not installed."""
    try:
        from rich.console import Console  # noqa: PLC0415  a robot has no rich
    except ModuleNotFoundError:
        return False
    console = Console(file=stream, highlight=False, markup=False, emoji=False)
    if table.heading:
        # A title of the table itself would be broken where the table is narrower.
        console.print("\n".join(map(visible, table.heading)), style="bold", soft_wrap=True)
    console.print(_rich_table(table))
    for note in table.footnotes:
        console.print(visible(note), style="dim")
    return True


def _rich_table(table: Table[Any]) -> RichTable:
    from rich import box  # noqa: PLC0415
    from rich.table import Table as RichTable  # noqa: PLC0415
    from rich.text import Text as RichText  # noqa: PLC0415

    shown = RichTable(
        box=box.SIMPLE_HEAD,
        padding=(0, 1, 0, 0),
        show_edge=False,
        pad_edge=False,
    )
    has_units = any(column.unit for column in table.columns)
    for column in table.columns:
        heading = RichText.assemble(visible(column.heading), ("\n" + column.unit if has_units else "", "dim"))
        if column.is_text:
            shown.add_column(heading, justify="left", overflow="fold")
        else:
            shown.add_column(heading, justify="right", no_wrap=True)
    for number, cells in enumerate(table.texts()):
        is_sum = number >= len(table.rows)
        if is_sum:
            shown.add_section()
        shown.add_row(*map(RichText, cells), style="bold" if is_sum else None)
    return shown
