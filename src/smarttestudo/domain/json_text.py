# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Values as JSON, which has no numbers but finite ones, and plain values of a stranger's JSON, checked.

JSON can name what UTF-8 cannot say; a ``?`` takes its place, so that the value can be passed on.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping
from typing import Any

from smarttestudo.domain.texts import in_utf_8


def json_text(
    value: object, *, ascii_only: bool = True, indent: int | None = None, compact: bool = False
) -> str:
    """``value`` as JSON text; infinite numbers and NaN, such as a laser's "no return", are ``null``."""
    separators = (",", ":") if compact else None
    try:
        return json.dumps(
            value, ensure_ascii=ascii_only, allow_nan=False, indent=indent, separators=separators
        )
    except ValueError:
        # Seldom needed, so that what is finite costs nothing.
        return json.dumps(_finite(value), ensure_ascii=ascii_only, indent=indent, separators=separators)


def _finite(value: object) -> object:
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, Mapping):
        return {key: _finite(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(entry) for entry in value]
    return value


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
        return [read_any(item) for item in value]
    return in_utf_8(value) if isinstance(value, str) else value


def read_mapping(value: object, read: Callable[[Any], Any]) -> dict[str, Any]:
    """An object, its values by ``read``. Raises ``ValueError`` for none, and for keys that become alike."""
    if not isinstance(value, dict):
        raise ValueError("not an object")  # noqa: TRY004 - a stranger's text
    found = {in_utf_8(name): read(item) for name, item in value.items()}
    if len(found) < len(value):
        raise ValueError("two keys differ in what UTF-8 cannot say only")
    return found


PLAIN: Mapping[Any, Callable[[Any], Any]] = {float: _number, int: _whole, str: _text, bool: _exactly(bool)}
"""Reader of each type; raises ``ValueError`` for another."""
