# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Fields and constants of a message type, as far as they are known."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from smarttestudo.domain.signal import Value


@dataclass(frozen=True, slots=True, kw_only=True)
class FieldType:
    """The type of a field: ``string``, ``bool``, ``float64`` or the name of a message type."""

    name: str
    is_array: bool = False

    @property
    def is_text(self) -> bool:
        """Whether it, or each element, is a text."""
        return self.name in ("string", "wstring")

    @property
    def is_truth(self) -> bool:
        """Whether it, or each element, is true or false."""
        return self.name in ("bool", "boolean")

    @property
    def is_message(self) -> bool:
        """Whether it, or each element, has fields of its own."""
        return "/" in self.name


@dataclass(frozen=True, slots=True, kw_only=True)
class TypeDefinition:
    """The fields and constants of a message type by name."""

    fields: Mapping[str, FieldType] = field(default_factory=dict)
    constants: Mapping[str, Value] = field(default_factory=dict)
