# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Plain values of a stranger's JSON, checked.

JSON can name what UTF-8 cannot say; a ``?`` takes its place, so that the value can be passed on.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from smarttestudo.domain.utf_8 import in_utf_8


def _number(value: object) -> float:
    if not isinstance(value, int | float) or isinstance(value, bool):
        raise ValueError(f"not a number: {str(value)[:40]}")  # noqa: TRY004 - a stranger's text
    try:
        float(value)
    except OverflowError as error:
        raise ValueError("too large a number") from error
    return value


def _whole(value: object) -> int:
    if not isinstance(value, int) or isinstance(value, bool):
        raise ValueError(f"not a whole number: {str(value)[:40]}")  # noqa: TRY004 - a stranger's text
    return value


def _exactly(kind: type) -> Callable[[Any], Any]:
    def read(value: object) -> object:
        if not isinstance(value, kind):
            raise ValueError(f"not a {kind.__name__}: {str(value)[:40]}")  # noqa: TRY004 - a stranger's text
        return value

    return read


def _text(value: object) -> str:
    if not isinstance(value, str):
        raise ValueError(f"not a str: {str(value)[:40]}")  # noqa: TRY004 - a stranger's text
    return in_utf_8(value)


def read_any(value: object) -> object:
    """A value of any type. Raises ``ValueError`` for keys that become alike."""
    if isinstance(value, dict):
        return read_mapping(value, read_any)
    if isinstance(value, list):
        return [read_any(one) for one in value]
    return in_utf_8(value) if isinstance(value, str) else value


def read_mapping(value: object, read: Callable[[Any], Any]) -> dict[str, Any]:
    """An object, its values by ``read``. Raises ``ValueError`` for none, and for keys that become alike."""
    if not isinstance(value, dict):
        raise ValueError("not an object")  # noqa: TRY004 - a stranger's text
    found = {in_utf_8(name): read(one) for name, one in value.items()}
    if len(found) < len(value):
        raise ValueError("two keys differ in what UTF-8 cannot say only")
    return found


PLAIN: Mapping[Any, Callable[[Any], Any]] = {
    float: _number,
    int: _whole,
    str: _text,
    bool: _exactly(bool),
}
"""Reader of each type; raises ``ValueError`` for another."""
