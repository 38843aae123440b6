# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The values of signals in messages: numbers, texts, those of named and of all elements of an array."""

from __future__ import annotations

import math
from array import array
from collections.abc import Callable, Iterable
from typing import Any, TypeVar

from smarttestudo.domain.profile import LevelUnit
from smarttestudo.domain.signal import MAX_TEXT_BYTES, Signal, SignalKind, Value, Values
from smarttestudo.language.properties.field_path import (
    ANY,
    Absence,
    EachElement,
    ElementName,
    is_array,
    is_field_path,
    number,
    part_at,
    path_steps,
)
from smarttestudo.language.properties.readers import known_elements, known_only
from smarttestudo.language.properties.table import properties_of, value_reader

SignalReader = Callable[[object], Values | None]
"""Reads a decoded message: NaN stands for unknown, ``None`` for an element that it does not have."""

_Read = TypeVar("_Read", float, Value)


def reads_element(property_name: str) -> bool:
    """Whether other messages may come between two that have what ``property_name`` reads."""
    return any(isinstance(step, ElementName) for step in _before_each(property_name))


def signal_reader(type_name: str, signal: Signal, level_unit: LevelUnit | None = None) -> SignalReader:
    """Read ``signal`` of messages of ``type_name``. A reader belongs to one topic."""
    name = signal.property
    is_text = signal.kind is SignalKind.TEXT
    if not is_text and (name in properties_of(type_name) or not _reads_elements(name)):
        return value_reader(type_name, name, level_unit)
    if not is_field_path(name):
        return lambda _message: math.nan
    convert: Callable[[object], Value] = text if is_text else number
    if ANY in name:
        return _each_reader(type_name, name, convert)
    steps = path_steps(name)

    def read(message: object) -> Values | None:
        part = part_at(message, steps)
        return None if part is Absence.ELEMENT else convert(part)

    return known_only(type_name, name, read)


def _reads_elements(name: str) -> bool:
    return any(isinstance(step, ElementName | EachElement) for step in path_steps(name))


def _before_each(name: str) -> Iterable[object]:
    steps = path_steps(name)
    return steps[: steps.index(EachElement.STEP)] if EachElement.STEP in steps else steps


def _each_reader(type_name: str, path: str, convert: Callable[[object], Value]) -> SignalReader:
    """Read the different values of all elements, in the order in which they come first.

    Unknown ones do not count, but where all are unknown, so are these.
    """
    steps = path_steps(path)
    if steps.count(EachElement.STEP) > 1:
        return lambda _message: math.nan
    is_known = known_elements(type_name, path)

    def read(message: object) -> Values | None:
        parts = part_at(message, steps)
        if parts is Absence.ELEMENT:
            return None
        if not is_array(parts):
            return math.nan
        known = tuple(value for value in _different(parts, convert) if not _is_nan(value))
        if is_known is not None:
            known = tuple(filter(is_known(message), known))
        return known if known or not len(parts) else math.nan  # type: ignore[arg-type]

    return known_only(type_name, path, read)


def _is_nan(value: Value) -> bool:
    return value != value  # noqa: PLR0124 - NaN differs from itself


def _different(parts: Any, convert: Callable[[object], Value]) -> Iterable[Value]:
    """The different values of ``parts``; of large arrays of numbers as fast as Python can."""
    if isinstance(parts, array):
        return map(convert, dict.fromkeys(parts))
    if hasattr(parts, "tolist"):
        return map(convert, dict.fromkeys(parts.tolist()))
    return dict.fromkeys(map(convert, map(_whole_byte, parts)))


def _whole_byte(part: object) -> object:
    """A ``byte`` as a number: rclpy has it as bytes of length one."""
    return part[0] if isinstance(part, bytes) and len(part) == 1 else part


def text(part: object) -> Value:
    """The text that ``part`` of a message is, NaN of anything else.

    An array of bytes is one, as PX4 has it. A text ends before its first zero byte. One that is longer than
    any that a rule can write is cut, which makes it no such text.
    """
    if not isinstance(part, str):
        found = _bytes(part)
        if found is None:
            return math.nan
        part = found.partition(b"\0")[0].decode("utf-8", "replace")
    shown = part[: MAX_TEXT_BYTES + 1].partition("\0")[0]
    return shown if len(shown) <= MAX_TEXT_BYTES else f"{shown[:MAX_TEXT_BYTES]}…"


_MOST_BYTES = 4 * (MAX_TEXT_BYTES + 1)
"""As many as the characters of a text can take that is cut."""


def _bytes(part: object) -> bytes | None:
    """The first bytes of an array of such; ``None`` of anything else."""
    if isinstance(part, bytes | bytearray):
        return bytes(part[:_MOST_BYTES]) if len(part) != 1 else None
    if isinstance(part, array):
        return part[:_MOST_BYTES].tobytes() if part.typecode == "B" else None
    if getattr(getattr(part, "dtype", None), "char", "") == "B":
        return part[:_MOST_BYTES].tobytes()  # type: ignore[index,no-any-return]
    if isinstance(part, list) and part and isinstance(part[0], bytes):
        return b"".join(part[:_MOST_BYTES])
    return None
