# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Any numeric field of a message by its path, for instance ``pose.pose.position.x`` or ``ranges[0]``."""

from __future__ import annotations

import math
import re

from smarttestudo.adirf.properties.spec import Reader

MESSAGE_PREFIX = "msg."
_FIELD = r"[A-Za-z][A-Za-z0-9_]*"
_PATH = re.compile(rf"{_FIELD}(?:\[\d{{1,9}}\])*(?:\.{_FIELD}(?:\[\d{{1,9}}\])*)*\Z")
_STEP = re.compile(rf"({_FIELD})|\[(\d+)\]")


def is_field_path(text: str) -> bool:
    """Whether ``text`` is a field path: ROS field names joined by dots, with ``[i]`` behind arrays."""
    return _PATH.match(text) is not None


def field_reader(path: str) -> Reader:
    """Read the field at ``path``; missing, not numeric or beyond the end of an array is NaN.

    A leading ``msg.`` stands for the message itself, so that ``msg.rate`` reaches a field called ``rate``.
    """
    steps = _steps(path.removeprefix(MESSAGE_PREFIX))

    def read(message: object) -> float:
        value: object = message
        for step in steps:
            value = _item(value, step) if isinstance(step, int) else getattr(value, step, None)
        return _number(value)

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


def _number(value: object) -> float:
    if value is None or hasattr(value, "__len__"):
        return math.nan
    try:
        return float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        return math.nan
