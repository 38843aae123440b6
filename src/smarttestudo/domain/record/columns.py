# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Records as rows of a table, with a column for each field.

A record within a row has a column for each of its own fields, under both names (``hold_rmse``), or under its
own where it is merged. Mappings, and fields that have no entry in JSON, have no column.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields, is_dataclass
from enum import Enum
from functools import cache
from types import UnionType
from typing import Annotated, Any, Union, get_args, get_origin, get_type_hints

from smarttestudo.domain.record.entry import JsonEntry, json_name, marks


@dataclass(frozen=True, slots=True, kw_only=True)
class _Field:
    """A field, the type of its values that are known, and what stands before the names of a record's."""

    name: str
    key: str
    kind: Any
    prefix: str


def column_types(kind: Any) -> dict[str, Any]:
    """The type of each column of a row that is a ``kind``, by its name; any value may be missing."""
    types: dict[str, Any] = {}
    for field in _fields(kind):
        if is_dataclass(field.kind):
            inner = column_types(field.kind)
            types |= {f"{field.prefix}{key}": of for key, of in inner.items()}
        else:
            types[field.key] = (
                str if isinstance(field.kind, type) and issubclass(field.kind, Enum) else field.kind
            )
    return types


def to_columns(row: object) -> dict[str, object]:
    """The values of ``row``, a record, by column; those of a merged record that is missing are left out."""
    values: dict[str, object] = {}
    kind: Any = type(row)
    for field in _fields(kind):
        value = getattr(row, field.name)
        if is_dataclass(field.kind):
            if value is not None:
                inner = to_columns(value)
            else:
                inner = dict.fromkeys(column_types(field.kind)) if field.prefix else {}
            values |= {f"{field.prefix}{key}": cell for key, cell in inner.items()}
        elif isinstance(value, Enum):
            values[field.key] = json_name(value)
        else:
            values[field.key] = list(value) if isinstance(value, tuple) else value
    return values


@cache
def _fields(kind: Any) -> tuple[_Field, ...]:
    return tuple(_columns_of(kind))


def _columns_of(kind: Any) -> Iterator[_Field]:
    hints = get_type_hints(kind, include_extras=True)
    for field in fields(kind):
        hint = hints[field.name]
        entry = next((mark for mark in marks(hint) if isinstance(mark, JsonEntry)), JsonEntry())
        known = _known(hint)
        key = entry.name or field.name
        is_mapping = isinstance(get_origin(known), type) and issubclass(get_origin(known), Mapping)
        if not (entry.is_absent or is_mapping):
            yield _Field(name=field.name, key=key, kind=known, prefix="" if entry.is_merged else f"{key}_")


def _known(hint: Any) -> Any:
    """``hint`` without its marks and ``None``."""
    if get_origin(hint) is Annotated:
        return _known(get_args(hint)[0])
    if get_origin(hint) in {Union, UnionType}:
        return _known(next(part for part in get_args(hint) if part is not type(None)))
    return hint
