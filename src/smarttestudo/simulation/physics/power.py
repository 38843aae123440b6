# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The battery of a robot."""

from __future__ import annotations

from dataclasses import dataclass

_FULL_V_SHARE = 1.13
_EMPTY_V_SHARE = 0.90


@dataclass(frozen=True, slots=True, kw_only=True)
class BatteryType:
    """A battery: its nominal voltage, and its charge when it is full."""

    nominal_v: float
    capacity_ah: float


class BatteryCharge:
    """Charge left in a battery, whose voltage falls in proportion to that."""

    __slots__ = ("current_a", "share", "type")

    def __init__(self, battery: BatteryType, percent: float) -> None:
        self.type = battery
        self.share = percent / 100
        self.current_a = 0.0

    @property
    def voltage_v(self) -> float:
        """Between the poles now."""
        sagging = _FULL_V_SHARE - _EMPTY_V_SHARE
        return self.type.nominal_v * (_EMPTY_V_SHARE + sagging * self.share)

    @property
    def is_empty(self) -> bool:
        """Whether nothing is left."""
        return self.share <= 0.0

    def draw(self, power_w: float, dt_s: float) -> None:
        """Take ``power_w`` for ``dt_s``."""
        self.current_a = 0.0 if self.is_empty else power_w / self.voltage_v
        self.share = max(0.0, self.share - self.current_a * dt_s / 3600 / self.type.capacity_ah)
