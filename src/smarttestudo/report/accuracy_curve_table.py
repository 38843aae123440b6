# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The messages that an accuracy needs, as a table."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from smarttestudo.accuracy.accuracy_curve import AccuracyCurve, AccuracyPoint, BoundCost
from smarttestudo.domain.units import grouped
from smarttestudo.report.loss_tables import measured
from smarttestudo.report.table import (
    Align,
    Cell,
    Column,
    Number,
    Row,
    Table,
    Text,
    format_cell,
    format_number,
)

_NOTE = (
    "Sent: messages that keep the picture within the bound, and a heartbeat in 2 s. RMSE, worst: the error "
    "of the picture after each message of the source. Fixed: the rate of as many messages, shown alike."
)


def accuracy_table(curves: Sequence[AccuracyCurve]) -> Table:
    """The properties of one topic at rising bounds."""
    topic, messages = curves[0].topic, curves[0].messages
    is_reckoned = any(point.reckoned for curve in curves for point in curve.points)
    return Table(
        title=f"{topic}: messages that an accuracy needs, of {grouped(messages)}",
        columns=(
            Column(heading="Property", align=Align.LEFT),
            Column(heading="Bound"),
            *_columns("Hold"),
            *(_columns("Reckoned") if is_reckoned else ()),
        ),
        rows=tuple(_row(curve, point, is_reckoned=is_reckoned) for curve in curves for point in curve.points),
        footnotes=(*_motions(curves), _NOTE),
    )


def _columns(receiver: str) -> Iterator[Column]:
    yield Column(heading=receiver, unit="sent", heads_group=True)
    yield Column(heading="", unit="RMSE")
    yield Column(heading="", unit="worst")
    yield Column(heading="Fixed", unit="RMSE")
    yield Column(heading="", unit="worst")


def _row(curve: AccuracyCurve, point: AccuracyPoint, *, is_reckoned: bool) -> Row:
    return Row(
        cells=(
            Text(f"{curve.property_name} {curve.unit}"),
            measured(point.bound),
            *_cells(point.hold),
            *(_cells(point.reckoned) if is_reckoned else ()),
        )
    )


def _cells(cost: BoundCost | None) -> Iterator[Cell]:
    if cost is None:
        yield from (Number(None),) * 5
        return
    yield Number(cost.within.messages, decimals=0)
    for error in (cost.within, cost.fixed):
        yield measured(error.rmse)
        yield measured(error.worst)


def _motions(curves: Sequence[AccuracyCurve]) -> Iterator[str]:
    """Mean and maximum of |x′|: with hold, bounds need that share of a fixed rate's messages."""
    for curve in curves:
        motion = curve.motion
        mean, most = (format_cell(measured(value)) for value in (motion.mean_per_s, motion.max_per_s))
        unit = f"{curve.unit} per s" if "/" in curve.unit or not curve.unit else f"{curve.unit}/s"
        part = f" of {motion.part}" if motion.part else ""
        share = format_number(100 * (motion.share or 0.0), 0)
        yield (
            f"{curve.property_name}{part} changes by {mean} {unit.strip()} on average and {most} at "
            f"most: for one worst error, hold needs {share} % of the messages of a fixed rate at best."
        )
