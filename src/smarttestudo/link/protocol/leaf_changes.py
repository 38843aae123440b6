# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What changed between two equally long lists of JSON leaves, in few bytes.

Each change is a header (how many leaves before it stay, and its kind) and what it needs. A number is sent
as the difference to the one before, in units of the last decimal place of either.
"""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from decimal import Decimal
from enum import IntEnum

from smarttestudo.domain.errors import LinkError
from smarttestudo.domain.json_text import json_text

Leaf = None | bool | int | float | str | dict[str, object] | list[object]
"""A value of JSON without parts: objects and arrays are empty ones."""

_MOST_EXACT = 2**53
_MAX_VARINT_BYTES = 10
_MAX_EXPONENT = 18
_MAX_TEXT_BYTES = 100_000
_TOO_LARGE = 2**62


class _Kind(IntEnum):
    NUMBER = 0
    """A difference, in units of the last decimal place of the number before."""
    SCALED = 1
    """A decimal exponent and a difference in units of it."""
    TEXT = 2
    """Anything, as JSON with its length."""
    NULL = 3


_KIND_BITS = 2
_Scaled = tuple[int, int]
"""A number as an integer and the exponent of ten that it is multiplied by."""


def changes_to_bytes(before: Sequence[Leaf], after: Sequence[Leaf]) -> bytes:
    """What makes ``before`` into ``after``."""
    data = bytearray()
    last = -1
    for place, (old, new) in enumerate(zip(before, after, strict=True)):
        if not _is_same(old, new):
            kind, body = _change(old, new)
            data += write_varint((place - last - 1) << _KIND_BITS | kind) + body
            last = place
    return bytes(data)


def with_changes(before: Sequence[Leaf], data: bytes) -> list[Leaf]:
    """``before`` with the changes in ``data``. Raises ``LinkError`` where they do not fit."""
    after = [*before]
    place, begin = -1, 0
    while begin < len(data):
        header, begin = read_varint(data, begin)
        place += (header >> _KIND_BITS) + 1
        if place >= len(after):
            raise LinkError("a status changes what it does not have")
        after[place], begin = _changed(after[place], _Kind(header & (1 << _KIND_BITS) - 1), data, begin)
    return after


def write_varint(number: int) -> bytes:
    """A number that is not negative, seven bits a byte."""
    data = bytearray()
    while number > 0x7F:
        data.append(number & 0x7F | 0x80)
        number >>= 7
    data.append(number)
    return bytes(data)


def read_varint(data: bytes, begin: int) -> tuple[int, int]:
    """What ``write_varint`` wrote at ``begin``, and where it ends. Raises ``LinkError``."""
    number = 0
    for place, byte in enumerate(data[begin : begin + _MAX_VARINT_BYTES]):
        number |= (byte & 0x7F) << 7 * place
        if byte < 0x80:
            return number, begin + place + 1
    raise LinkError("a status ends in a number, or has one that is too large")


def _is_same(old: Leaf, new: Leaf) -> bool:
    return old == new and isinstance(old, bool) == isinstance(new, bool)


def _change(old: Leaf, new: Leaf) -> tuple[_Kind, bytes]:
    if new is None or (isinstance(new, float) and not math.isfinite(new)):
        return _Kind.NULL, b""
    scaled = _scaled(new)
    if scaled is None:
        return _text_change(new)
    before = _scaled(old) or (0, 0)
    kinds = {_Kind.SCALED: scaled[1], _Kind.NUMBER: before[1]}
    ways = {
        kind: _at_exponent(scaled, exponent) - _at_exponent(before, exponent)
        for kind, exponent in kinds.items()
        if exponent <= scaled[1]
    }
    bodies = [
        (kind, _zigzag(kinds[kind]) * (kind is _Kind.SCALED) + _zigzag(difference))
        for kind, difference in ways.items()
        if abs(difference) < _TOO_LARGE
    ]
    return min(bodies, key=lambda way: len(way[1])) if bodies else _text_change(new)


def _text_change(new: Leaf) -> tuple[_Kind, bytes]:
    text = json_text(new, ascii_only=False).encode()
    return _Kind.TEXT, write_varint(len(text)) + text


def _changed(old: Leaf, kind: _Kind, data: bytes, begin: int) -> tuple[Leaf, int]:
    before = _scaled(old) or (0, 0)
    if kind is _Kind.NULL:
        return None, begin
    if kind is _Kind.TEXT:
        return _read_text(data, begin)
    exponent = before[1]
    if kind is _Kind.SCALED:
        exponent, begin = _read_zigzag(data, begin)
        if abs(exponent) > _MAX_EXPONENT:
            raise LinkError("a status has a number that is too large")
    difference, begin = _read_zigzag(data, begin)
    return _number(_at_exponent(before, exponent) + difference, exponent), begin


def _read_text(data: bytes, begin: int) -> tuple[Leaf, int]:
    size_bytes, begin = read_varint(data, begin)
    end = begin + size_bytes
    if size_bytes > _MAX_TEXT_BYTES or end > len(data):
        raise LinkError("a status ends within a text")
    try:
        value = json.loads(data[begin:end])
    except (ValueError, RecursionError) as error:
        raise LinkError("a status has a text that is not readable") from error
    if isinstance(value, dict | list) and value:
        raise LinkError("a status has parts where it had none")
    return value, end


def _scaled(leaf: Leaf) -> _Scaled | None:
    """A number without trailing zeros; ``None`` for what is none, or too large or small for this way."""
    if isinstance(leaf, bool) or not isinstance(leaf, int | float):
        return None
    if not math.isfinite(leaf) or abs(leaf) >= (_MOST_EXACT if isinstance(leaf, float) else _TOO_LARGE):
        return None
    sign, digits, exponent = Decimal(repr(leaf)).normalize().as_tuple()
    number = int("".join(map(str, digits)))
    if not isinstance(exponent, int) or abs(exponent) > _MAX_EXPONENT:
        return None
    return (-number if sign else number), exponent if number else 0


def _at_exponent(scaled: _Scaled, exponent: int) -> int:
    """The number in units of that power of ten, rounded down."""
    shift = scaled[1] - exponent
    return scaled[0] * _power(shift) if shift >= 0 else scaled[0] // _power(-shift)


def _number(number: int, exponent: int) -> int | float:
    if exponent >= 0:
        return number * _power(exponent)
    whole, rest = divmod(number, _power(-exponent))
    return float(f"{number}e{exponent}") if rest else whole


def _power(exponent: int) -> int:
    power: int = 10**exponent
    return power


def _zigzag(number: int) -> bytes:
    return write_varint(2 * number if number >= 0 else -2 * number - 1)


def _read_zigzag(data: bytes, begin: int) -> tuple[int, int]:
    number, begin = read_varint(data, begin)
    return (number >> 1) if not number & 1 else -((number + 1) >> 1), begin
