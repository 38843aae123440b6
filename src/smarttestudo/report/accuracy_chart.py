# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The chart of messages against accuracy, the same in whichever form it is drawn."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from enum import Enum

from smarttestudo.accuracy.accuracy_curve import AccuracyCurve, AccuracyPoint, BoundCost
from smarttestudo.accuracy.arms import PacedPicture
from smarttestudo.report.axes import LogScale, log_scale

_LEAST = 1e-300
"""An error that is smaller counts as none: there is no room for a margin among the numbers."""


class Sent(Enum):
    """How messages were chosen; the value is its line's class in the style sheet."""

    FIXED = "before"
    WITHIN = "after"


@dataclass(frozen=True, slots=True, kw_only=True)
class AccuracyLine:
    """Messages and worst error of one way to send, the fewest messages first.

    ``reckons``: for a receiver that shows dead reckoning.
    """

    sent: Sent
    reckons: bool
    points: tuple[tuple[int, float], ...]

    @property
    def name(self) -> str:
        """Its name in a legend."""
        way = "Bound" if self.sent is Sent.WITHIN else "Fixed rate"
        return f"{way}, {'dead reckoning' if self.reckons else 'last message held'}"


@dataclass(frozen=True, slots=True, kw_only=True)
class AccuracyChart:
    """Messages to the right, the worst error upwards, in ``unit``."""

    name: str
    unit: str
    messages: LogScale
    errors: LogScale
    lines: tuple[AccuracyLine, ...]

    @property
    def meaning(self) -> str:
        """The text for a reader who cannot see it."""
        return f"Worst error of {self.name} against messages, in {self.unit or 'its unit'}"


def accuracy_chart(curve: AccuracyCurve) -> AccuracyChart | None:
    """The chart of one property; ``None`` where no error is left to show.

    Where every message passes there is none, which has no place on a logarithmic axis.
    """
    lines = [
        AccuracyLine(sent=sent, reckons=reckons, points=_points(curve.points, cost, error))
        for reckons, cost in ((False, _hold), (True, _reckoned))
        for sent, error in ((Sent.FIXED, _fixed), (Sent.WITHIN, _within))
    ]
    shown = tuple(line for line in lines if line.points)
    if not shown:
        return None
    points = [point for line in shown for point in line.points]
    return AccuracyChart(
        name=f"{curve.topic} {curve.property_name}",
        unit=curve.unit,
        messages=log_scale([messages for messages, _ in points]),
        errors=log_scale([error for _, error in points]),
        lines=shown,
    )


def _points(
    points: Iterable[AccuracyPoint],
    cost: Callable[[AccuracyPoint], BoundCost | None],
    error: Callable[[BoundCost], PacedPicture],
) -> tuple[tuple[int, float], ...]:
    costs = (cost(point) for point in points)
    errors = (error(one) for one in costs if one is not None)
    known = {(one.messages, one.worst) for one in errors if _LEAST < one.worst < math.inf}
    return tuple(sorted(known, key=lambda point: (point[0], -point[1])))


def _hold(point: AccuracyPoint) -> BoundCost:
    return point.hold


def _reckoned(point: AccuracyPoint) -> BoundCost | None:
    return point.reckoned


def _fixed(cost: BoundCost) -> PacedPicture:
    return cost.fixed


def _within(cost: BoundCost) -> PacedPicture:
    return cost.within
