# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Topics that are there, types of topics, and the fields and constants of those."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType

from smarttestudo.domain.names import full_type_name, is_own_output, short_type_name
from smarttestudo.domain.signal import Value
from smarttestudo.domain.type_definition import FieldType, TypeDefinition
from smarttestudo.language.properties.types_by_name import conventional_types
from smarttestudo.language.standard_types import STANDARD_TYPES
from smarttestudo.language.syntax import Constant
from smarttestudo.language.topic_pattern import matching

_INDEX = re.compile(r"\[(?:[^\]\"\\]|\"(?:[^\"\\]|\\.)*\")*\]")


@dataclass(frozen=True, slots=True, kw_only=True)
class KnownTypes:
    """Knowledge of topics and of types beside rule files.

    ``topics`` are there, in a recording or on a robot, each with its type, empty where that is not known;
    patterns match no others. ``declared`` are types that a profile says of topics, there or not.
    """

    topics: Mapping[str, str] = field(default_factory=dict)
    definitions: Mapping[str, TypeDefinition] = field(default_factory=dict)
    declared: Mapping[str, str] = field(default_factory=dict)

    def type_of(self, topic: str) -> str:
        """The type of ``topic``: the profile's word, else what it is, else what is usual for its name."""
        known = self.declared.get(topic) or self.topics.get(topic)
        return known or next(iter(conventional_types(topic)), "")

    def definition(self, type_name: str) -> TypeDefinition | None:
        """Definition of a type, if it is known; the constants of some standard ones are known anywhere."""
        found, standard = self.definitions.get(type_name), STANDARD_TYPES.get(type_name)
        if found is None or standard is None or found.constants:
            return found or standard
        return replace(found, constants=standard.constants)

    def field_at(self, topic: str, path: str) -> FieldType | None:
        """The field that ``path`` leads to, ``None`` where that is not known."""
        names = _names(path)
        steps = [*self._steps(topic, names)]
        return steps[-1][1] if len(steps) == len(names) else None

    def constant(self, topic: str, path: str, constant: Constant) -> Value | None:
        """The value of ``constant`` beside the field ``path``, ``None`` where no known type has it."""
        for type_name in self.types_with_constants(topic, path, constant.type_name):
            definition = self.definition(type_name)
            if definition is not None and constant.name in definition.constants:
                return definition.constants[constant.name]
        return None

    def types_with_constants(self, topic: str, path: str, type_name: str = "") -> list[str]:
        """The types whose constants may stand beside the field ``path``, those that count first.

        They are the types around the field, the innermost first, and for a property that is no field all
        types within that of the topic. With the name of a type, or its end, it is one of those within the
        topic's type, else any.
        """
        if not type_name:
            around = [name for name, _ in self._steps(topic, _names(path))][::-1]
            return around or [*self._within(self.type_of(topic))]
        whole = [full_type_name(type_name, "")] if "/" in type_name else []
        named = (*self._within(self.type_of(topic)), *whole, *STANDARD_TYPES, *self.definitions)
        return [
            name
            for name in dict.fromkeys(named)
            if f"/{name}".endswith(f"/{type_name}") or short_type_name(name) == type_name
        ]

    def without_outputs(self, output_topic: str) -> KnownTypes:
        """The same without the topics that are named like outputs."""
        topics = {
            topic: name for topic, name in self.topics.items() if not is_own_output(topic, output_topic)
        }
        return replace(self, topics=topics)

    def needed(self, patterns: Iterable[str], typed: Iterable[tuple[str, str]]) -> KnownTypes:
        """As much of it as rules with these patterns need, and with constants for these topics and types."""
        names = dict.fromkeys(topic for topic, _ in typed if topic in self.topics)
        names.update(dict.fromkeys(one for pattern in patterns for one in matching(pattern, self.topics)))
        types = dict.fromkeys(
            name
            for topic, type_name in typed
            for name in (
                *self._within(self.type_of(topic)),
                *(self.types_with_constants(topic, "", type_name) if type_name else ()),
            )
        )
        return KnownTypes(
            topics={topic: self.topics[topic] for topic in sorted(names)},
            definitions={name: self.definitions[name] for name in sorted(types) if name in self.definitions},
        )

    def _steps(self, topic: str, names: list[str]) -> Iterator[tuple[str, FieldType]]:
        """The types on the way to the field, each with its field that is next, as far as they are known."""
        type_name = self.type_of(topic)
        for name in names:
            definition = self.definition(type_name)
            found = None if definition is None else definition.fields.get(name)
            if found is None:
                return
            yield type_name, found
            type_name = found.name

    def _within(self, type_name: str) -> Iterator[str]:
        """The type and those within it, however deep."""
        met = {type_name: None}
        waiting = [type_name]
        while waiting:
            name = waiting.pop(0)
            definition = self.definition(name)
            if definition is None:
                continue
            yield name
            inner = [one.name for one in definition.fields.values() if one.name not in met]
            waiting += inner
            met.update(dict.fromkeys(inner))


def _names(path: str) -> list[str]:
    return _INDEX.sub("", path.removeprefix("msg.")).split(".")


NO_TYPES = KnownTypes(
    topics=MappingProxyType({}), definitions=MappingProxyType({}), declared=MappingProxyType({})
)
