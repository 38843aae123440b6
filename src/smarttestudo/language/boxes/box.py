# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Boxes: an interval for each signal; and how long to search among them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from smarttestudo.domain.signal import Signal
from smarttestudo.language.region import Region

Box = Mapping[Signal, Region]
"""All states whose signals lie in the given, never empty, regions; other signals may have any value."""

Domain = Callable[[Signal], Region]
"""The values that a signal can have."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Border:
    """Where two boxes meet without sharing a state: ``signal`` passes ``value``."""

    signal: Signal
    value: float


def common_box(first: Box, second: Box) -> Box | None:
    """The states in both boxes, ``None`` if there are none."""
    common = dict(first)
    for signal, region in second.items():
        mine = common.get(signal)
        if mine is not None:
            region = mine.intersection(region)  # noqa: PLW2901
            if region.is_empty:
                return None
        common[signal] = region
    return common


def border_between(first: Box, second: Box) -> Border | None:
    """Where one small step of one signal leads from ``first`` into ``second``.

    ``None`` for boxes that share a state, lie apart, or touch at a corner only.
    """
    shared = (signal for signal in first if signal in second)
    apart = [signal for signal in shared if first[signal].intersection(second[signal]).is_empty]
    if len(apart) != 1:
        return None
    signal = apart[0]
    ends = _ends(first[signal])
    value = next((value for value in _ends(second[signal]) if value in ends), None)
    return None if value is None else Border(signal=signal, value=value)


def _ends(region: Region) -> dict[float, None]:
    return dict.fromkeys(value for value, _ in region.cuts)


class TooComplexError(Exception):
    """A question that was given up because its effort was spent."""


class Effort:
    """The effort left, in looks at one region (about a microsecond each).

    Spending goes to ``parent`` as well, so that many questions share a common bound.
    """

    __slots__ = ("_left", "_parent")

    def __init__(self, looks: int, parent: Effort | None = None) -> None:
        self._left = looks
        self._parent = parent

    def spend(self, looks: int) -> None:
        """Count ``looks``; raises ``TooComplexError`` when there were not as many left."""
        self._left -= looks
        if self._left < 0:
            raise TooComplexError
        if self._parent is not None:
            self._parent.spend(looks)
