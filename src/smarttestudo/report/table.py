# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Tables, the same in parts for a narrow terminal, and as plain text."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from itertools import pairwise
from textwrap import wrap

from smarttestudo.domain.texts import visible
from smarttestudo.domain.units import grouped

MISSING = "–"
_MINUS = "−"


class Align(Enum):
    """The side of its column that a cell keeps to."""

    LEFT = "left"
    RIGHT = "right"


@dataclass(frozen=True, slots=True, kw_only=True)
class Column:
    """A column with its heading; ``unit`` is empty where its cells have none.

    Columns from one that ``heads_group`` to the next are understood together.
    """

    heading: str
    unit: str = ""
    align: Align = Align.RIGHT
    heads_group: bool = False


@dataclass(frozen=True, slots=True)
class Text:
    """A cell with words, which may come from a stranger."""

    text: str


@dataclass(frozen=True, slots=True)
class Number:
    """A number in its column's unit, ``None`` where it is missing; ``signed`` shows a plus too."""

    value: float | None
    decimals: int = 2
    signed: bool = False


Cell = Text | Number

_MOST_PERCENT_DECIMALS = 6


def percent_cell(value: float | None, *, decimals: int = 1, signed: bool = False) -> Number:
    """A cell of percent, with the decimals that it takes to read as 0 or 100 only where it is that."""
    return Number(value, decimals=_percent_decimals(value, decimals), signed=signed)


def _percent_decimals(value: float | None, decimals: int) -> int:
    size = 0.0 if value is None or not math.isfinite(value) else abs(value)
    for enough in range(decimals, _MOST_PERCENT_DECIMALS + 1):
        if round(size, enough) not in {0.0, 100.0}:
            return enough
    return decimals


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """One cell for each column; ``is_total`` sets the row apart from those that it sums up."""

    cells: tuple[Cell, ...]
    is_total: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Table:
    """Rows under columns, with what a reader must know beneath them."""

    title: str
    subtitles: tuple[str, ...] = ()
    columns: tuple[Column, ...]
    rows: tuple[Row, ...]
    footnotes: tuple[str, ...] = ()

    @property
    def heading(self) -> tuple[str, ...]:
        """All lines of the title; none where it is empty."""
        return (self.title, *self.subtitles) if self.title else ()


def format_cell(cell: Cell) -> str:
    """The cell on one line."""
    match cell:
        case Text(text=text):
            return visible(text)
        case Number(value=value, decimals=decimals, signed=signed):
            return format_number(value, decimals, signed=signed)


def format_number(value: float | None, decimals: int, *, signed: bool = False) -> str:
    """``value`` with a true minus and thousands apart; an en dash where it is missing."""
    if value is None or not math.isfinite(value):
        return MISSING
    digits = grouped(abs(value), decimals)
    if not any("1" <= digit <= "9" for digit in digits):
        return digits
    return (_MINUS if value < 0 else "+" if signed else "") + digits


def percent_text(value: float | None, *, decimals: int = 1, signed: bool = False) -> str:
    """``value`` as in ``percent_cell``, with the sign of percent."""
    return f"{format_cell(percent_cell(value, decimals=decimals, signed=signed))} %"


_GAP = 2


def table_parts(table: Table, width: int) -> tuple[Table, ...]:
    """``table`` as tables that need no more than ``width`` where possible, by whole columns.

    Numbers and words stay whole. Each part begins with what names its rows: the columns before the first that
    ``heads_group``, and where there is none, the first. The last part has the footnotes.
    """
    needed = _needed_widths(table)
    if _total(needed) <= width:
        return (table,)
    key, *groups = _groups(table)
    parts = [list(key)]
    for group in groups:
        fits_a_part = _total([needed[index] for index in (*key, *group)]) <= width
        for columns in [group] if fits_a_part else [[index] for index in group]:
            fits = _total([needed[index] for index in (*parts[-1], *columns)]) <= width
            if not fits and len(parts[-1]) > len(key):
                parts.append(list(key))
            parts[-1] += columns
    return tuple(
        replace(
            _of_columns(table, columns),
            title="" if number else table.title,
            footnotes=table.footnotes if number == len(parts) - 1 else (),
        )
        for number, columns in enumerate(parts)
    )


def _groups(table: Table) -> list[list[int]]:
    """The columns that name a row, and those that stay together."""
    heads = [index for index, column in enumerate(table.columns) if column.heads_group]
    starts = [0, *(heads or range(1, len(table.columns))), len(table.columns)]
    return [list(range(start, end)) for start, end in pairwise(starts)]


def _needed_widths(table: Table) -> list[int]:
    """The width of each column at which no number and no word is cut."""
    widths = []
    for index, column in enumerate(table.columns):
        texts = [format_cell(row.cells[index]) for row in table.rows]
        if column.align is Align.LEFT:
            texts = [word for text in texts for word in text.split()]
        widths.append(max(map(len, [column.heading, column.unit, *texts])))
    return widths


def _total(widths: Sequence[int]) -> int:
    return sum(widths) + _GAP * (len(widths) - 1)


def _of_columns(table: Table, columns: Sequence[int]) -> Table:
    return replace(
        table,
        columns=tuple(table.columns[index] for index in columns),
        rows=tuple(
            Row(cells=tuple(row.cells[index] for index in columns), is_total=row.is_total)
            for row in table.rows
        ),
    )


_PLAIN_GAP = "  "
_NARROWEST_TEXT = 12
_ELLIPSIS = "…"


def plain_table(table: Table, *, width: int | None = None) -> str:
    """``table`` as lines of text, at most ``width`` wide where that is possible.

    Only words give way, an ellipsis in their middle; numbers are never cut.
    """
    rows = [[format_cell(cell) for cell in row.cells] for row in table.rows]
    heads = [
        [visible(column.heading) for column in table.columns],
        [column.unit for column in table.columns],
    ]
    widths = [max(map(len, cells)) for cells in zip(*heads, *rows, strict=True)]
    if width is not None:
        _narrow(widths, table.columns, width)
    lines = [*map(visible, table.heading), ""] if table.heading else []
    lines += [_line(head, widths, table.columns) for head in heads if any(head)]
    rule = _PLAIN_GAP.join("─" * column_width for column_width in widths)
    lines.append(rule)
    for row, cells in zip(table.rows, rows, strict=True):
        if row.is_total:
            lines.append(rule)
        lines.append(_line(cells, widths, table.columns))
    return "\n".join([*lines, *_notes(table.footnotes, len(rule) if width is None else width)])


def _narrow(widths: list[int], columns: Sequence[Column], width: int) -> None:
    """Take what is too much from the widest columns of words."""
    excess = sum(widths) + len(_PLAIN_GAP) * (len(widths) - 1) - width
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
    return _PLAIN_GAP.join(parts).rstrip()


def _shortened(text: str, width: int) -> str:
    """``text``, its middle replaced by an ellipsis if it is longer than ``width``."""
    if len(text) <= width:
        return text
    kept = width - len(_ELLIPSIS)
    return text[: kept - kept // 2] + _ELLIPSIS + text[len(text) - kept // 2 :]


def _notes(footnotes: Sequence[str], width: int) -> Iterator[str]:
    for note in footnotes:
        yield from wrap(visible(note), max(width, _NARROWEST_TEXT), subsequent_indent=_PLAIN_GAP)
