# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Infinite values of signals in JSON, in which they are null as unknown ones are.

Which of them are infinite stands beside them. Readers that do not know of that take them for unknown.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from smarttestudo.domain.record import from_json


@dataclass(frozen=True, slots=True, kw_only=True)
class _Beside:
    infinite: Mapping[str, Literal["inf", "-inf"]] = field(default_factory=dict)


def infinite_entry(values: Mapping[str, float | None]) -> dict[str, object]:
    """The entry ``infinite`` beside ``values``, by name; empty where none is."""
    signs = {
        name: "inf" if value > 0 else "-inf"
        for name, value in values.items()
        if value is not None and math.isinf(value)
    }
    return {"infinite": signs} if signs else {}


def with_infinite(values: Mapping[str, float | None], record: object) -> Mapping[str, float | None]:
    """``values``, which were read from ``record``, with the infinite ones. Raises ``ValueError``."""
    infinite = from_json(_Beside, record).infinite
    found = {name: float(sign) for name, sign in infinite.items() if name in values}
    return {**values, **found} if found else values
