# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Plain values of a stranger's JSON, checked."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any


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


PLAIN: Mapping[Any, Callable[[Any], Any]] = {
    float: _number,
    int: _whole,
    str: _exactly(str),
    bool: _exactly(bool),
}
"""Reader of each type; raises ``ValueError`` for another."""
