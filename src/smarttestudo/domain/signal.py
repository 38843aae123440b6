# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Signals that checks read, and the truth of a check."""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum, IntEnum
from typing import NamedTuple

from smarttestudo.domain.names import is_source


class SignalKind(IntEnum):
    """How a property is read, by what it is compared with."""

    NUMBER = 0
    """As a number, which turns stale."""
    STATE = 1
    """As a number that stands for a word: true, false or a constant. It lasts while there is a publisher."""
    TEXT = 2
    """As a text, which lasts likewise."""
    UNRESOLVED = 3
    """Compared with a constant that no known type has: always unknown."""


class Signal(NamedTuple):
    """One property of one topic, for instance ``/odom pose_x``; ``topic`` is the full resolved name.

    A property that is compared with numbers and with texts is two signals. A tuple, because signals are
    looked up for every message that checks read.
    """

    topic: str
    property: str
    kind: SignalKind = SignalKind.NUMBER

    @staticmethod
    def named(name: str) -> Signal:
        """The signal of that name, as of one that is read as a number."""
        topic, _, name = name.partition(" ")
        return Signal(topic, name)

    def __str__(self) -> str:
        """The signal's name in decisions."""
        return f"{self.topic} {self.property}"


MAX_TEXT_BYTES = 1000
"""As long may a text be that a rule compares with, in UTF-8."""

Value = float | str
"""A signal's value at an instant."""

Values = Value | tuple[Value, ...]
"""That of a signal with ``[*]`` is the values of all elements."""


def shown_value(
    values: Values | None, is_compared: Callable[[Value], bool] = lambda _value: False
) -> Value | None:
    """The value that people see: of several the first that ``is_compared``, else the first."""
    if isinstance(values, tuple):
        return next(filter(is_compared, values), values[0] if values else None)
    return values


class ArrivalProperty(Enum):
    """Properties of every topic that need no message decoded and are never unknown."""

    RATE = "rate"
    BANDWIDTH = "bandwidth"
    AGE = "age"

    @staticmethod
    def named(name: str) -> ArrivalProperty | None:
        """The arrival property called ``name``, if it is one."""
        return next((member for member in ArrivalProperty if member.value == name), None)

    @staticmethod
    def of(signal: Signal) -> ArrivalProperty | None:
        """The arrival property that ``signal`` is; none of the machine or the link is one."""
        return None if is_source(signal.topic) else ArrivalProperty.named(signal.property)


class Truth(Enum):
    """Kleene's three values, ordered false < unknown < true: AND is the least, OR the greatest."""

    FALSE = 0
    UNKNOWN = 1
    TRUE = 2
