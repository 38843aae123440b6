# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The comparison of accuracies in tables and sentences."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from smarttestudo.accuracy.comparison import AccuracyComparison, ArmAccuracy, PropertyAccuracy, View
from smarttestudo.domain.units import BYTES_PER_KB
from smarttestudo.report.table import (
    MISSING,
    Align,
    Cell,
    Column,
    Number,
    Row,
    Table,
    Text,
    percent_cell,
    percent_text,
)

_SHOWN_UNITS = {"m": (100.0, "cm"), "rad": (1.0, "rad"), "°": (1.0, "°")}
_NOTES = (
    "Errors are taken after each message of the source; RMSE is over time, its change against fixed rates.",
    "Fixed rates carry the bytes that the first rules take of each topic.",
)


def accuracy_tables(comparison: AccuracyComparison) -> tuple[Table, ...]:
    """A table for each topic, with a row for each way of choosing what passes."""
    fixed = comparison.arms[0]
    left_out = f"All: without images ({', '.join(comparison.left_out)})."
    notes = (*_NOTES, left_out) if comparison.left_out else _NOTES
    return tuple(
        Table(
            title=f"How far the picture of {topic} is off",
            columns=tuple(_columns(measured.properties)),
            rows=tuple(Row(cells=tuple(_cells(arm, fixed, topic))) for arm in comparison.arms),
            footnotes=notes,
        )
        for topic, measured in fixed.topics.items()
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


def _columns(properties: Mapping[str, PropertyAccuracy]) -> Iterator[Column]:
    yield Column(heading="Rules", align=Align.LEFT)
    yield Column(heading="Shown", align=Align.LEFT)
    yield Column(heading="Messages", heads_group=True)
    yield Column(heading="Bytes", unit="KB")
    yield Column(heading="All", unit="KB")
    for name, one in properties.items():
        unit = _shown(one.unit)[1]
        yield Column(heading=f"{name.capitalize()} RMSE", unit=unit, heads_group=True)
        yield Column(heading="Change", unit="%")
        yield Column(heading="Worst", unit=unit)
        yield Column(heading="Bound", unit=unit)
        yield Column(heading="Broken")


def _cells(arm: ArmAccuracy, fixed: ArmAccuracy, topic: str) -> Iterator[Cell]:
    passed = arm.topics[topic]
    yield Text(arm.name)
    yield Text(arm.view.value)
    yield Number(passed.messages, decimals=0)
    yield Number(passed.size_bytes / BYTES_PER_KB, decimals=1)
    yield Number(arm.size_bytes / BYTES_PER_KB, decimals=1)
    for name, one in passed.properties.items():
        factor, _ = _shown(one.unit)
        before = fixed.topics[topic].properties[name].error
        error = one.error
        change = None
        if arm is not fixed and error is not None and before is not None and before.rmse:
            change = 100 * (error.rmse / before.rmse - 1)
        yield Number(factor * error.rmse if error else None, decimals=3)
        yield percent_cell(change, signed=True)
        yield Number(factor * error.worst if error else None, decimals=3)
        yield Text(_span(one, factor))
        yield Number(one.broken if one.bounds else None, decimals=0)


def _span(one: PropertyAccuracy, factor: float) -> str:
    """The bounds, from the tightest to the widest."""
    if not one.bounds:
        return MISSING
    ends = dict.fromkeys((one.bounds[0], one.bounds[-1]))
    return " … ".join(f"{factor * bound:g}" for bound in ends)


def _shown(unit: str) -> tuple[float, str]:
    return _SHOWN_UNITS.get(unit, (1.0, unit))
