# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Tables in plain text, for terminals without rich, for pipes and for files."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from textwrap import wrap

from smarttestudo.visualizer.table import Align, Column, Table, format_cell

_GAP = "  "
_NARROWEST_TEXT = 12
_ELLIPSIS = "…"


def plain_table(table: Table, *, width: int | None = None) -> str:
    """``table`` as lines of text, at most ``width`` wide where that is possible.

    Only words give way, an ellipsis in their middle; numbers are never cut.
    """
    rows = [[format_cell(cell) for cell in row.cells] for row in table.rows]
    heads = [
        [column.heading for column in table.columns],
        [column.unit for column in table.columns],
    ]
    widths = [max(map(len, cells)) for cells in zip(*heads, *rows, strict=True)]
    if width is not None:
        _narrow(widths, table.columns, width)
    lines = [table.title, ""] if table.title else []
    lines += [_line(head, widths, table.columns) for head in heads if any(head)]
    rule = _GAP.join("─" * column_width for column_width in widths)
    lines.append(rule)
    for row, cells in zip(table.rows, rows, strict=True):
        if row.is_total:
            lines.append(rule)
        lines.append(_line(cells, widths, table.columns))
    return "\n".join([*lines, *_notes(table.footnotes, len(rule) if width is None else width)])


def _narrow(widths: list[int], columns: Sequence[Column], width: int) -> None:
    """Take what is too much from the widest columns of words."""
    excess = sum(widths) + len(_GAP) * (len(widths) - 1) - width
    words = [index for index, column in enumerate(columns) if column.align is Align.LEFT]
    for _ in range(excess):
        widest = max(words, key=lambda index: widths[index], default=None)
        if widest is None or widths[widest] <= _NARROWEST_TEXT:
            return
        widths[widest] -= 1


def _line(cells: Sequence[str], widths: Sequence[int], columns: Sequence[Column]) -> str:
    parts = (
        _shortened(cell, width).ljust(width) if column.align is Align.LEFT else cell.rjust(width)
        for cell, width, column in zip(cells, widths, columns, strict=True)
    )
    return _GAP.join(parts).rstrip()


def _shortened(text: str, width: int) -> str:
    """``text``, its middle replaced by an ellipsis if it is longer than ``width``."""
    if len(text) <= width:
        return text
    kept = width - len(_ELLIPSIS)
    return text[: kept - kept // 2] + _ELLIPSIS + text[len(text) - kept // 2 :]


def _notes(footnotes: Sequence[str], width: int) -> Iterator[str]:
    for note in footnotes:
        yield from wrap(note, max(width, _NARROWEST_TEXT), subsequent_indent=_GAP)
