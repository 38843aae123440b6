# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Text of others where people read it: on a terminal it could be a command."""

from __future__ import annotations

from unicodedata import category

_SHORT = {"\t": r"\t", "\n": r"\n", "\r": r"\r"}


def visible(text: str) -> str:
    r"""``text`` on one line; what moves a cursor, breaks a line or turns its direction is an escape.

    The escapes are those of JSON, as ``\u001b``: a line of JSON still says the same.
    """
    if text.isprintable():
        return text
    return "".join(one if _has_a_place(one) else _escape(one) for one in text)


def _has_a_place(character: str) -> bool:
    """Whether ``character`` is seen or is a space, of which ``isprintable`` knows but one."""
    return character.isprintable() or category(character) == "Zs"


def _escape(character: str) -> str:
    units = character.encode("utf-16-be", "surrogatepass").hex(" ", 2).split()
    return _SHORT.get(character) or "".join(rf"\u{unit}" for unit in units)
