# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Records: dataclasses as JSON and back, as the types of their fields say.

A field is an entry of the object under its own name, unless ``JsonEntry`` says otherwise. Enums stand by
their values, those of numbers by their names in lower case; tuples are lists, named ones are records,
mappings are objects; a class with ``to_json`` and ``from_json`` writes itself.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import MISSING, dataclass, fields, is_dataclass
from enum import Enum
from functools import cache
from types import UnionType
from typing import Annotated, Any, Literal, TypeVar, Union, cast, get_args, get_origin, get_type_hints

from smarttestudo.domain.json_text import PLAIN, read_any, read_mapping
from smarttestudo.domain.record.entry import (
    AtMost,
    Decimals,
    JsonEntry,
    Mark,
    Significant,
    derived_entry,
    json_name,
    marks,
)

_Value = TypeVar("_Value")
_Encode = Callable[[Any], object]
_Decode = Callable[[Any], Any]


def to_json(record: object) -> dict[str, Any]:
    """The object that ``record``, a dataclass or a named tuple, is in JSON."""
    writes_itself: Callable[[], dict[str, Any]] | None = getattr(record, "to_json", None)
    return entries_of(record) if writes_itself is None else writes_itself()


def entries_of(record: object) -> dict[str, Any]:
    """The object of its fields, for a record that writes itself."""
    kind: Any = type(record)
    return _class_of(kind).encode(record)


def from_json(kind: type[_Value], value: object) -> _Value:
    """The ``kind`` that a stranger's JSON ``value`` holds; raises ``ValueError`` where it holds none.

    What is absent has the field's default, or is ``None`` if the type allows it. What ``kind`` does not know
    is left out.
    """
    try:
        return cast("_Value", _class_of(cast("Any", kind)).decode(value))
    except RecursionError as error:
        raise ValueError("nested too deep") from error


_ALWAYS = object()
"""The default of an entry that is always written: equal to no value."""


@cache
def measured_names(kind: type) -> frozenset[str]:
    """The keys in the JSON of ``kind``, and of what it holds, under which measurements stand."""
    return frozenset(_class_of(kind).measured())


@cache
def _class_of(kind: type) -> _RecordClass:
    return _RecordClass(kind)


@dataclass(frozen=True, slots=True, kw_only=True)
class _EntryOf:
    """One field: its own default or what makes it, the converter of its value, and where it stands."""

    name: str
    own_default: object
    made_default: Any
    entry: JsonEntry
    value: _Converter

    @property
    def key(self) -> str:
        return self.entry.name or self.name

    @property
    def default(self) -> object:
        """The value where there is no entry; raises ``ValueError`` if one is needed."""
        if self.own_default is not MISSING:
            return self.own_default
        if self.made_default is not MISSING:
            return self.made_default()
        for null in self.value.null:
            return null
        raise ValueError(f"{self.key} is missing")


def _entries(kind: Any) -> Iterator[_EntryOf]:
    """The fields of a dataclass or a named tuple."""
    hints = get_type_hints(kind, include_extras=True)
    if is_dataclass(kind):
        defaults = {field.name: (field.default, field.default_factory) for field in fields(kind)}
    else:
        defaults = {name: (kind._field_defaults.get(name, MISSING), MISSING) for name in kind._fields}
    for name, (default, factory) in defaults.items():
        entry = next((mark for mark in marks(hints[name]) if isinstance(mark, JsonEntry)), JsonEntry())
        value = _converter(hints[name], entry)
        yield _EntryOf(name=name, own_default=default, made_default=factory, entry=entry, value=value)


class _RecordClass:
    """The plan of one dataclass or named tuple, made once."""

    def __init__(self, kind: type) -> None:
        self._kind = kind
        self._entries = [*_entries(kind)]
        self._plan = [
            (
                one.name,
                None if one.entry.is_merged or one.entry.is_rest else one.key,
                one.value.encode,
                one.default if one.entry.omits_default else _ALWAYS,
            )
            for one in self._entries
            if not one.entry.is_absent
        ]
        self._derived: list[tuple[str, str, _Encode | None, bool]] = []
        self._derived_measured: list[str] = []
        for attribute, member in vars(kind).items():
            getter = member.fget if isinstance(member, property) else None
            if getter is not None and (entry := derived_entry(getter)):
                value = _converter(get_type_hints(getter, include_extras=True)["return"], JsonEntry())
                self._derived.append((entry.name, attribute, value.encode, entry.omits_default))
                self._derived_measured += [entry.name] * value.is_measured
        self._signed = next((one.name for one in self._entries if one.entry.has_infinite), None)
        self.keys = frozenset((*self._own_keys(), *(name for name, *_ in self._derived)))

    def _own_keys(self) -> Iterator[str]:
        for entry in self._entries:
            if entry.entry.is_merged and entry.value.record is not None:
                yield from _class_of(entry.value.record).keys
            elif not entry.entry.is_rest:
                yield entry.key
        if self._signed is not None:
            yield INFINITE_KEY

    def encode(self, record: object) -> dict[str, Any]:
        written: dict[str, Any] = {}
        for field, key, encode, default in self._plan:
            value = getattr(record, field)
            if key is None:
                if value is not None:
                    written.update(cast("dict[str, Any]", encode(value) if encode else value))
            elif default is _ALWAYS:
                written[key] = value if value is None or encode is None else encode(value)
            elif value is not None and value != default:
                written[key] = value if encode is None else encode(value)
        if self._signed is not None and (signs := _signs(getattr(record, self._signed))):
            written[INFINITE_KEY] = signs
        for name, attribute, encode, omits_default in self._derived:
            value = getattr(record, attribute)
            if value or not omits_default:
                written[name] = value if value is None or encode is None else encode(value)
        return written

    def row(self, record: object) -> list[object]:
        return [
            value if (value := getattr(record, field)) is None or encode is None else encode(value)
            for field, _, encode, _ in self._plan
        ]

    def decode(self, value: object) -> object:
        if not isinstance(value, dict):
            raise ValueError(f"not an object: {str(value)[:40]}")  # noqa: TRY004 - a stranger's text
        found = {entry.name: self._read(entry, value) for entry in self._entries}
        if self._signed is not None and INFINITE_KEY in value:
            found[self._signed] = _with_signs(found[self._signed], value[INFINITE_KEY])
        return self._kind(**found)

    def decode_row(self, value: object) -> object:
        if not isinstance(value, list) or len(value) < len(self._plan):
            raise ValueError(f"not a list of {len(self._plan)}")
        keys = [key for _, key, _, _ in self._plan if key is not None]
        return self.decode(dict(zip(keys, value, strict=False)))

    def _read(self, of: _EntryOf, value: Mapping[str, object]) -> object:
        if of.entry.is_absent:
            return of.default
        if of.entry.is_rest:
            others = value.keys() - self.keys
            rest = {key: value[key] for key in sorted(others) if isinstance(value[key], dict)}
            return read_mapping(rest, read_any)
        if of.key not in value and not of.entry.is_merged:
            return of.default
        found = value if of.entry.is_merged else value[of.key]
        if found is None and of.value.null:
            return of.value.null[0]
        try:
            return of.value.decode(found)
        except ValueError as error:
            if of.entry.is_lenient:
                return of.default
            raise ValueError(f"{of.key}: {error}") from error

    def measured(self) -> Iterator[str]:
        for entry in self._entries:
            if entry.value.is_measured:
                yield entry.key
            if entry.value.record not in (None, self._kind):
                yield from _class_of(entry.value.record).measured()
        yield from self._derived_measured


INFINITE_KEY = "infinite"
_SIGNS = (math.inf, -math.inf)


def _signs(values: Mapping[str, float | None]) -> dict[str, str]:
    """The infinite ones of ``values`` by name: JSON has them as null, as unknown ones."""
    return {name: str(value) for name, value in values.items() if value in _SIGNS}


def _with_signs(values: Any, signs: object) -> Mapping[str, float | None]:
    """``values`` with the infinite ones. Raises ``ValueError``."""
    try:
        infinite = read_mapping(signs, _closed_set(("inf", "-inf")).decode)
    except ValueError as error:
        raise ValueError(f"{INFINITE_KEY}: {error}") from error
    return {**values, **{name: float(sign) for name, sign in infinite.items() if name in values}}


@dataclass(frozen=True, slots=True, kw_only=True)
class _Converter:
    """How a value is written and read; ``null`` holds what an absent one means, ``record`` is its class.

    Without ``encode`` it is written as it is, and ``None`` is written as null in any case.
    """

    encode: _Encode | None
    decode: _Decode
    null: tuple[object, ...] = ()
    is_measured: bool = False
    record: type | None = None


def _converter(hint: Any, entry: JsonEntry) -> _Converter:
    origin, parts = get_origin(hint), get_args(hint)
    if origin is Annotated:
        return _annotated(_converter(parts[0], entry), parts[1:])
    if origin in (Union, UnionType):
        return _optional([part for part in parts if part is not type(None)], entry)
    if origin in (tuple, frozenset):
        return _several(origin, parts, entry)
    if isinstance(hint, type) and hasattr(hint, "from_json"):
        return _Converter(encode=lambda value: value.to_json(), decode=hint.from_json, null=_null_of(hint))
    if origin is Literal or (isinstance(hint, type) and issubclass(hint, Enum)):
        return _closed_set(parts or tuple(hint))
    if origin is not None and issubclass(origin, Mapping):
        return _mapping(parts[1])
    if hint is object:
        return _Converter(encode=_any, decode=read_any)
    if _is_record(hint):
        return _record(cast("type", hint))
    return _Converter(encode=_finite_or_null if hint is float else None, decode=PLAIN[hint])


def _is_record(kind: Any) -> bool:
    return is_dataclass(kind) or hasattr(kind, "_fields")


def _any(value: object) -> object:
    return to_json(value) if is_dataclass(value) else value


def _closed_set(members: tuple[Any, ...]) -> _Converter:
    names = {member: json_name(member) for member in members}
    named = {name: one for one, name in names.items()}

    def read(value: object) -> object:
        if not isinstance(value, str) or value not in named:
            raise ValueError(f"none of {', '.join(named)}: {str(value)[:40]}")
        return named[value]

    return _Converter(encode=names.__getitem__, decode=read)


def _null_of(kind: Any) -> tuple[object, ...]:
    try:
        return (kind.from_json(None),)
    except ValueError:
        return ()


def _record(kind: type) -> _Converter:
    # Looked up when it is needed: a record may hold its own kind.
    return _Converter(encode=to_json, decode=lambda value: _class_of(kind).decode(value), record=kind)


def _optional(hints: list[Any], entry: JsonEntry) -> _Converter:
    converter = _converter(hints[0], entry)
    if hints[1:] == [str]:
        converter = _or_text(converter)
    return _Converter(
        encode=converter.encode,
        decode=lambda value: None if value is None else converter.decode(value),
        null=(None,),
        is_measured=converter.is_measured,
        record=converter.record,
    )


def _or_text(converter: _Converter) -> _Converter:
    encode = converter.encode or (lambda value: value)
    return _Converter(
        encode=lambda value: value if isinstance(value, str) else encode(value),
        decode=lambda value: value if isinstance(value, str) else converter.decode(value),
    )


def _annotated(converter: _Converter, extras: tuple[object, ...]) -> _Converter:
    encode, decode, null = converter.encode, converter.decode, converter.null
    for extra in extras:
        if isinstance(extra, Decimals):
            encode = _rounded(extra.digits)
        elif isinstance(extra, Significant):
            encode = _significant(extra.digits)
        elif isinstance(extra, AtMost):
            decode = _limited(decode, extra.most)
        elif extra is Mark.NULL_IS_INFINITE:
            null = (math.inf,)
    is_measured = converter.is_measured or Mark.MEASURED in extras
    return _Converter(
        encode=encode, decode=decode, null=null, is_measured=is_measured, record=converter.record
    )


def _rounded(digits: int) -> _Encode:
    return lambda value: _finite_or_null(round(value, digits))


def _significant(digits: int) -> _Encode:
    return lambda value: _finite_or_null(float(f"{value:.{digits}g}"))


def _finite_or_null(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _limited(decode: _Decode, most: float) -> _Decode:
    def read(value: object) -> object:
        number = decode(value)
        if not -most <= number <= most:
            raise ValueError(f"{str(number)[:40]} is out of range")
        return number

    return read


def _fixed(items: list[_Converter]) -> _Converter:
    """A tuple of so many values, each of its own type."""

    def read(value: object) -> object:
        if not isinstance(value, list) or len(value) != len(items):
            raise ValueError(f"not a list of {len(items)}")
        return tuple(one.decode(item) for one, item in zip(items, value, strict=True))

    return _Converter(
        encode=lambda value: [
            item if item is None or one.encode is None else one.encode(item)
            for one, item in zip(items, value, strict=True)
        ],
        decode=read,
    )


def _several(origin: type, parts: tuple[Any, ...], entry: JsonEntry) -> _Converter:
    if origin is tuple and parts[-1] is not ...:
        return _fixed([_converter(part, JsonEntry()) for part in parts])
    hint, converter = parts[0], _converter(parts[0], JsonEntry())
    encode, decode = converter.encode, converter.decode
    if entry.keyed_by:
        return _keyed(hint, entry.keyed_by)
    if entry.are_rows:
        encode, decode = _class_of(hint).row, _class_of(hint).decode_row

    def read(value: object) -> object:
        if not isinstance(value, list):
            raise ValueError("not a list")  # noqa: TRY004 - a stranger's text
        return origin(_understood(decode, value) if entry.is_lenient else map(decode, value))

    return _Converter(
        # A set has no order that would be the same tomorrow.
        encode=_each(encode, sorted if origin is frozenset else list),
        decode=read,
        is_measured=converter.is_measured,
        record=converter.record,
    )


def _each(encode: _Encode | None, ordered: Callable[[Any], list[Any]]) -> _Encode:
    if encode is None:
        return ordered
    return lambda value: [item if item is None else encode(item) for item in ordered(value)]


def _understood(decode: _Decode, values: list[object]) -> Iterator[object]:
    for value in values:
        try:
            yield decode(value)
        except ValueError:  # noqa: PERF203 - each item by itself
            continue


def _keyed(kind: type, field: str) -> _Converter:
    """A tuple of records as an object, without the field that is the key."""

    def encode(value: Any) -> object:
        return {
            getattr(one, field): {key: found for key, found in to_json(one).items() if key != field}
            for one in value
        }

    def decode(value: object) -> object:
        if not isinstance(value, dict):
            raise ValueError("not an object")  # noqa: TRY004 - a stranger's text
        return tuple(
            _class_of(kind).decode({**one, field: name} if isinstance(one, dict) else one)
            for name, one in value.items()
        )

    return _Converter(encode=encode, decode=decode, record=kind)


def _mapping(hint: Any) -> _Converter:
    converter = _converter(hint, JsonEntry())
    encode = converter.encode
    return _Converter(
        encode=dict
        if encode is None
        else lambda value: {name: None if found is None else encode(found) for name, found in value.items()},
        decode=lambda value: read_mapping(value, converter.decode),
        is_measured=converter.is_measured,
        record=converter.record,
    )
