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
from smarttestudo.link.protocol.wire import Reader, varint, zigzag

Leaf = None | bool | int | float | str | dict[str, object] | list[object]
"""A value of JSON without parts: objects and arrays are empty ones."""

_MOST_EXACT = 2**53
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
            data += varint((place - last - 1) << _KIND_BITS | kind) + body
            last = place
    return bytes(data)


def with_changes(before: Sequence[Leaf], data: bytes) -> list[Leaf]:
    """``before`` with the changes in ``data``. Raises ``LinkError`` where they do not fit."""
    after = [*before]
    reader, place = Reader(data), -1
    while not reader.is_at_end:
        header = reader.varint()
        place += (header >> _KIND_BITS) + 1
        if place >= len(after):
            raise LinkError("a status changes what it does not have")
        after[place] = _changed(after[place], _Kind(header & (1 << _KIND_BITS) - 1), reader)
    return after


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
        (kind, zigzag(kinds[kind]) * (kind is _Kind.SCALED) + zigzag(difference))
        for kind, difference in ways.items()
        if abs(difference) < _TOO_LARGE
    ]
    return min(bodies, key=lambda way: len(way[1])) if bodies else _text_change(new)


def _text_change(new: Leaf) -> tuple[_Kind, bytes]:
    text = json_text(new, ascii_only=False).encode()
    return _Kind.TEXT, varint(len(text)) + text


def _changed(old: Leaf, kind: _Kind, reader: Reader) -> Leaf:
    if kind is _Kind.NULL:
        return None
    if kind is _Kind.TEXT:
        return _read_text(reader.take(reader.count(_MAX_TEXT_BYTES)))
    before = _scaled(old) or (0, 0)
    exponent = before[1]
    if kind is _Kind.SCALED:
        exponent = reader.zigzag()
        if abs(exponent) > _MAX_EXPONENT:
            raise LinkError("a status has a number that is too large")
    return _number(_at_exponent(before, exponent) + reader.zigzag(), exponent)


def _read_text(data: bytes) -> Leaf:
    value: Leaf
    try:
        value = json.loads(data)
    except (ValueError, RecursionError) as error:
        raise LinkError("a status has a text that is not readable") from error
    if isinstance(value, dict | list) and value:
        raise LinkError("a status has parts where it had none")
    return value


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
