# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""HTML and SVG, escaped."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from html import escape
from itertools import zip_longest
from typing import Any

from smarttestudo.domain.texts import visible
from smarttestudo.domain.units import grouped
from smarttestudo.report.table import Column, Table, Value

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
    return Markup("".join(part.html if isinstance(part, Markup) else _text(part) for part in children))


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
        text = "".join(character if character in _KEPT_CONTROLS else visible(character) for character in text)
    return escape(text)


MAX_ROWS = 300


def html_table(table: Table[Any], names: Sequence[Markup] = ()) -> Markup:
    """``table`` as a figure with its footnotes; the report gives it a visible heading.

    Scripts make its columns sortable. A very long table ends after ``MAX_ROWS`` rows and its sums. ``names``
    take the place of what is in the first column.
    """
    head = tag("tr", *(_heading(column) for column in table.columns))
    count = len(table.rows)
    values = table.values()
    more = (
        (f"… and {grouped(count - MAX_ROWS)} more rows; `testudo bag` prints them all.",)
        if count > MAX_ROWS
        else ()
    )
    notes = [tag("p", note, class_="note") for note in (*more, *table.footnotes)]
    body = tag(
        "tbody",
        *(
            tag("tr", *_cells(row, table.columns, name))
            for row, name in zip_longest(values[: min(count, MAX_ROWS)], names[:MAX_ROWS])
        ),
        *(tag("tr", *_cells(sums, table.columns), class_="total") for sums in values[count:]),
    )
    caption = tag("caption", "\n".join(table.heading), class_="unseen")
    return tag(
        "figure", tag("table", caption, tag("thead", head), body, data_sortable="yes"), *notes, class_="wide"
    )


def _heading(column: Column[Any]) -> Markup:
    unit = [tag("span", column.unit, class_="unit")] if column.unit else []
    return tag("th", column.heading, *unit, class_=_side(column), scope="col")


def _cells(
    values: Sequence[Value], columns: Sequence[Column[Any]], name: Markup | None = None
) -> Iterator[Markup]:
    for index, (value, column) in enumerate(zip(values, columns, strict=True)):
        words = " words" if isinstance(value, str) else ""
        content = column.text(value) if index or name is None else name
        yield tag("td", content, class_=f"{_side(column)}{words}")


def _side(column: Column[Any]) -> str:
    return "left" if column.is_text else "right"
