# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What is said about a property."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

Reader = Callable[[object], float]
"""Reads a decoded message; NaN stands for unknown."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PropertySpec:
    """A named property: its unit, what it means, and the least and greatest value it can take, if any.

    ``includes_minimum`` is false where the least value itself cannot occur: an angle lies in (−180, 180].
    """

    name: str
    unit: str
    meaning: str
    minimum: float | None = None
    maximum: float | None = None
    includes_minimum: bool = True
