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
    "Errors are taken after each message of the source; RMSE is over time.",
    "Fixed rates carry the bytes that the first rules take of each topic; with dead reckoning, those of the "
    "rules above them. Change: the RMSE against that of the fixed rates that are shown alike.",
)


def accuracy_tables(comparison: AccuracyComparison) -> tuple[Table[ArmAccuracy], ...]:
    """A table for each topic, with a row for each way of choosing what passes."""
    left_out = f"All: without images ({', '.join(comparison.left_out)})."
    notes = (*_NOTES, left_out) if comparison.left_out else _NOTES
    return tuple(
        Table(
            title=f"How far the picture of {topic} is off",
            columns=tuple(_columns(comparison, topic)),
            rows=comparison.arms,
            footnotes=notes,
        )
        for topic in comparison.arms[0].topics
    )


def accuracy_sentences(comparison: AccuracyComparison) -> Iterator[str]:
    """The gain of rules with bounds over fixed rates shown alike, for the first property."""
    topic, passed = next(iter(comparison.arms[0].topics.items()), (None, None))
    if topic is None or passed is None:
        return
    name = next(iter(passed.properties))
    for view in View:
        found = [
            (error.rmse, arm, fixed)
            for arm, fixed in comparison.pairs()
            if fixed and arm.view is view and (one := arm.topics[topic].properties[name]).bounds
            if (error := one.error)
        ]
        if found:
            _, arm, fixed = min(found, key=lambda one: one[0])
            yield from _gain(topic, name, arm, fixed)


def _gain(topic: str, name: str, arm: ArmAccuracy, fixed: ArmAccuracy) -> Iterator[str]:
    passed, before = arm.topics[topic], fixed.topics[topic]
    error, error_before = passed.properties[name].error, before.properties[name].error
    if error is None or error_before is None or not error_before.rmse or not before.size_bytes:
        return
    rmse, worst, size = (
        percent_text(100 * share, decimals=0)
        for share in (
            error.rmse / error_before.rmse,
            error.worst / error_before.worst,
            passed.size_bytes / before.size_bytes,
        )
    )
    yield (
        f"Beside fixed rates that are shown alike ({arm.view.value}), {arm.name} shows the {name} of {topic} "
        f"with {rmse} of the error (RMSE) and {worst} of the worst, for {size} of the bytes."
    )


def _columns(comparison: AccuracyComparison, topic: str) -> Iterator[Column[ArmAccuracy]]:
    yield Column("Rules", "", lambda arm: arm.name, is_text=True)
    yield Column("Shown", "", lambda arm: arm.view.value, is_text=True)
    yield Column("Messages", "", lambda arm: arm.topics[topic].messages, WHOLE, heads_group=True)
    yield Column("Bytes", "KB", lambda arm: arm.topics[topic].size_bytes / BYTES_PER_KB, decimals(1))
    yield Column("All", "KB", lambda arm: arm.size_bytes / BYTES_PER_KB, decimals(1))
    for name in comparison.arms[0].topics[topic].properties:
        yield from _property_columns(comparison, topic, name)


def _property_columns(comparison: AccuracyComparison, topic: str, name: str) -> Iterator[Column[ArmAccuracy]]:
    unit_of = comparison.arms[0].topics[topic].properties[name].unit
    factor, unit = _SHOWN_UNITS.get(unit_of, (1.0, unit_of))
    fixed_of = {id(arm): fixed for arm, fixed in comparison.pairs()}

    def of(arm: ArmAccuracy) -> PropertyAccuracy:
        return arm.topics[topic].properties[name]

    def change_percent(arm: ArmAccuracy) -> float | None:
        fixed = fixed_of[id(arm)]
        rmse, before = of(arm).rmse, of(fixed).rmse if fixed else None
        return None if rmse is None or not before else 100 * (rmse / before - 1)

    def scaled(error: float | None) -> float | None:
        return None if error is None else factor * error

    yield Column(
        f"{name.capitalize()} RMSE", unit, lambda arm: scaled(of(arm).rmse), decimals(3), heads_group=True
    )
    yield Column("Change", "%", change_percent, change)
    yield Column("Worst", unit, lambda arm: scaled(of(arm).worst), decimals(3))
    yield Column("Bound", unit, lambda arm: _span(of(arm), factor))
    yield Column("Broken", "", lambda arm: of(arm).broken if of(arm).bounds else None, WHOLE)


def _span(accuracy: PropertyAccuracy, factor: float) -> str:
    """The bounds, from the tightest to the widest."""
    if not accuracy.bounds:
        return MISSING
    ends = dict.fromkeys((accuracy.bounds[0], accuracy.bounds[-1]))
    return " … ".join(f"{factor * bound:g}" for bound in ends)
