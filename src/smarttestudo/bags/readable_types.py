# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Types whose messages are read as rclpy reads them, where rosbags reads otherwise or not at all."""

from __future__ import annotations

import re
import struct
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any, cast

from rosbags.interfaces import Nodetype
from rosbags.serde import SerdeError
from rosbags.typesys import Stores, get_typestore

from smarttestudo.domain.units import grouped

if TYPE_CHECKING:
    from rosbags.interfaces.typing import FieldDesc, Typesdict
    from rosbags.typesys.store import Typestore

BROKEN_MESSAGE = (SerdeError, struct.error, LookupError, ArithmeticError, ValueError, TypeError, MemoryError)
"""What rosbags' generated code raises on bytes that are no message of the type."""

_ENCAPSULATIONS = (b"\0\0", b"\0\1")
_OTHERS = {2: "parameter lists", 3: "parameter lists", **dict.fromkeys(range(6, 12), "XCDR2")}
_ENCAPSULATION_BYTES = 4
_TEXT, _CHARACTER, _LONG_DOUBLE = "testudo/Text", "testudo/Character", "testudo/LongDouble"
_WIDE_TEXT, _WIDE_CHARACTER = "testudo/WideText", "testudo/WideCharacter"
_STANDS_FOR = {"wstring": _WIDE_TEXT, "wchar": _WIDE_CHARACTER, "float128": _LONG_DOUBLE}
# Bytes of each character of a wide text, and of one alone: Fast CDR 2, Fast CDR 1, and as XTypes has it.
_WIDTHS = ((4, 2), (4, 4), (2, 2))
_SAME_BYTES = {"byte": "uint8", "char": "uint8"}
_LAST_UNIT = 0xFFFF


def other_encapsulation(payload: bytes) -> str | None:
    """Why a message that says itself not to be plain CDR is not decoded; ``None`` where it is."""
    if len(payload) < _ENCAPSULATION_BYTES or payload[:2] in _ENCAPSULATIONS:
        return None
    of = _OTHERS.get(int.from_bytes(payload[:2], "big"), "no known format")
    return f"they are of {of} (encapsulation {payload[:2].hex(' ')}), and only CDR is decoded"


class ReadableType:
    """A type whose messages can be read; ``unread`` are the paths of its fields that cannot.

    Raises what rosbags raises where one of its fields is of a type that is not among ``types``.
    """

    def __init__(self, types: Typesdict, name: str, *, is_idl: bool) -> None:
        self._name = name
        self._types = types_within(types, name)
        # The char of a .msg file is a number, that of an .idl file a character.
        self._stands_for = {**_STANDS_FOR, "char": _CHARACTER} if is_idl else _STANDS_FOR
        self._stores = self._stores_for(self._stands_for)
        self._stores[0].get_msgdef(name)
        self.unread = tuple(_paths_of_long_doubles(self._types, name))

    def read(self, payload: bytes) -> object:
        """The message of CDR. Raises one of ``BROKEN_MESSAGE``."""
        try:
            return self._read(payload, self._stores)
        except SerdeError as error:
            if not isinstance(error.__cause__, UnicodeDecodeError):
                raise
            return self._read(payload, self._lenient_stores)

    def _read(self, payload: bytes, stores: Sequence[Typestore]) -> object:
        failures: list[Exception] = []
        for store in stores:
            try:
                return store.deserialize_cdr(payload, self._name)
            except BROKEN_MESSAGE as error:  # noqa: PERF203  there is one store unless characters are wide
                failures.append(error)
        if payload[:2] in _ENCAPSULATIONS:
            # Where sequences are empty, rclpy's serialize_message leaves bytes at the end that mean nothing.
            definition = stores[0].get_msgdef(self._name)
            read = definition.deserialize_cdr_le if payload[1] else definition.deserialize_cdr_be
            with suppress(*BROKEN_MESSAGE):
                return read(payload[4:], 0, definition.cls, stores[0])[0]
        raise failures[0]

    @cached_property
    def _lenient_stores(self) -> Sequence[Typestore]:
        """Stores that read texts of another encoding as rclpy does, at a higher cost."""
        return self._stores_for({**self._stands_for, "string": _TEXT})

    def _stores_for(self, stands_for: Mapping[str, str]) -> Sequence[Typestore]:
        descs = [desc for _, fields in self._types.values() for _, desc in fields]
        is_wide = any(_base(desc) in {"wstring", "wchar"} for desc in descs)
        return [_store(self._types, stands_for, *widths) for widths in _WIDTHS[: None if is_wide else 1]]


def _store(types: Typesdict, stands_for: Mapping[str, str], of_text: int, of_character: int) -> Typestore:
    """Types with the fields of some base types replaced: what a message is made by may return anything."""
    made: Mapping[str, tuple[FieldDesc, Callable[[Any], object]]] = {
        _TEXT: (_sequence("uint8"), lambda units: units[:-1].tobytes().decode("utf-8", "replace")),
        _CHARACTER: (_of_base("uint8"), chr),
        _WIDE_TEXT: (_sequence(f"uint{8 * of_text}"), _wide_text),
        _WIDE_CHARACTER: (_of_base(f"uint{8 * of_character}"), chr),
        _LONG_DOUBLE: (_array("uint64", 2), lambda _: None),
    }
    replace = partial(_replaced, stands_for=stands_for)
    replaced = {
        name: (
            [constant for constant in constants if constant[1] not in _STANDS_FOR],
            [(field, with_inner(desc, replace)) for field, desc in fields],
        )
        for name, (constants, fields) in types.items()
    }
    store = empty_store()
    store.register({**replaced, **{name: ([], [("value", desc)]) for name, (desc, _) in made.items()}})
    store.types.update({name: cast("Any", make) for name, (_, make) in made.items()})
    return store


def empty_store() -> Typestore:
    """A store without types; rosbags' has times as ROS 2 defines them, and takes no others."""
    store = get_typestore(Stores.EMPTY)
    store.fielddefs.clear()
    store.types.clear()
    return store


def _wide_text(units: Any) -> str:
    """The text of an array of numpy."""
    if units.size and units.max() > _LAST_UNIT:
        raise ValueError("the characters of a wide text have two bytes here")
    text: str = units.astype("uint16").tobytes().decode("utf-16")
    return text


def types_within(types: Typesdict, name: str) -> Typesdict:
    """A type and those of its fields, however deep. Raises ``KeyError`` for one that is not there."""
    found: Typesdict = {}
    to_add = [name]
    while to_add:
        one = to_add.pop()
        if one not in found:
            found[one] = types[one]
            inner = [inner_of(desc) for _, desc in types[one][1]]
            to_add += [each[1] for each in inner if each[0] == Nodetype.NAME]
    return found


def nest_at_most(types: Typesdict, deepest: int) -> bool:
    """Whether no type holds another within another, and so on, more often; one within itself does."""
    left = {name: {inner_of(desc)[1] for _, desc in fields} for name, (_, fields) in types.items()}
    for _ in range(deepest):
        left = {name: inner for name, inner in left.items() if not inner.isdisjoint(left)}
    return not left


def layout(types: Typesdict, name: str) -> tuple[object, ...]:
    """The names and kinds of all fields of a type and, in their place, of the types within it."""
    return tuple((field.lower(), _layout(types, desc)) for field, desc in types[name][1])


def _layout(types: Typesdict, desc: FieldDesc) -> object:
    inner = inner_of(desc)
    count = cast("Any", desc[1])[1] if desc[0] == Nodetype.ARRAY else 0
    base = _base(inner)
    of = layout(types, cast("str", inner[1])) if base is None else _SAME_BYTES.get(base, base)
    return int(desc[0]), count, of


def with_inner(desc: FieldDesc, replace: Callable[[FieldDesc], FieldDesc]) -> FieldDesc:
    """A field of another type, or an array or a sequence of it."""
    if desc[0] in {Nodetype.ARRAY, Nodetype.SEQUENCE}:
        inner, length = cast("Any", desc[1])
        return cast("FieldDesc", (desc[0], (replace(inner), length)))
    return replace(desc)


def _paths_of_long_doubles(types: Typesdict, name: str, prefix: str = "") -> Iterator[str]:
    for field, desc in types[name][1]:
        inner = inner_of(desc)
        path = f"{prefix}{field}"
        if inner[0] == Nodetype.NAME:
            yield from _paths_of_long_doubles(types, inner[1], f"{path}.")
        elif _base(desc) == "float128":
            yield path


def _replaced(inner: FieldDesc, stands_for: Mapping[str, str]) -> FieldDesc:
    base = _base(inner) or ""
    if base == "byte":
        # rosbags reads it as a number with a sign.
        return _of_base("uint8")
    return (Nodetype.NAME, stands_for[base]) if base in stands_for else inner


def inner_of(desc: FieldDesc) -> FieldDesc:
    """The field, or what an array or a sequence is of."""
    return cast("Any", desc[1])[0] if desc[0] in {Nodetype.ARRAY, Nodetype.SEQUENCE} else desc


def _base(desc: FieldDesc) -> str | None:
    inner = inner_of(desc)
    return cast("Any", inner[1])[0] if inner[0] == Nodetype.BASE else None


def _of_base(base: str) -> FieldDesc:
    return cast("FieldDesc", (Nodetype.BASE, (base, 0)))


def _sequence(base: str) -> FieldDesc:
    return cast("FieldDesc", (Nodetype.SEQUENCE, (_of_base(base), 0)))


def _array(base: str, length: int) -> FieldDesc:
    return cast("FieldDesc", (Nodetype.ARRAY, (_of_base(base), length)))


MAX_STATEMENTS = 5000
MAX_VALUES = 5000
_MSG_STATEMENT = re.compile(r"^[ \t]*[^\s#]", re.MULTILINE)
_IDL_STATEMENT = re.compile("[;@]")
_IDL_TEXT = re.compile(r'"(?:[^"\\\n]|\\.)*"')
# rosbags tries each way to read what is nested, time and again.
_IDL_NESTED = re.compile(r"\([^()]*\(|(?:sequence\s*<\s*){5}")


def require_few_statements(definition: str, *, is_idl: bool) -> None:
    """Raise ``ValueError`` for a definition whose text takes seconds to read."""
    code = _IDL_TEXT.sub("", definition) if is_idl else definition
    statements = (_IDL_STATEMENT if is_idl else _MSG_STATEMENT).finditer(code)
    if sum(1 for _ in statements) > MAX_STATEMENTS:
        raise ValueError(f"the definition has more than {grouped(MAX_STATEMENTS)} statements")
    if is_idl and _IDL_NESTED.search(code):
        raise ValueError("the definition nests parentheses or sequences too deep")


def require_few_values(types: Typesdict, name: str) -> None:
    """Raise ``ValueError`` where a message has too many values beside its sequences and arrays of numbers.

    Raises ``RecursionError`` for a type that contains itself.
    """
    counts: dict[str, int] = {}

    def count(one: str) -> int:
        if one not in counts:
            counts[one] = sum(of_field(desc) for _, desc in types[one][1])
        return counts[one]

    def of_field(desc: Any) -> int:
        inner: Any = inner_of(desc)
        is_number = inner[0] == Nodetype.BASE and inner[1][0] != "string"
        length: int = desc[1][1] if desc[0] == Nodetype.ARRAY and not is_number else 1
        return length * (count(inner[1]) if inner[0] == Nodetype.NAME else 1)

    if count(name) > MAX_VALUES:
        raise ValueError(f"a message has more than {grouped(MAX_VALUES)} values")
