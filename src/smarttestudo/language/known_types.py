# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Topics that are there, their types, and the fields and constants of those."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

from smarttestudo.domain.signal import Value
from smarttestudo.domain.type_definition import FieldType, TypeDefinition
from smarttestudo.language.syntax import Constant

_INDEX = re.compile(r"\[(?:[^\]\"\\]|\"(?:[^\"\\]|\\.)*\")*\]")


@dataclass(frozen=True, slots=True, kw_only=True)
class KnownTypes:
    """The type of each topic that is there, and what is known of these types and those in their fields."""

    topics: Mapping[str, str] = field(default_factory=dict)
    definitions: Mapping[str, TypeDefinition] = field(default_factory=dict)

    def field_at(self, topic: str, path: str) -> FieldType | None:
        """The field that ``path`` leads to, ``None`` where that is not known."""
        steps = [*self._steps(topic, path)]
        return steps[-1][1] if steps else None

    def constant(self, topic: str, path: str, constant: Constant) -> Value | None:
        """The value of ``constant`` beside the field ``path``, ``None`` where no known type has it.

        Without a type's name it is of the innermost type around the field that has it.
        """
        if constant.type_name:
            end = f"/{constant.type_name}"
            named = [name for name in self.definitions if f"/{name}".endswith(end)]
        else:
            named = [type_name for type_name, _ in self._steps(topic, path)][::-1]
            named = named or [name for name in (self.topics.get(topic),) if name]
        for name in named:
            definition = self.definitions.get(name)
            if definition is not None and constant.name in definition.constants:
                return definition.constants[constant.name]
        return None

    def _steps(self, topic: str, path: str) -> Iterator[tuple[str, FieldType]]:
        """The types on the way to the field, each with its field that is next, as far as they are known."""
        type_name = self.topics.get(topic, "")
        for name in _INDEX.sub("", path.removeprefix("msg.")).split("."):
            definition = self.definitions.get(type_name)
            found = None if definition is None else definition.fields.get(name)
            if found is None:
                return
            yield type_name, found
            type_name = found.name


NO_TYPES = KnownTypes(topics=MappingProxyType({}), definitions=MappingProxyType({}))
