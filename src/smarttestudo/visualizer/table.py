# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A table of typed cells; how it looks is the business of what shows it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum
from unicodedata import category

MISSING = "–"
_MINUS = "−"
_UNPRINTABLE = "\N{REPLACEMENT CHARACTER}"


class Align(Enum):
    """The side of its column that a cell keeps to."""

    LEFT = "left"
    RIGHT = "right"


@dataclass(frozen=True, slots=True, kw_only=True)
class Column:
    """A column with its heading; ``unit`` is empty where its cells have none."""

    heading: str
    unit: str = ""
    align: Align = Align.RIGHT


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


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """One cell for each column; ``is_total`` sets the row apart from those that it sums up."""

    cells: tuple[Cell, ...]
    is_total: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Table:
    """Rows under columns, with what a reader must know beneath them."""

    title: str
    columns: tuple[Column, ...]
    rows: tuple[Row, ...]
    footnotes: tuple[str, ...] = ()


def format_cell(cell: Cell) -> str:
    """The cell on one line."""
    match cell:
        case Text(text=text):
            return printable(text)
        case Number(value=value, decimals=decimals, signed=signed):
            return format_number(value, decimals, signed=signed)


def format_number(value: float | None, decimals: int, *, signed: bool = False) -> str:
    """``value`` with a true minus and commas between thousands; an en dash where it is missing."""
    if value is None or not math.isfinite(value):
        return MISSING
    digits = f"{abs(value):,.{decimals}f}"
    if not any("1" <= digit <= "9" for digit in digits):
        return digits
    return (_MINUS if value < 0 else "+" if signed else "") + digits


def printable(text: str) -> str:
    """``text`` without what moves a cursor, breaks a line or turns its direction: that becomes U+FFFD."""
    if text.isprintable():
        return text
    return "".join(one if _has_a_place(one) else _UNPRINTABLE for one in text)


def _has_a_place(character: str) -> bool:
    """Whether ``character`` is seen or is a space, of which ``isprintable`` knows but one."""
    return character.isprintable() or category(character) == "Zs"
