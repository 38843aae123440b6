# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Signals that checks read, and the truth of a check."""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple


class Signal(NamedTuple):
    """One property of one topic, for instance ``/odom pose_x``; ``topic`` is the full resolved name.

    A tuple, because signals are looked up for every message that checks read.
    """

    topic: str
    property: str

    def __str__(self) -> str:
        """The signal's name in decisions."""
        return f"{self.topic} {self.property}"


class ArrivalProperty(Enum):
    """Properties of every topic that need no message decoded and are never unknown."""

    RATE = "rate"
    BANDWIDTH = "bandwidth"
    AGE = "age"

    @staticmethod
    def named(name: str) -> ArrivalProperty | None:
        """The arrival property called ``name``, if it is one."""
        return next((member for member in ArrivalProperty if member.value == name), None)


class Truth(Enum):
    """Kleene's three values, ordered false < unknown < true: AND is the least, OR the greatest."""

    FALSE = 0
    UNKNOWN = 1
    TRUE = 2
