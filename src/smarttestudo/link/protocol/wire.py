# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Frames, as which everything travels between the two ends of a link.

A frame is a byte with the version, a byte with its kind, and a body. A body is the fields of a value in their
order: whole numbers as LEB128 (zigzag), texts and collections after their length, a choice after its place.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields, is_dataclass
from enum import IntEnum
from types import NoneType, UnionType
from typing import Any, Generic, NamedTuple, TypeVar, Union, get_args, get_origin, get_type_hints

from smarttestudo.domain.errors import LinkError

WIRE_VERSION = 7
"""Frames began with version 3: statuses of version 1 began with 1 or 2."""
HEAD_BYTES = 2
"""The version and the kind."""
COMPRESSED = 0x80
"""Marks the kind of a frame whose body travels compressed."""
MAX_ITEMS = 4_096
"""How many items a collection of a body may have."""

_FIRST_VERSION = 3
_LAST_VERSION = 31
"""No frame of any version begins with more."""
_MAX_VARINT_BYTES = 10
_MAX_NUMBER = 2**64
_DOUBLE = struct.Struct("<d")
_Value = TypeVar("_Value")


class Kind(IntEnum):
    """The kinds of frames."""

    CHUNK = 1
    REPORT = 2
    CONTROL = 3
    STATUS_CHANGES = 5
    COMMAND = 6
    COMMAND_REPORT = 7
    READING_QUESTION = 8
    CHANGING_QUESTION = 9
    ANSWER = 10
    REFUSAL = 11
    ASK = 12
    INCIDENT_LIST = 13
    INCIDENT_PLAN = 14
    PART = 15
    DATAGRAM_REQUEST = 16
    DATAGRAM_OFFER = 17
    PING = 18

    @property
    def words(self) -> str:
        """The name in a sentence."""
        return self.name.lower().replace("_", " ")


def other_version(data: bytes) -> int | None:
    """The version of a frame of another version than ours; ``None`` for one of ours and for anything else."""
    first = data[0] if data else 0
    if first in (0, WIRE_VERSION) or first > _LAST_VERSION:
        return None
    return first if first >= _FIRST_VERSION else 1


def version_sentence(peer: str, version: int) -> str:
    """The line for a user whose ``peer`` speaks another version."""
    older = "at the other end" if version < WIRE_VERSION else "here"
    return (
        f"{peer} speaks version {version} of the link's protocol, and this end version {WIRE_VERSION}; "
        f"update SmartTestudo {older}"
    )


def malformed(what: str) -> LinkError:
    """The error for bytes that are no message."""
    return LinkError(f"a message over the link is malformed: {what:.200}")


def frame(kind: Kind, body: bytes) -> bytes:
    return bytes((WIRE_VERSION, kind)) + body


def kind_of(data: bytes) -> int:
    """The kind of a frame. Raises ``LinkError`` for what is no frame of this version."""
    version = other_version(data)
    if version is not None:
        raise LinkError(
            f"a message has version {version} of the link's protocol, not {WIRE_VERSION}",
            remedy="use the same version of SmartTestudo at both ends",
        )
    if len(data) < HEAD_BYTES or data[0] != WIRE_VERSION:
        raise malformed("no frame")
    return data[1]


def varint(number: int) -> bytes:
    """A number that is not negative, seven bits a byte, the lowest first."""
    data = bytearray()
    while number > 0x7F:
        data.append(number & 0x7F | 0x80)
        number >>= 7
    data.append(number)
    return bytes(data)


def zigzag(number: int) -> bytes:
    """A number with its sign, as one without: 0, -1, 1 and -2 are 0, 1, 2 and 3."""
    return varint(2 * number if number >= 0 else -2 * number - 1)


class Reader:
    """The rest of a body. Every method raises ``LinkError`` where something else stands there."""

    __slots__ = ("_at", "_data")

    def __init__(self, data: bytes, begin: int = 0) -> None:
        self._data = data
        self._at = begin

    @property
    def is_at_end(self) -> bool:
        return self._at >= len(self._data)

    def varint(self) -> int:
        """The number that ``varint`` wrote, in as few bytes as it does."""
        number = 0
        for place, byte in enumerate(self._data[self._at : self._at + _MAX_VARINT_BYTES]):
            number |= (byte & 0x7F) << 7 * place
            if byte < 0x80:
                if place and not byte:
                    break
                self._at += place + 1
                return number
        raise malformed("a number that is too large or ends too early")

    def zigzag(self) -> int:
        """The number that ``zigzag`` wrote."""
        number = self.varint()
        return (number >> 1) if not number & 1 else -((number + 1) >> 1)

    def count(self, most: int) -> int:
        """The length of what follows, at most ``most``."""
        count = self.varint()
        if count > most:
            raise malformed("a length that is too large")
        return count

    def read(self, size_bytes: int) -> bytes:
        end = self._at + size_bytes
        if end > len(self._data):
            raise malformed("an end that comes too early")
        data, self._at = self._data[self._at : end], end
        return data

    def rest(self) -> bytes:
        return self.read(len(self._data) - self._at)


class FrameType(Generic[_Value]):
    """Values of one type, by their annotations, as frames of one ``kind``.

    Dataclasses and named tuples of numbers, texts, bytes, collections and choices of these may travel.
    ``check`` raises ``ValueError`` for a value that may not come from outside.
    """

    def __init__(
        self,
        kind: Kind,
        value: object,
        check: Callable[[_Value], object] = lambda _: None,
        *,
        most_bytes: int = 1_000_000,
    ) -> None:
        self._kind = kind
        self._codec = _codec(value)
        self._check = check
        self._most_bytes = most_bytes

    def to_bytes(self, value: _Value) -> bytes:
        """The frame of ``value``. Raises ``LinkError`` for one that is too large."""
        body = bytearray()
        self._codec.write(body, value)
        if len(body) + HEAD_BYTES > self._most_bytes:
            raise LinkError(f"{len(body)} bytes are too many for one {self._kind.words} over a link")
        return frame(self._kind, bytes(body))

    def from_bytes(self, data: bytes) -> _Value:
        """The value that ``to_bytes`` gave ``data`` for. Raises ``LinkError`` for anything else."""
        if kind_of(data) != self._kind or len(data) > self._most_bytes:
            raise malformed(f"no {self._kind.words}")
        reader = Reader(data, HEAD_BYTES)
        try:
            value: _Value = self._codec.read(reader)
            self._check(value)
        except (ValueError, OverflowError) as error:
            raise malformed(f"{self._kind.words} with {error}") from error
        if not reader.is_at_end:
            raise malformed(f"{self._kind.words} with more than belongs to it")
        return value


class _Codec(NamedTuple):
    write: Callable[[bytearray, Any], None]
    read: Callable[[Reader], Any]


def _codec(kind: Any) -> _Codec:
    """How values of an annotation travel."""
    origin, arguments = get_origin(kind), get_args(kind)
    if kind in _SIMPLE:
        return _SIMPLE[kind]
    if origin in (Union, UnionType):
        return _choice(arguments)
    if origin is not None and issubclass(origin, Mapping):
        return _collection(dict, _fixed(arguments), lambda value: value.items())
    if origin is tuple and arguments[-1] is not Ellipsis:
        return _fixed(arguments)
    if origin is frozenset:
        return _collection(frozenset, _codec(arguments[0]), sorted)
    if origin is not None and issubclass(origin, Sequence):
        return _collection(tuple, _codec(arguments[0]), tuple)
    return _record(kind)


def _write_number(data: bytearray, number: int) -> None:
    if abs(number) >= _MAX_NUMBER:
        raise LinkError("a number is too large to be sent over a link")
    data += zigzag(number)


def _read_number(reader: Reader) -> int:
    number = reader.zigzag()
    if abs(number) >= _MAX_NUMBER:
        raise malformed("a number that is too large or ends too early")
    return number


def _read_flag(reader: Reader) -> bool:
    return bool(reader.count(1))


def _write_bytes(data: bytearray, value: bytes) -> None:
    data += varint(len(value)) + value


def _read_bytes(reader: Reader) -> bytes:
    return reader.read(reader.varint())


_SIMPLE: Mapping[object, _Codec] = {
    NoneType: _Codec(lambda _data, _value: None, lambda _: None),
    bool: _Codec(lambda data, value: data.append(value), _read_flag),
    int: _Codec(_write_number, _read_number),
    float: _Codec(
        lambda data, value: data.extend(_DOUBLE.pack(value)),
        lambda reader: _DOUBLE.unpack(reader.read(_DOUBLE.size))[0],
    ),
    bytes: _Codec(_write_bytes, _read_bytes),
    str: _Codec(
        lambda data, value: _write_bytes(data, value.encode("utf-8", "replace")),
        lambda reader: _read_bytes(reader).decode(),
    ),
}


def _fixed(kinds: Sequence[Any]) -> _Codec:
    """A tuple with a value of each."""
    codecs = [_codec(kind) for kind in kinds]

    def write(data: bytearray, values: Sequence[Any]) -> None:
        for codec, value in zip(codecs, values, strict=True):
            codec.write(data, value)

    return _Codec(write, lambda reader: tuple([codec.read(reader) for codec in codecs]))


def _record(kind: Any) -> _Codec:
    """The fields of a dataclass or of a named tuple."""
    hints = get_type_hints(kind)
    names = [field.name for field in fields(kind)] if is_dataclass(kind) else list(kind._fields)
    all_fields = _fixed([hints[name] for name in names])
    return _Codec(
        lambda data, value: all_fields.write(data, [getattr(value, name) for name in names]),
        lambda reader: kind(**dict(zip(names, all_fields.read(reader), strict=True))),
    )


def _collection(make: Callable[[list[Any]], Any], item: _Codec, items: Callable[[Any], Any]) -> _Codec:
    def write(data: bytearray, value: Any) -> None:
        if len(value) > MAX_ITEMS:
            raise LinkError(f"{len(value)} items are too many to be sent over a link")
        data += varint(len(value))
        for one in items(value):
            item.write(data, one)

    def read(reader: Reader) -> Any:
        read_items = [item.read(reader) for _ in range(reader.count(MAX_ITEMS))]
        value = make(read_items)
        if len(value) != len(read_items):
            raise ValueError("something twice")
        return value

    return _Codec(write, read)


def _choice(kinds: Sequence[Any]) -> _Codec:
    codecs = [_codec(kind) for kind in kinds]
    places = {get_origin(kind) or kind: place for place, kind in enumerate(kinds)}
    # A whole number may stand in the place of a float, and a list in that of a tuple.
    other = [*places.values()][0 if kinds[0] is not NoneType else 1]
    places.setdefault(list, places.get(tuple, other))

    def write(data: bytearray, value: Any) -> None:
        is_of = (place for kind, place in places.items() if isinstance(value, kind))
        place = places[type(value)] if type(value) in places else next(is_of, other)
        data.append(place)
        codecs[place].write(data, value)

    return _Codec(write, lambda reader: codecs[reader.count(len(codecs) - 1)].read(reader))
