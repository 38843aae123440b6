# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Boxes: states of the robot in which each of some signals lies in a region."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from smarttestudo.adirf.region import Region
from smarttestudo.domain.signal import Signal

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
