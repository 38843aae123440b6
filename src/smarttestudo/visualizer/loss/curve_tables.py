# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Loss curves as tables."""

from __future__ import annotations

from smarttestudo.visualizer.loss.curve import CurvePoint, LossCurve
from smarttestudo.visualizer.loss.tables import measured
from smarttestudo.visualizer.table import Column, Number, Row, Table, printable

_MOST_FIELDS = 7


def curve_table(curve: LossCurve) -> Table:
    """The error of each field at rising rates; of many fields the first, all are in ``--json``."""
    shown = curve.fields[:_MOST_FIELDS]
    hidden = len(curve.fields) - len(shown)
    title = f"{printable(curve.topic)}: RMSE over time of who holds the last value received, by rate"
    if curve.breakpoints:
        tiers = ", ".join(f"{rate_hz:g}" for rate_hz in curve.breakpoints.tiers_hz)
        title += f"\nProposed tiers: {tiers} Hz\n({curve.breakpoints.origin})"
    return Table(
        title=title,
        columns=(
            Column(heading="Rate", unit="Hz"),
            Column(heading="Volume", unit="KB/s"),
            Column(heading="Age", unit="s"),
            *(Column(heading=field.name, unit=field.unit) for field in shown),
        ),
        rows=tuple(_row(point, len(shown)) for point in curve.points),
        footnotes=(f"{hidden} more fields are in --json.",) if hidden else (),
    )


def _row(point: CurvePoint, fields: int) -> Row:
    return Row(
        cells=(
            measured(point.rate_hz),
            measured(point.kb_per_s),
            Number(point.age.mean_s if point.age else None, decimals=3),
            *(measured(error.hold.rmse if error else None) for error in point.errors[:fields]),
        )
    )
