# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""One numeric field over time."""

from __future__ import annotations

import itertools
import math
from array import array
from collections.abc import Iterable
from dataclasses import dataclass

FULL_TURN = 360.0
MOST = 1e100
"""Numbers beyond this are no measurements, and their squares would overflow."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Series:
    """Values with their stamps, which never fall; a value that is not known is NaN.

    The field has a value from its sample on until the next one. Of several samples with one stamp the last
    counts. ``wraps`` says that the values are degrees in (−180, 180] that go round.
    """

    stamps_ns: array[int]
    values: array[float]
    wraps: bool = False

    @property
    def unknown(self) -> int:
        """How many samples are not known."""
        return sum(map(math.isnan, self.values))

    @property
    def value_range(self) -> float:
        """Greatest minus least known value; of a field that wraps, of its continuous course, up to 360."""
        known: Iterable[float] = itertools.filterfalse(math.isnan, self.values)
        if self.wraps:
            known = itertools.accumulate(known, lambda course, value: course + turn(course, value))
        listed = list(known)
        spread = max(listed) - min(listed) if listed else 0.0
        return min(spread, FULL_TURN) if self.wraps else spread

    def known(self) -> Series:
        """The samples that are known."""
        if not self.unknown:
            return self
        kept = [not math.isnan(value) for value in self.values]
        return Series(
            stamps_ns=array("q", itertools.compress(self.stamps_ns, kept)),
            values=array("d", itertools.compress(self.values, kept)),
            wraps=self.wraps,
        )

    def taken(self, stamps_ns: array[int], indices: array[int]) -> Series:
        """The samples at ``indices``, which were received at ``stamps_ns``."""
        values = self.values
        return Series(
            stamps_ns=stamps_ns, values=array("d", [values[index] for index in indices]), wraps=self.wraps
        )


def usable(value: float) -> float:
    """``value``, or NaN where it is infinite or absurd."""
    return value if -MOST < value < MOST else math.nan


def turn(before: float, after: float) -> float:
    """The shorter way from one angle to another, in degrees of [−180, 180]."""
    return math.remainder(after - before, FULL_TURN)
