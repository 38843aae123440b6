# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Tables as HTML."""

from __future__ import annotations

from smarttestudo.visualizer.report.markup import Markup, tag
from smarttestudo.visualizer.table import Column, Row, Table, Text, format_cell

MAX_ROWS = 300


def html_table(table: Table) -> Markup:
    """``table`` as a figure with its footnotes; the report gives it a visible heading.

    Scripts make its columns sortable. A very long table ends after ``MAX_ROWS`` rows and its sums.
    """
    head = tag("tr", *(_heading(column) for column in table.columns))
    rows = [row for row in table.rows if not row.is_total]
    sums = [row for row in table.rows if row.is_total]
    left_out = len(rows) - MAX_ROWS
    more = (f"… and {left_out:,} more rows; `testudo bag` prints them all.",) if left_out > 0 else ()
    notes = [tag("p", note, class_="note") for note in (*more, *table.footnotes)]
    body = tag("tbody", *(_row(row, table.columns) for row in (*rows[:MAX_ROWS], *sums)))
    caption = tag("caption", table.title, class_="unseen")
    return tag(
        "figure", tag("table", caption, tag("thead", head), body, data_sortable="yes"), *notes, class_="wide"
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
