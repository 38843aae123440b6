# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Results as the objects that ``--json`` prints."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from enum import Enum
from types import MappingProxyType
from typing import Any, ClassVar


class JsonObject:
    """A dataclass whose fields are the entries of an object in JSON, in their order.

    An entry has the name of its field, or that in ``_KEYS``; without any there it is left out. A number that
    is infinite is null.
    """

    __slots__ = ()
    _KEYS: ClassVar[Mapping[str, str]] = MappingProxyType({})

    def to_json(self) -> dict[str, object]:
        """The entry in ``--json``."""
        this: Any = self
        names = ((field.name, self._KEYS.get(field.name, field.name)) for field in dataclasses.fields(this))
        return {key: _value(getattr(self, name)) for name, key in names if key}


def _value(value: object) -> object:
    if isinstance(value, JsonObject):
        return value.to_json()
    if isinstance(value, Mapping):
        return {key: _value(entry) for key, entry in value.items()}
    if isinstance(value, tuple):
        return [_value(entry) for entry in value]
    if isinstance(value, Enum):
        return value.value
    return None if isinstance(value, float) and math.isinf(value) else value
