# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The form of a property, and fields of messages as properties."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Any

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
_STEP = re.compile(rf'({_FIELD})|\[(?:(-?\d+)|(\*)|"((?:[^"\\]|\\.)*)")\]')
_ESCAPE = re.compile(r"\\(.)")
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

    A ``byte`` is a number, as it is of a recording: rclpy has it as bytes of length one. With ``[*]`` it is
    a list of the parts of all elements.
    """
    steps = path_steps(path)
    if any(isinstance(step, ElementName | EachElement) for step in steps):

        def read_elements(message: object) -> object:
            part = part_at(message, steps)
            if isinstance(part, list):
                return [None if isinstance(each, Absence) else each for each in part]
            return None if isinstance(part, Absence) else part

        return read_elements
    plain = [step for step in steps if isinstance(step, str | int)]

    def read(message: object) -> object:
        value = message
        for step in plain:
            value = _item(value, step) if isinstance(step, int) else getattr(value, step, None)
        return value[0] if isinstance(value, bytes) and len(value) == 1 else value

    return read


@dataclass(frozen=True, slots=True)
class ElementName:
    """A step to the element of an array that has this name."""

    text: str


class EachElement(Enum):
    """A step to each element of an array."""

    STEP = ANY


class Absence(Enum):
    """Why a message has no part at a path."""

    PART = "part"
    """It has no such field, or the array ends before."""
    ELEMENT = "element"
    """No element has that name in this message."""


Step = str | int | ElementName | EachElement


def path_steps(path: str) -> tuple[Step, ...]:
    """The steps of a field path, without the ``msg.`` that may stand before it."""
    return tuple(map(_step, _STEP.finditer(path.removeprefix(MESSAGE_PREFIX))))


def _step(found: re.Match[str]) -> Step:
    field, index, each, name = found.groups()
    if field is not None:
        return field
    if index is not None:
        return int(index)
    return EachElement.STEP if each else ElementName(_ESCAPE.sub(r"\1", name))


def part_at(message: object, steps: Sequence[Step]) -> object:
    """The part of a message that ``steps`` lead to, a list of those of each element, or why it is missing."""
    around, part = None, message
    for number, step in enumerate(steps):
        before = part
        if isinstance(step, str):
            part = getattr(part, step, Absence.PART)
        elif isinstance(step, int):
            part = _item(part, step)
        elif isinstance(step, ElementName):
            part = _named(around, part, step.text)
        else:
            return _each(part, steps[number + 1 :])
        if part is None or isinstance(part, Absence):
            return part or Absence.PART
        around = before
    return part[0] if isinstance(part, bytes) and len(part) == 1 else part


def _item(value: object, index: int) -> object:
    if isinstance(value, str | bytes) or not hasattr(value, "__getitem__"):
        return None
    try:
        item: object = value[index]
    except (IndexError, KeyError, TypeError):
        return None
    return item


def _each(array: Any, steps: Sequence[Step]) -> object:
    if not is_array(array):
        return Absence.PART
    return [part_at(element, steps) for element in array] if steps else array


def is_array(part: object) -> bool:
    """Whether ``part`` is an array of a message; a text is none."""
    return hasattr(part, "__getitem__") and hasattr(part, "__len__") and not isinstance(part, str)


def _named(around: object, array: Any, name: str) -> object:
    """The first element of ``array`` called ``name``, by its own field or by the texts beside the array."""
    if not is_array(array):
        return Absence.PART
    if len(array) and (hasattr(array[0], "name") or hasattr(array[0], "key")):
        return next((element for element in array if name in _names(element)), Absence.ELEMENT)
    names = getattr(around, "name", None)
    if not isinstance(names, Sequence) or isinstance(names, str):
        return Absence.PART if len(array) else Absence.ELEMENT
    place = names.index(name) if name in names else len(array)
    return array[place] if place < len(array) else Absence.ELEMENT


def _names(element: object) -> Iterator[str]:
    for field in ("name", "key"):
        name = getattr(element, field, None)
        if isinstance(name, str):
            yield name


def number(value: object) -> float:
    """The number that ``value`` is to a check: NaN of a text, an array or anything else that is not one."""
    if value is None or hasattr(value, "__len__"):
        return math.nan
    try:
        return float(value)  # type: ignore[arg-type]
    except (ArithmeticError, TypeError, ValueError):
        return math.nan
