# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The topics of a recording, with the fields and constants of their types, for rules."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, cast

from smarttestudo.domain.names import TOPIC_PLACEHOLDER, full_type_name
from smarttestudo.domain.recording import Channel, types_of_topics
from smarttestudo.domain.signal import Value
from smarttestudo.domain.type_definition import FieldType, TypeDefinition
from smarttestudo.language.known_types import KnownTypes
from smarttestudo.language.rule_set import RuleSet

if TYPE_CHECKING:
    from rosbags.interfaces.typing import FieldDesc, Typesdict

    from smarttestudo.bags.definitions import TypeLibrary

_CONSTANT = re.compile(
    r"[ \t]*(?P<type>\w+)(?:<=\d+)?[ \t]+(?P<name>[A-Z]\w*)[ \t]*=[ \t]*(?P<value>.*)", re.ASCII
)
_QUOTED = re.compile(r"(?P<quote>[\"'])(?P<text>.*?)(?P=quote)[ \t]*(?:#.*)?\Z")
_TEXTS = frozenset({"string", "wstring"})
_TRUTHS = {"true": 1.0, "false": 0.0}


def recorded_types(channels: Iterable[Channel] = ()) -> KnownTypes:
    """Types of ``channels``; those that they lack are those of ROS 2's standard packages.

    Definitions are read as they are asked for.
    """
    channels = tuple(channels)
    return KnownTypes(topics=types_of_topics(channels), definitions=_Definitions(channels))


def installed_types(topics: Mapping[str, str]) -> KnownTypes:
    """These topics with their types, as far as they are of ROS 2's standard packages."""
    return replace(recorded_types(), topics=topics)


def rules_for(
    rule_set: RuleSet, channels: Iterable[Channel], output_topic: str = TOPIC_PLACEHOLDER
) -> RuleSet:
    """``rule_set`` as it is where the topics of ``channels`` are there, but those named as outputs."""
    return rule_set.by(recorded_types(channels).without_outputs(output_topic))


class _Definitions(Mapping[str, TypeDefinition]):
    """Types by name; where two channels define one, that of the first counts."""

    def __init__(self, channels: Iterable[Channel]) -> None:
        self._channels: dict[str, Channel] = {}
        for channel in channels:
            self._channels.setdefault(channel.type_name, channel)
        self._found: dict[str, TypeDefinition | None] = {}

    def __getitem__(self, name: str) -> TypeDefinition:
        if name not in self._found:
            channel = self._channels.get(name) or Channel(topic="", type_name=name)
            for found, definition in _types_of(self._library, channel):
                self._found.setdefault(found, definition)
            self._found.setdefault(name, None)
        known = self._found[name]
        if known is None:
            raise KeyError(name)
        return known

    def __iter__(self) -> Iterator[str]:
        for name in self._channels:
            self.get(name)
        return iter([name for name, known in self._found.items() if known is not None])

    def __len__(self) -> int:
        return sum(1 for _ in self)

    @cached_property
    def _library(self) -> TypeLibrary:
        from smarttestudo.bags.definitions import TypeLibrary  # noqa: PLC0415  most rules need none

        return TypeLibrary()


def _types_of(library: TypeLibrary, channel: Channel) -> Iterator[tuple[str, TypeDefinition]]:
    """The type of ``channel`` and those within it."""
    types: Typesdict = library.types_for(channel) or {}
    written = {} if channel.definition is None else dict(_written_constants(channel))
    for name, (constants, fields) in types.items():
        found = written.get(name) or {name: _value(value) for name, _, value in constants}
        yield (
            name,
            TypeDefinition(
                fields={field: _field_type(desc) for field, desc in fields},
                constants={name: value for name, value in found.items() if value is not None},
            ),
        )


def _written_constants(channel: Channel) -> Iterator[tuple[str, dict[str, Value | None]]]:
    """The constants of each type whose .msg text is in the definition."""
    from smarttestudo.bags.definition_text import sections  # noqa: PLC0415  as above

    for section in sections(channel.definition or "", channel.type_name):
        if not section.is_idl:
            lines = map(_CONSTANT.match, section.text.split("\n"))
            yield (
                full_type_name(section.name, ""),
                {line["name"]: _read(line["type"], line["value"]) for line in lines if line is not None},
            )


def _read(base: str, text: str) -> Value | None:
    """The value that a line of a .msg file gives a constant, ``None`` where it gives none."""
    if base in _TEXTS and (quoted := _QUOTED.match(text)):
        return quoted["text"]
    plain = text.partition("#")[0].strip()
    if base in _TEXTS:
        return plain
    try:
        return _TRUTHS[plain.lower()] if plain.lower() in _TRUTHS else float(int(plain, 0))
    except ValueError:
        pass
    try:
        return float(plain)
    except ValueError:
        return None


def _value(value: object) -> Value | None:
    if isinstance(value, str):
        return value
    return float(value) if isinstance(value, bool | int | float) else None


def _field_type(desc: FieldDesc) -> FieldType:
    from smarttestudo.bags.readable_types import inner_of  # noqa: PLC0415  as above

    inner = inner_of(desc)
    name = inner[1] if isinstance(inner[1], str) else cast("tuple[str, int]", inner[1])[0]
    return FieldType(name=name, is_array=inner is not desc)
