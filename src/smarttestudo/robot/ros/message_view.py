# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Messages whose fields are read where they stand in the serialized bytes, and only when they are asked for.

Plain CDR as ROS 2 writes it: each number is aligned to its size, counted from the end of the encapsulation
header (OMG DDS-XTYPES 1.3, 7.4.1). What stands before a field is passed over, by the lengths that it has.
"""

from __future__ import annotations

import struct
import sys
from array import array
from collections.abc import Callable, Iterable, Sequence
from functools import lru_cache
from typing import Any, Protocol

_ENCAPSULATION_BYTES = 4
_ORDERS = {b"\x00\x01": "<", b"\x00\x00": ">"}
_NATIVE = "<" if sys.byteorder == "little" else ">"
_CODES = {
    "boolean": "?",
    "octet": "B",
    "char": "B",
    "float": "f",
    "double": "d",
    **{f"int{bits}": code for bits, code in ((8, "b"), (16, "h"), (32, "i"), (64, "q"))},
    **{f"uint{bits}": code for bits, code in ((8, "B"), (16, "H"), (32, "I"), (64, "Q"))},
}
_LAYOUTS_KEPT = 1024

FindType = Callable[[str], Any]
"""Finds the class that rosidl made for a message type, by its name."""


class UnknownLayoutError(Exception):
    """Messages of a type hold what is not read here: wide characters, or a long double."""


class _Kind(Protocol):
    """Kind of a field: ``skip`` and ``read`` are given where the field before it ends."""

    def skip(self, data: memoryview, at: int) -> int:
        """Where the field ends."""

    def read(self, data: memoryview, at: int) -> object:
        """Its value."""


class _Fixed:
    """Bytes of a size that is known, of which the first number has that alignment."""

    __slots__ = ("alignment", "size_bytes")

    def __init__(self, alignment: int, size_bytes: int) -> None:
        self.alignment = alignment
        self.size_bytes = size_bytes

    def start(self, at: int) -> int:
        return (at + self.alignment - 1) & -self.alignment

    def skip(self, data: memoryview, at: int) -> int:  # noqa: ARG002 - as of other kinds
        return ((at + self.alignment - 1) & -self.alignment) + self.size_bytes


class _Number(_Fixed):
    __slots__ = ("_struct",)

    def __init__(self, code: str, order: str) -> None:
        self._struct = struct.Struct(order + code)
        super().__init__(self._struct.size, self._struct.size)

    def read(self, data: memoryview, at: int) -> object:
        (value,) = self._struct.unpack_from(data, self.start(at))
        return value


class _Sequence:
    """The length of a sequence, or the ``length`` that an array always has."""

    __slots__ = ("_length", "_uint32")

    def __init__(self, length: int | None, order: str) -> None:
        self._length = length
        self._uint32 = struct.Struct(f"{order}I")

    def begin(self, data: memoryview, at: int) -> tuple[int, int]:
        """How many items there are, and where the length ends."""
        if self._length is not None:
            return self._length, at
        at = (at + 3) & -4
        (length,) = self._uint32.unpack_from(data, at)
        if length > len(data):
            raise struct.error
        return length, at + self._uint32.size


class _Text:
    __slots__ = ("_sequence",)

    def __init__(self, order: str) -> None:
        self._sequence = _Sequence(None, order)

    def skip(self, data: memoryview, at: int) -> int:
        length, at = self._sequence.begin(data, at)
        return at + length

    def read(self, data: memoryview, at: int) -> str:
        length, at = self._sequence.begin(data, at)
        return bytes(data[at : at + length]).partition(b"\0")[0].decode("utf-8", "replace")


class _Numbers:
    """An array or a sequence of numbers."""

    __slots__ = ("_code", "_is_swapped", "_number", "_sequence")

    def __init__(self, code: str, length: int | None, order: str) -> None:
        # array.array has no booleans, which are bytes.
        self._code = "B" if code == "?" else code
        self._number = _Number(code, order)
        self._is_swapped = order != _NATIVE
        self._sequence = _Sequence(length, order)

    def skip(self, data: memoryview, at: int) -> int:
        length, at = self._sequence.begin(data, at)
        return self._number.start(at) + length * self._number.size_bytes if length else at

    def read(self, data: memoryview, at: int) -> array[Any]:
        length, at = self._sequence.begin(data, at)
        start = self._number.start(at)
        values = array(self._code)
        values.frombytes(data[start : start + length * self._number.size_bytes])
        if self._is_swapped:
            values.byteswap()
        return values


class _Items:
    """An array or a sequence of texts or messages."""

    __slots__ = ("_item", "_sequence")

    def __init__(self, item: _Kind, length: int | None, order: str) -> None:
        self._item = item
        self._sequence = _Sequence(length, order)

    def skip(self, data: memoryview, at: int) -> int:
        length, at = self._sequence.begin(data, at)
        for _ in range(length):
            at = self._item.skip(data, at)
        return at

    def read(self, data: memoryview, at: int) -> list[object]:
        length, at = self._sequence.begin(data, at)
        values = []
        for _ in range(length):
            values.append(self._item.read(data, at))
            at = self._item.skip(data, at)
        return values


class _Message:
    """Layout of a type: each of its ``fields`` with the steps to it, and its kind."""

    __slots__ = ("_end", "fields", "parts")

    def __init__(self, kinds: Sequence[tuple[str, _Kind]]) -> None:
        # A message without fields is one byte.
        self.parts: Sequence[_Kind | _Fixed] = _parts(kind for _, kind in kinds) or (_Fixed(1, 1),)
        self._end = _steps(self.parts)
        self.fields = {
            name: (_steps(_parts(kind for _, kind in kinds[:place])), kind)
            for place, (name, kind) in enumerate(kinds)
        }

    def skip(self, data: memoryview, at: int) -> int:
        for skip in self._end:
            at = skip(data, at)
        return at

    def read(self, data: memoryview, at: int) -> MessageView:
        return MessageView(self, data, at)


def _parts(kinds: Iterable[_Kind]) -> list[_Kind | _Fixed]:
    """The kinds in a row; those of messages within are in their place."""
    return [part for kind in kinds for part in (kind.parts if isinstance(kind, _Message) else (kind,))]


def _steps(parts: Iterable[_Kind | _Fixed]) -> tuple[Callable[[memoryview, int], int], ...]:
    """As few steps as it takes to pass over ``parts``."""
    steps: list[_Kind | _Fixed] = []
    for part in parts:
        last = steps[-1] if steps else None
        if isinstance(part, _Fixed) and isinstance(last, _Fixed):
            is_aligned = part.alignment <= last.alignment and last.size_bytes % part.alignment == 0
            if is_aligned:
                steps[-1] = _Fixed(last.alignment, last.size_bytes + part.size_bytes)
                continue
        steps.append(part)
    return tuple(step.skip for step in steps)


class MessageView:
    """A message within serialized bytes; its fields are attributes."""

    __slots__ = ("_at", "_data", "_layout")

    def __init__(self, layout: _Message, data: memoryview, at: int) -> None:
        self._layout = layout
        self._data = data
        self._at = at

    def __getattr__(self, name: str) -> object:
        try:
            steps, kind = self._layout.fields[name]
        except KeyError:
            raise AttributeError(name) from None
        at = self._at
        for skip in steps:
            at = skip(self._data, at)
        return kind.read(self._data, at)

    def get_fields_and_field_types(self) -> Iterable[str]:
        """The names of its fields, as of a message of rclpy's."""
        return tuple(self._layout.fields)


def message_view(kind: Any, payload: bytes, find_type: FindType) -> MessageView:
    """View of a message of the class that rosidl made.

    Raises ``UnknownLayoutError`` for a type of which something is not read here, ``ValueError`` where
    ``payload`` is no such message.
    """
    order = _ORDERS.get(payload[:2])
    if order is None:
        raise ValueError("it is not serialized as plain CDR")
    layout, data = _layout(kind, order, find_type), memoryview(payload)[_ENCAPSULATION_BYTES:]
    try:
        is_whole = layout.skip(data, 0) <= len(data)
    except struct.error:
        is_whole = False
    if not is_whole:
        raise ValueError("it ends too early")
    return layout.read(data, 0)


@lru_cache(maxsize=_LAYOUTS_KEPT)
def _layout(kind: Any, order: str, find_type: FindType) -> _Message:
    names = kind.get_fields_and_field_types()
    types = zip(names, kind.SLOT_TYPES, strict=True)
    return _Message([(name, _kind(one, order, find_type)) for name, one in types])


def _kind(field: Any, order: str, find_type: FindType) -> _Kind:
    """The kind of a field that rosidl's parser describes so."""
    if hasattr(field, "value_type"):
        length = getattr(field, "size", None)
        code = _CODES.get(getattr(field.value_type, "typename", ""))
        if code is not None:
            return _Numbers(code, length, order)
        return _Items(_kind(field.value_type, order, find_type), length, order)
    if hasattr(field, "namespaces"):
        return _layout(find_type("/".join((*field.namespaces, field.name))), order, find_type)
    if hasattr(field, "typename"):
        code = _CODES.get(field.typename)
        if code is None:
            raise UnknownLayoutError
        return _Number(code, order)
    if "WString" in type(field).__name__:
        raise UnknownLayoutError
    return _Text(order)
