# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The rate that a rule asks for: hertz, Full, Off, or a QUPER quality level."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum


class Tier(Enum):
    """A quality level; the value is its name in a rule file, the order that of rising quality."""

    UNACCEPTABLE = "Unacceptable"
    MARGINAL = "Marginal"
    ACCEPTABLE = "Acceptable"
    DESIRABLE = "Desirable"
    COMPETITIVE = "Competitive"
    EXCESSIVE = "Excessive"

    level: int
    """0 for Unacceptable … 5 for Excessive."""

    def __init__(self, _: str) -> None:
        self.level = len(type(self).__members__)


MAX_RATE_HZ = 1e6
MIN_SOURCE_HZ = 1e-6
"""A profile holds no rate of a source below it."""
SLOW_HZ = 1.0
"""A topic whose source is no faster needs no levels: a map, or frames that stay."""
RATE_STEP_HZ = 0.001
"""Optimized rates are whole steps of this; a profile holds no rate below it but 0."""


@dataclass(frozen=True, slots=True, order=True)
class Rate:
    """Messages per second. Rates order by ``hz``; ``Off`` sorts just below a plain 0.

    ``hz`` is infinite for Full (every message passes) and 0 for Off (none does).
    ``yields_to_floor`` is false only for a written ``Off``, which ``KeepAtLeast`` does not raise.
    """

    hz: float
    yields_to_floor: bool = True

    @property
    def is_full(self) -> bool:
        """Whether every message passes."""
        return math.isinf(self.hz)

    @property
    def is_off(self) -> bool:
        """Whether nothing passes."""
        return self.hz == 0

    @staticmethod
    def full() -> Rate:
        """Every message passes."""
        return Rate(math.inf)

    @staticmethod
    def off() -> Rate:
        """The rate at which nothing passes, whatever the floor."""
        return Rate(0.0, yields_to_floor=False)

    def at_least(self, floor_hz: float) -> Rate:
        """This rate raised to ``floor_hz``, unless it is a written Off."""
        return Rate(floor_hz) if self.yields_to_floor and self.hz < floor_hz else self

    def to_json(self) -> float | None:
        """Hertz, or ``None`` for Full, as decisions and ``--json`` write it."""
        return None if self.is_full else self.hz

    @staticmethod
    def from_json(hz: object) -> Rate:
        """The rate that ``to_json`` gave ``hz`` for; a written Off comes back as a plain 0.

        Raises ``ValueError`` where it gave it for none.
        """
        if hz is None:
            return Rate.full()
        if not isinstance(hz, int | float) or isinstance(hz, bool) or not 0 <= hz <= MAX_RATE_HZ:
            raise ValueError(f"no rate: {str(hz)[:40]}")
        return Rate(float(hz))

    def __str__(self) -> str:
        """The rate with its unit, as in a rule file."""
        if self.is_full:
            return "Full"
        return f"{self.hz:g} Hz" if self.yields_to_floor else "Off"
