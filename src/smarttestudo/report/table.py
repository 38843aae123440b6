# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Tables: as plain text, in parts for a narrow terminal, as Markdown and as comma-separated values."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import KW_ONLY, dataclass, replace
from functools import partial
from itertools import pairwise
from textwrap import wrap
from typing import Any, Generic, TypeVar

from smarttestudo.domain.texts import visible
from smarttestudo.domain.units import grouped

MISSING = "–"
_MINUS = "−"
_MOST_PERCENT_DECIMALS = 6
_SMALL = 0.01
_NOISE = 1e-9

Value = str | float | None
"""The content of a cell; words may come from a stranger, ``None`` is missing."""
Form = Callable[[float | None], str]


def format_number(value: float | None, decimals: int, *, signed: bool = False) -> str:
    """``value`` with a true minus and thousands apart; an en dash where it is missing."""
    if value is None or not math.isfinite(value):
        return MISSING
    digits = grouped(abs(value), decimals)
    if not any("1" <= digit <= "9" for digit in digits):
        return digits
    return (_MINUS if value < 0 else "+" if signed else "") + digits


def decimals(count: int, *, signed: bool = False) -> Form:
    """The form with ``count`` decimals; ``signed`` shows a plus, too."""
    return partial(format_number, decimals=count, signed=signed)


WHOLE, TWO_DECIMALS = decimals(0), decimals(2)


def percent_number(value: float | None, *, decimals: int = 1, signed: bool = False) -> str:
    """Percent, with the decimals that it takes to read as 0 or 100 only where it is that."""
    size = 0.0 if value is None or not math.isfinite(value) else abs(value)
    enough = range(decimals, _MOST_PERCENT_DECIMALS + 1)
    needed = next((count for count in enough if round(size, count) not in {0.0, 100.0}), decimals)
    return format_number(value, needed, signed=signed)


def change(value: float | None) -> str:
    """A change in percent, with its sign."""
    return percent_number(value, signed=True)


def percent_text(value: float | None, *, decimals: int = 1, signed: bool = False) -> str:
    """``value`` as in ``percent_number``, with the sign of percent."""
    return f"{percent_number(value, decimals=decimals, signed=signed)} %"


def measured(value: float | None) -> str:
    """``value`` in three significant digits, in two below 0.01; nothing of one that is not finite."""
    if value is None or not math.isfinite(value):
        return MISSING
    if abs(value) < _NOISE:
        return "0"
    digits = 3 if abs(value) >= _SMALL else 2
    return format_number(value, max(digits - 1 - math.floor(math.log10(abs(value))), 0))


_Row_contra = TypeVar("_Row_contra", contravariant=True)
_Row = TypeVar("_Row")


@dataclass(frozen=True, slots=True)
class Column(Generic[_Row_contra]):
    """A column: its heading, the unit of its cells, and the value of a row.

    Numbers are shown in ``form``. A column that ``is_text`` keeps to the left. ``sums`` stand at the foot,
    each in a row of its own. Columns from one that ``heads_group`` to the next are understood together.
    """

    heading: str
    unit: str
    get: Callable[[_Row_contra], Value]
    form: Form = TWO_DECIMALS
    _: KW_ONLY
    is_text: bool = False
    heads_group: bool = False
    sums: tuple[Value, ...] = ()

    @property
    def title(self) -> str:
        """The heading and the unit on one line."""
        return f"{self.heading} ({self.unit})" if self.unit else self.heading

    def text(self, value: Value) -> str:
        """``value`` as a cell, on one line."""
        return visible(value) if isinstance(value, str) else self.form(value)


@dataclass(frozen=True, slots=True, kw_only=True)
class Table(Generic[_Row]):
    """Rows under columns, with what a reader must know beneath them."""

    title: str = ""
    subtitles: tuple[str, ...] = ()
    columns: tuple[Column[_Row], ...]
    rows: Sequence[_Row]
    footnotes: tuple[str, ...] = ()

    @property
    def heading(self) -> tuple[str, ...]:
        """The lines of the title; none where it is empty."""
        return (self.title, *self.subtitles) if self.title else ()

    def values(self) -> list[tuple[Value, ...]]:
        """The cells of each row, then those of each sum, empty where a column has none."""
        sums = max(len(column.sums) for column in self.columns)
        by_column = (
            (*map(column.get, self.rows), *column.sums, *[""] * (sums - len(column.sums)))
            for column in self.columns
        )
        return list(zip(*by_column, strict=True))

    def texts(self) -> list[list[str]]:
        """``values`` as they are shown."""
        return [
            [column.text(value) for column, value in zip(self.columns, values, strict=True)]
            for values in self.values()
        ]


_GAP = 2


def table_parts(table: Table[Any], width: int) -> tuple[Table[Any], ...]:
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
            table,
            columns=tuple(table.columns[index] for index in columns),
            title="" if number else table.title,
            footnotes=table.footnotes if number == len(parts) - 1 else (),
        )
        for number, columns in enumerate(parts)
    )


def _groups(table: Table[Any]) -> list[list[int]]:
    """The columns that name a row, and those that stay together."""
    heads = [index for index, column in enumerate(table.columns) if column.heads_group]
    starts = [0, *(heads or range(1, len(table.columns))), len(table.columns)]
    return [list(range(start, end)) for start, end in pairwise(starts)]


def _needed_widths(table: Table[Any]) -> list[int]:
    """The width of each column at which no number and no word is cut."""
    widths = []
    for column, *texts in zip(table.columns, *table.texts(), strict=True):
        parts = [word for text in texts for word in text.split()] if column.is_text else texts
        widths.append(max(map(len, [column.heading, column.unit, *parts])))
    return widths


def _total(widths: Sequence[int]) -> int:
    return sum(widths) + _GAP * (len(widths) - 1)


_PLAIN_GAP = "  "
_NARROWEST_TEXT = 12
_ELLIPSIS = "…"


def plain_table(table: Table[Any], *, width: int | None = None) -> str:
    """``table`` as lines of text, at most ``width`` wide where that is possible.

    Only words give way, an ellipsis in their middle; numbers are never cut.
    """
    rows = table.texts()
    heads = [[visible(column.heading) for column in table.columns], [column.unit for column in table.columns]]
    widths = [max(map(len, cells)) for cells in zip(*heads, *rows, strict=True)]
    if width is not None:
        _narrow(widths, table.columns, width)
    lines = [*map(visible, table.heading), ""] if table.heading else []
    lines += [_line(head, widths, table.columns) for head in heads if any(head)]
    rule = _PLAIN_GAP.join("─" * column_width for column_width in widths)
    lines.append(rule)
    for number, cells in enumerate(rows):
        if number >= len(table.rows):
            lines.append(rule)
        lines.append(_line(cells, widths, table.columns))
    return "\n".join([*lines, *_notes(table.footnotes, len(rule) if width is None else width)])


def _narrow(widths: list[int], columns: Sequence[Column[Any]], width: int) -> None:
    """Take what is too much from the widest columns of words."""
    excess = sum(widths) + len(_PLAIN_GAP) * (len(widths) - 1) - width
    words = [index for index, column in enumerate(columns) if column.is_text]
    for _ in range(excess):
        widest = max(words, key=lambda index: widths[index], default=None)
        if widest is None or widths[widest] <= _NARROWEST_TEXT:
            return
        widths[widest] -= 1


def _line(cells: Sequence[str], widths: Sequence[int], columns: Sequence[Column[Any]]) -> str:
    parts = (
        _shortened(cell, width).ljust(width) if column.is_text else cell.rjust(width)
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


def markdown_table(table: Table[Any]) -> str:
    """``table`` under its title, as GitHub writes tables, with its footnotes below."""
    lines = [f"**{table.title}**", ""] if table.title else []
    lines.append(_markdown_row([column.title for column in table.columns]))
    lines.append(_markdown_row(["---" if column.is_text else "---:" for column in table.columns]))
    lines += map(_markdown_row, table.texts())
    for note in table.footnotes:
        lines += ["", note]
    return "\n".join(lines) + "\n"


def _markdown_row(cells: Sequence[str]) -> str:
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def csv_table(table: Table[Any]) -> str:
    """The cells of ``table`` with numbers in full, empty where they are missing."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([column.title for column in table.columns])
    writer.writerows(table.values())
    return text.getvalue()
