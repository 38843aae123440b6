# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The messages that an accuracy needs, as a table."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from smarttestudo.accuracy.accuracy_curve import AccuracyCurve, AccuracyPoint, BoundCost
from smarttestudo.domain.units import grouped
from smarttestudo.report.table import WHOLE, Column, Table, format_number, measured

_NOTE = (
    "Sent: messages that keep the picture within the bound, and a heartbeat in 2 s. RMSE, worst: the error "
    "of the picture after each message of the source. Fixed: the rate of as many messages, shown alike."
)
_Row = tuple[AccuracyCurve, AccuracyPoint]


def accuracy_table(curves: Sequence[AccuracyCurve]) -> Table[_Row]:
    """The properties of one topic at rising bounds."""
    topic, messages = curves[0].topic, curves[0].messages
    is_reckoned = any(point.reckoned for curve in curves for point in curve.points)
    return Table(
        title=f"{topic}: messages that an accuracy needs, of {grouped(messages)}",
        columns=(
            Column("Property", "", lambda row: f"{row[0].property_name} {row[0].unit}", is_text=True),
            Column("Bound", "", lambda row: row[1].bound, measured),
            *_cost_columns("Hold", lambda point: point.hold),
            *(_cost_columns("Reckoned", lambda point: point.reckoned) if is_reckoned else ()),
        ),
        rows=[(curve, point) for curve in curves for point in curve.points],
        footnotes=(*_motions(curves), _NOTE),
    )


def _cost_columns(
    receiver: str, cost_of: Callable[[AccuracyPoint], BoundCost | None]
) -> Iterator[Column[_Row]]:
    def value(of: Callable[[BoundCost], float]) -> Callable[[_Row], float | None]:
        return lambda row: None if (cost := cost_of(row[1])) is None else of(cost)

    yield Column(receiver, "sent", value(lambda cost: cost.within.messages), WHOLE, heads_group=True)
    yield Column("", "RMSE", value(lambda cost: cost.within.rmse), measured)
    yield Column("", "worst", value(lambda cost: cost.within.worst), measured)
    yield Column("Fixed", "RMSE", value(lambda cost: cost.fixed.rmse), measured)
    yield Column("", "worst", value(lambda cost: cost.fixed.worst), measured)


def _motions(curves: Sequence[AccuracyCurve]) -> Iterator[str]:
    """Mean and maximum of |x′|: with hold, bounds need that share of a fixed rate's messages."""
    for curve in curves:
        motion = curve.motion
        mean, most = (measured(value) for value in (motion.mean_per_s, motion.max_per_s))
        unit = f"{curve.unit} per s" if "/" in curve.unit or not curve.unit else f"{curve.unit}/s"
        part = f" of {motion.part}" if motion.part else ""
        share = format_number(100 * (motion.share or 0.0), 0)
        yield (
            f"{curve.property_name}{part} changes by {mean} {unit.strip()} on average and {most} at "
            f"most: for one worst error, hold needs {share} % of the messages of a fixed rate at best."
        )
