# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Texts of others: in UTF-8, on a terminal, and lines worth saying once."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from unicodedata import category

BYTE_ORDER_MARK = "\ufeff"


def without_mark(text: str) -> tuple[str, str]:
    """The byte order mark in front of ``text``, "" where there is none, and the rest."""
    rest = text.removeprefix(BYTE_ORDER_MARK)
    return text[: len(text) - len(rest)], rest


def in_utf_8(text: str) -> str:
    """``text`` with a ``?`` for each thing that UTF-8 cannot say, such as a byte of a strange file name."""
    return text if text.isascii() else text.encode("utf-8", "replace").decode()


_SHORT = {"\t": r"\t", "\n": r"\n", "\r": r"\r"}


def first_names(names: Sequence[str], most: int) -> str:
    """``a, b``, or ``a, b, c and 7 more``."""
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return f"{', '.join(names[:most])}{more}"


def visible(text: str) -> str:
    r"""``text`` on one line; what moves a cursor, breaks a line or turns its direction is an escape.

    The escapes are those of JSON, as ``\u001b``: a line of JSON still says the same.
    """
    if text.isprintable():
        return text
    return "".join(character if is_shown(character) else _escape(character) for character in text)


def is_shown(character: str) -> bool:
    """Whether ``character`` is seen or is a space, of which ``isprintable`` knows but one."""
    return character.isprintable() or category(character) == "Zs"


def _escape(character: str) -> str:
    units = character.encode("utf-16-be", "surrogatepass").hex(" ", 2).split()
    return _SHORT.get(character) or "".join(rf"\u{unit}" for unit in units)


class SayOnce:
    """Says each line once by ``say``; of lines that others make up, ``most`` are said."""

    __slots__ = ("_most", "_said", "_say")

    def __init__(self, say: Callable[[str], None], *, most: int | None = None) -> None:
        self._say = say
        self._most = most
        self._said: set[str] = set()

    def __call__(self, line: str) -> None:
        if line not in self._said and (self._most is None or len(self._said) < self._most):
            self._said.add(line)
            self._say(line)
