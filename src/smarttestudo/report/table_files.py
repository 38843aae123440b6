# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Tables as Markdown and as comma-separated values."""

from __future__ import annotations

import csv
import io

from smarttestudo.report.table import Align, Column, Number, Table, format_cell


def markdown_table(table: Table) -> str:
    """``table`` under its title, as GitHub writes tables, with its footnotes below."""
    lines = [f"**{table.title}**", ""] if table.title else []
    lines.append(_markdown_row([_heading(column) for column in table.columns]))
    lines.append(_markdown_row(["---" if one.align is Align.LEFT else "---:" for one in table.columns]))
    lines += [_markdown_row([format_cell(cell) for cell in row.cells]) for row in table.rows]
    for note in table.footnotes:
        lines += ["", note]
    return "\n".join(lines) + "\n"


def csv_table(table: Table) -> str:
    """The cells of ``table`` with numbers in full, empty where they are missing."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([_heading(column) for column in table.columns])
    for row in table.rows:
        writer.writerow([cell.value if isinstance(cell, Number) else cell.text for cell in row.cells])
    return text.getvalue()


def _heading(column: Column) -> str:
    return f"{column.heading} ({column.unit})" if column.unit else column.heading


def _markdown_row(cells: list[str]) -> str:
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"
