# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Values as JSON, which has no numbers but finite ones."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping


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
