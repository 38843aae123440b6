# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Fields of a message type that checks can read by their path, and the words that these can be equal to."""

from __future__ import annotations

from collections.abc import Iterator
from enum import Enum
from itertools import islice

from msgspec import Struct

from smarttestudo.domain.type_definition import FieldType, TypeDefinition
from smarttestudo.language.known_types import KnownTypes
from smarttestudo.language.properties.field_path import ANY

MOST_FIELDS = 60
_DEEPEST = 4
_TIME = "builtin_interfaces/msg/"
_HEADER = "std_msgs/msg/Header"
_SMALL = frozenset({"int8", "uint8", "byte", "char", "octet"})
"""Constants that are called otherwise than a field are of one that is no count."""


class FieldKind(Enum):
    """The content of a field; the value is its name in JSON."""

    NUMBER = "number"
    TEXT = "text"
    TRUTH = "truth"


class KnownField(Struct, frozen=True, kw_only=True):
    """A field by its path, with the words that rules may compare it with beside numbers and texts."""

    path: str
    kind: FieldKind
    words: tuple[str, ...] = ()


def kind_of(field: FieldType) -> FieldKind | None:
    """The kind of a field, ``None`` of one that is a message."""
    if field.is_text:
        return FieldKind.TEXT
    if field.is_truth:
        return FieldKind.TRUTH
    return None if field.is_message else FieldKind.NUMBER


def known_fields(types: KnownTypes, type_name: str) -> tuple[KnownField, ...]:
    """The fields of a type, in its order; of arrays those of any element. At most 60, without stamps."""
    return tuple(islice(_fields(types, type_name, "", 0), MOST_FIELDS))


def _fields(types: KnownTypes, type_name: str, before: str, depth: int) -> Iterator[KnownField]:
    definition = types.definition(type_name)
    if definition is None or depth == _DEEPEST:
        return
    for name, field in definition.fields.items():
        kind = kind_of(field)
        if kind is not None and not field.is_array:
            yield KnownField(path=before + name, kind=kind, words=words_of(definition, name, field))
        if kind is not None or field.name.startswith(_TIME) or field.name == _HEADER:
            continue
        # One element of any a path is what the language has.
        if not field.is_array:
            yield from _fields(types, field.name, f"{before}{name}.", depth + 1)
        elif ANY not in before:
            yield from _fields(types, field.name, f"{before}{name}{ANY}.", depth + 1)


def words_of(definition: TypeDefinition, name: str, field: FieldType) -> tuple[str, ...]:
    """The words that field ``name`` can be equal to: true and false, or the constants that belong to it."""
    kind = kind_of(field)
    if kind is FieldKind.TRUTH:
        return ("true", "false")
    if kind is None or field.name.startswith(("float", "double")):
        return ()
    own = [
        constant
        for constant, value in definition.constants.items()
        if isinstance(value, str) == (kind is FieldKind.TEXT)
    ]
    begin = f"{name.upper()}_"
    named = tuple(constant for constant in own if constant.startswith(begin))
    if named or (kind is FieldKind.NUMBER and field.name not in _SMALL):
        return named
    others = tuple(f"{other.upper()}_" for other in definition.fields if other != name)
    return tuple(constant for constant in own if not constant.startswith(others))
