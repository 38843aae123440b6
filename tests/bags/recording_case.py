# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What is right of a recording that others made."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from bags.recorded_by_others import COUNT

FAR = (
    'begin\nSetFrequency {topic} 1\nRule "far" If CheckValue {topic} {name} >= {limit} Then '
    "SetFrequency {topic} Full EndIf\nend\n"
)
HALF = (53, 62)
"""Messages that pass of a drive: five until 5 m, what settles, and all 50 after."""


def far(topic: str = "/odom", name: str = "pose_x", limit: float = 5) -> str:
    return FAR.format(topic=topic, name=name, limit=limit)


@dataclasses.dataclass(frozen=True, kw_only=True)
class Case:
    """A recording and what every command says of it.

    ``said`` has, for each notice of info and rates, words that are in it; ``also_said`` those of one command.
    ``left_out`` are topics that nobody can decode, with a word of the reason; ``curves`` a property of each
    topic that is measured; ``passes`` what a replay with ``rules`` lets through.
    """

    name: str
    make: Callable[[Path], Path]
    messages: Mapping[str, int]
    duration_s: float | None = None
    rates_hz: Mapping[str, float] = dataclasses.field(default_factory=dict)
    curves: Mapping[str, str] = dataclasses.field(default_factory=dict)
    left_out: Mapping[str, str] = dataclasses.field(default_factory=dict)
    rules: str = far()
    passes: Mapping[str, tuple[int, int]] = dataclasses.field(default_factory=dict)
    findings: frozenset[str] = frozenset()
    said: Sequence[Sequence[str]] = ()
    also_said: Mapping[str, Sequence[Sequence[str]]] = dataclasses.field(default_factory=dict)
    is_quiet: bool = True
    is_whole: bool = True
    is_readable_by_others: bool = True


def a_drive(name: str, make: Callable[[Path], Path], **more: Any) -> Case:
    """A case whose only topic is the drive, or whose other topics are in ``more``."""
    usual: dict[str, Any] = {
        "messages": {"/odom": COUNT},
        "rates_hz": {"/odom": 10},
        "curves": {"/odom": "pose_x"},
        "passes": {"/odom": HALF},
    }
    return Case(name=name, make=make, **{**usual, **more})
