# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Tables as HTML."""

from __future__ import annotations

from smarttestudo.visualizer.page.markup import Markup, tag
from smarttestudo.visualizer.table import Column, Row, Table, Text, format_cell


def html_table(table: Table) -> Markup:
    """``table`` as a figure with its footnotes; the page gives it a heading."""
    head = tag("tr", *(_heading(column) for column in table.columns))
    notes = [tag("p", note, class_="note") for note in table.footnotes]
    return tag(
        "figure",
        tag("table", tag("thead", head), tag("tbody", *(_row(row, table.columns) for row in table.rows))),
        *notes,
        class_="wide",
    )


def _heading(column: Column) -> Markup:
    unit = [tag("span", column.unit, class_="unit")] if column.unit else []
    return tag("th", column.heading, *unit, class_=column.align.value, scope="col")


def _row(row: Row, columns: tuple[Column, ...]) -> Markup:
    cells = (
        tag(
            "td",
            format_cell(cell),
            class_=f"{column.align.value}{' words' if isinstance(cell, Text) else ''}",
        )
        for cell, column in zip(row.cells, columns, strict=True)
    )
    return tag("tr", *cells, class_="total") if row.is_total else tag("tr", *cells)
