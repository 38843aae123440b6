# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""HTML and SVG, escaped."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from html import escape
from itertools import zip_longest

from smarttestudo.domain.texts import visible
from smarttestudo.domain.units import grouped
from smarttestudo.report.table import Column, Row, Table, Text, format_cell

_WITHOUT_CONTENT = frozenset({"meta", "wbr", "rect", "line", "path", "circle", "polyline", "polygon"})
_KEPT_CONTROLS = "\n\t"


@dataclass(frozen=True, slots=True)
class Markup:
    """Text that is HTML already."""

    html: str


Child = Markup | str
Attribute = str | float


def tag(name: str, /, *children: Child, **attributes: Attribute) -> Markup:
    """An element; in attribute names ``_`` stands for ``-``, a last ``_`` for nothing (``class_``).

    Floating-point attributes are coordinates and keep one decimal.
    """
    written = "".join(
        f' {key.rstrip("_").replace("_", "-")}="{_value(value)}"' for key, value in attributes.items()
    )
    if name in _WITHOUT_CONTENT and not children:
        return Markup(f"<{name}{written}/>")
    return Markup(f"<{name}{written}>{join(children).html}</{name}>")


def join(children: Iterable[Child]) -> Markup:
    """``children`` one after the other."""
    return Markup("".join(one.html if isinstance(one, Markup) else _text(one) for one in children))


def name_parts(topic: str) -> list[Child]:
    """A topic's name that may break before each of its slashes."""
    first, *others = topic.split("/")
    parts: list[Child] = [first]
    for other in others:
        parts += [tag("wbr"), f"/{other}"]
    return parts


def coordinate(value: float) -> str:
    """``value`` with at most one decimal."""
    return f"{value:.1f}".removesuffix(".0")


def _value(value: Attribute) -> str:
    return coordinate(value) if isinstance(value, float) else _text(str(value))


def _text(text: str) -> str:
    """``text`` escaped, line breaks and tabs kept, all else by which others could mislead as an escape."""
    if not text.isprintable():
        text = "".join(one if one in _KEPT_CONTROLS else visible(one) for one in text)
    return escape(text)


MAX_ROWS = 300


def html_table(table: Table, names: Sequence[Markup] = ()) -> Markup:
    """``table`` as a figure with its footnotes; the report gives it a visible heading.

    Scripts make its columns sortable. A very long table ends after ``MAX_ROWS`` rows and its sums. ``names``
    take the place of what is in the first column.
    """
    head = tag("tr", *(_heading(column) for column in table.columns))
    rows = [row for row in table.rows if not row.is_total]
    sums = [row for row in table.rows if row.is_total]
    left_out = len(rows) - MAX_ROWS
    more = (f"… and {grouped(left_out)} more rows; `testudo bag` prints them all.",) if left_out > 0 else ()
    notes = [tag("p", note, class_="note") for note in (*more, *table.footnotes)]
    shown = zip_longest((*rows[:MAX_ROWS], *sums), names[:MAX_ROWS])
    body = tag("tbody", *(_row(row, table.columns, name) for row, name in shown))
    caption = tag("caption", "\n".join(table.heading), class_="unseen")
    return tag(
        "figure", tag("table", caption, tag("thead", head), body, data_sortable="yes"), *notes, class_="wide"
    )


def _heading(column: Column) -> Markup:
    unit = [tag("span", column.unit, class_="unit")] if column.unit else []
    return tag("th", column.heading, *unit, class_=column.align.value, scope="col")


def _row(row: Row, columns: tuple[Column, ...], name: Markup | None) -> Markup:
    texts: list[Child] = [format_cell(cell) for cell in row.cells]
    if name is not None:
        texts[0] = name
    cells = (
        tag(
            "td",
            text,
            class_=f"{column.align.value}{' words' if isinstance(cell, Text) else ''}",
        )
        for text, cell, column in zip(texts, row.cells, columns, strict=True)
    )
    return tag("tr", *cells, class_="total") if row.is_total else tag("tr", *cells)
