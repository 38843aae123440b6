# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a node says of its health, in the words of diagnostic_msgs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum


class DiagnosticLevel(IntEnum):
    """The levels of diagnostic_msgs/msg/DiagnosticStatus."""

    OK = 0
    WARN = 1
    ERROR = 2
    STALE = 3


@dataclass(frozen=True, slots=True, kw_only=True)
class Diagnostic:
    """One diagnostic_msgs/msg/DiagnosticStatus: ``name`` is what it is about, ``values`` are for reading."""

    name: str
    level: DiagnosticLevel
    message: str
    hardware_id: str
    values: Mapping[str, str]
