# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The form of a property, and fields of messages as properties."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass

Reader = Callable[[object], float]
"""Reads a decoded message; NaN stands for unknown."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PropertySpec:
    """A named property: its unit, what it means, and the least and greatest value it can take, if any.

    ``includes_minimum`` is false where the least value itself cannot occur: an angle lies in (−180, 180].
    """

    name: str
    unit: str
    meaning: str
    minimum: float | None = None
    maximum: float | None = None
    includes_minimum: bool = True


MOST = 1e100
"""Numbers beyond this are no measurements, and their squares would overflow."""
MESSAGE_PREFIX = "msg."
ANY = "[*]"
"""Stands for each element of an array."""
_FIELD = r"[A-Za-z][A-Za-z0-9_]*"
_ELEMENT = r'\[(?:-1|\d{1,9}|\*|"(?:[^"\\\r\n]|\\["\\]){1,200}")\]'
_PATH = re.compile(rf"{_FIELD}(?:{_ELEMENT})*(?:\.{_FIELD}(?:{_ELEMENT})*)*\Z")
_STEP = re.compile(rf"({_FIELD})|\[(\d+)\]")
_NAME = re.compile(r"[^\W\d]\w*\Z")


def is_field_path(text: str) -> bool:
    """Whether ``text`` is a field path: ROS field names joined by dots, with ``[i]`` behind arrays."""
    return _PATH.match(text) is not None


def is_property(text: str) -> bool:
    """Whether a rule may write ``text`` as a property: a field path, or a name that no message has."""
    return is_field_path(text) or _NAME.match(text) is not None


def field_reader(path: str) -> Reader:
    """Read the field at ``path``; missing, not numeric or beyond the end of an array is NaN.

    A leading ``msg.`` stands for the message itself, so that ``msg.rate`` reaches a field called ``rate``.
    """
    if not is_field_path(path):
        return lambda _message: math.nan  # The class of a message may have such an attribute all the same.
    read_part = part_reader(path)
    return lambda message: number(read_part(message))


def part_reader(path: str) -> Callable[[object], object]:
    """Read the part of a message at ``path``, of any type; missing or beyond an array's end is ``None``.

    A ``byte`` is a number, as it is of a recording: rclpy has it as bytes of length one.
    """
    steps = _steps(path.removeprefix(MESSAGE_PREFIX))

    def read(message: object) -> object:
        value = message
        for step in steps:
            value = _item(value, step) if isinstance(step, int) else getattr(value, step, None)
        return value[0] if isinstance(value, bytes) and len(value) == 1 else value

    return read


def _steps(path: str) -> tuple[str | int, ...]:
    return tuple(name or int(index) for name, index in _STEP.findall(path))


def _item(value: object, index: int) -> object:
    if isinstance(value, str | bytes) or not hasattr(value, "__getitem__"):
        return None
    try:
        item: object = value[index]
    except (IndexError, KeyError, TypeError):
        return None
    return item


def number(value: object) -> float:
    """The number that ``value`` is to a check: NaN of a text, an array or anything else that is not one."""
    if value is None or hasattr(value, "__len__"):
        return math.nan
    try:
        return float(value)  # type: ignore[arg-type]
    except (ArithmeticError, TypeError, ValueError):
        return math.nan
