# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Accuracies as tables and sentences: the messages that one needs, and rules beside each other."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from smarttestudo.accuracy.accuracy_curve import AccuracyCurve, AccuracyPoint, BoundCost
from smarttestudo.accuracy.comparison import AccuracyComparison, ArmAccuracy, PropertyAccuracy, View
from smarttestudo.domain.units import BYTES_PER_KB, grouped
from smarttestudo.report.table import (
    MISSING,
    WHOLE,
    Column,
    Table,
    change,
    decimals,
    format_number,
    measured,
    percent_text,
)

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


_SHOWN_UNITS = {"m": (100.0, "cm"), "rad": (1.0, "rad"), "°": (1.0, "°")}
_NOTES = (
    "Errors are taken after each message of the source; RMSE is over time, its change against fixed rates.",
    "Fixed rates carry the bytes that the first rules take of each topic.",
)


def accuracy_tables(comparison: AccuracyComparison) -> tuple[Table[ArmAccuracy], ...]:
    """A table for each topic, with a row for each way of choosing what passes."""
    left_out = f"All: without images ({', '.join(comparison.left_out)})."
    notes = (*_NOTES, left_out) if comparison.left_out else _NOTES
    return tuple(
        Table(
            title=f"How far the picture of {topic} is off",
            columns=tuple(_columns(comparison.arms[0], topic)),
            rows=comparison.arms,
            footnotes=notes,
        )
        for topic in comparison.arms[0].topics
    )


def accuracy_sentences(comparison: AccuracyComparison) -> Iterator[str]:
    """The gain of rules with bounds over fixed rates in the first property of the first topic."""
    fixed = comparison.arms[0]
    if not fixed.topics:
        return
    topic, passed = next(iter(fixed.topics.items()))
    name, before = next(iter(passed.properties.items()))
    for view in View:
        found = [
            (one.error.rmse, arm)
            for arm in comparison.arms[1:]
            if arm.view is view and (one := arm.topics[topic].properties[name]).bounds and one.error
        ]
        if not found or before.error is None or not before.error.rmse or not passed.size_bytes:
            continue
        rmse, arm = min(found, key=lambda pair: pair[0])
        bytes_percent = 100 * arm.topics[topic].size_bytes / passed.size_bytes
        yield (
            f"Beside fixed rates, {arm.name} ({view.value}) shows the {name} of {topic} with "
            f"{percent_text(100 * rmse / before.error.rmse, decimals=0)} of the error, for "
            f"{percent_text(bytes_percent, decimals=0)} of the bytes."
        )


def _columns(fixed: ArmAccuracy, topic: str) -> Iterator[Column[ArmAccuracy]]:
    yield Column("Rules", "", lambda arm: arm.name, is_text=True)
    yield Column("Shown", "", lambda arm: arm.view.value, is_text=True)
    yield Column("Messages", "", lambda arm: arm.topics[topic].messages, WHOLE, heads_group=True)
    yield Column("Bytes", "KB", lambda arm: arm.topics[topic].size_bytes / BYTES_PER_KB, decimals(1))
    yield Column("All", "KB", lambda arm: arm.size_bytes / BYTES_PER_KB, decimals(1))
    for name in fixed.topics[topic].properties:
        yield from _property_columns(fixed, topic, name)


def _property_columns(fixed: ArmAccuracy, topic: str, name: str) -> Iterator[Column[ArmAccuracy]]:
    of_fixed = fixed.topics[topic].properties[name]
    before = of_fixed.error
    factor, unit = _SHOWN_UNITS.get(of_fixed.unit, (1.0, of_fixed.unit))

    def of(arm: ArmAccuracy) -> PropertyAccuracy:
        return arm.topics[topic].properties[name]

    def change_percent(arm: ArmAccuracy) -> float | None:
        error = of(arm).error
        if arm is fixed or error is None or before is None or not before.rmse:
            return None
        return 100 * (error.rmse / before.rmse - 1)

    def rmse(arm: ArmAccuracy) -> float | None:
        error = of(arm).error
        return None if error is None else factor * error.rmse

    def worst(arm: ArmAccuracy) -> float | None:
        error = of(arm).error
        return None if error is None else factor * error.worst

    yield Column(f"{name.capitalize()} RMSE", unit, rmse, decimals(3), heads_group=True)
    yield Column("Change", "%", change_percent, change)
    yield Column("Worst", unit, worst, decimals(3))
    yield Column("Bound", unit, lambda arm: _span(of(arm), factor))
    yield Column("Broken", "", lambda arm: of(arm).broken if of(arm).bounds else None, WHOLE)


def _span(one: PropertyAccuracy, factor: float) -> str:
    """The bounds, from the tightest to the widest."""
    if not one.bounds:
        return MISSING
    ends = dict.fromkeys((one.bounds[0], one.bounds[-1]))
    return " … ".join(f"{factor * bound:g}" for bound in ends)
