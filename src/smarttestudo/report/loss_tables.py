# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Tables of what an operator lost."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

from smarttestudo.accuracy.bounds import BoundLoss, BrokenStretch
from smarttestudo.accuracy.curve import CurvePoint, LossCurve
from smarttestudo.accuracy.loss_report import (
    Age,
    CrossingLoss,
    ErrorSize,
    FieldLoss,
    ImageLoss,
    LossReport,
    Sightings,
    TopicLoss,
)
from smarttestudo.domain.units import BYTES_PER_KB, counted, grouped
from smarttestudo.report.table import (
    Align,
    Cell,
    Column,
    Number,
    Row,
    Table,
    Text,
    format_cell,
)

_SMALL = 0.01
_NOISE = 1e-9
_PERCENT = 100.0
_ERROR_NOTE = (
    "Error over time against A, in the field's unit: when the last value received is held, and when values "
    "are interpolated afterwards between those received. %: RMSE relative to the field's range in A. Fields "
    "that never changed are left out."
)
_AGE_NOTE = "Age: time since the newest message received. Hz: messages over the recording's duration."
_CROSSING_NOTE = (
    "In time: before A's next message. Missed: the value was back before a message came, or the way back "
    "from such a crossing. Late: mean and longest delay of those that were late."
)
_BOUND_NOTE = (
    "Messages of A while the bound was in force, broken where B's picture was more than the bound off after "
    "them. Worst: the largest error, in the property's unit. Times are in s since the start of A."
)
_MOST_STRETCHES = 3
_IMAGE_NOTE = "Blind: the longest time without a new frame."


def arms_lines(report: LossReport) -> list[str]:
    """Which recordings are compared, and what stands beside them."""
    carried = report.carried
    fixed_kb, received_kb = (size / BYTES_PER_KB for size in (carried.fixed_bytes, carried.received_bytes))
    return [
        f"A: {report.a}",
        f"B: {report.b}",
        "Fixed: A at the best fixed rates for the bytes of B "
        f"({grouped(fixed_kb)} KB; B has {grouped(received_kb)})",
    ]


def loss_tables(report: LossReport) -> Iterator[Table]:
    """Errors, bounds, ages, crossings and images, each where there are any."""
    if report.fields:
        yield error_table(report)
    if report.bounds:
        yield bound_table(report)
    yield age_table(report)
    if report.crossings:
        yield crossing_table(report)
    if report.images:
        yield image_table(report)


def error_table(report: LossReport) -> Table:
    """The errors of each field, B's beside those of fixed rates."""
    return Table(
        title="Error of the fields",
        columns=(
            Column(heading="Field", align=Align.LEFT),
            Column(heading="Unit", align=Align.LEFT),
            Column(heading="Range", heads_group=True),
            Column(heading="Hold", unit="RMSE"),
            Column(heading="Hold", unit="max"),
            Column(heading="Hold", unit="%"),
            Column(heading="Interp.", unit="RMSE"),
            Column(heading="Fixed", unit="hold", heads_group=True),
            Column(heading="Fixed", unit="hold %"),
            Column(heading="Fixed", unit="interp."),
        ),
        rows=tuple(_error_row(loss) for loss in report.fields),
        footnotes=(_ERROR_NOTE, *_excluded_note(report)),
    )


def bound_table(report: LossReport) -> Table:
    """How each bound of the rules was kept."""
    return Table(
        title="Bounds of the rules",
        columns=(
            Column(heading="Picture", align=Align.LEFT),
            Column(heading="Unit", align=Align.LEFT),
            Column(heading="Bound", heads_group=True),
            Column(heading="Worst"),
            Column(heading="In force", unit="s"),
            Column(heading="Messages"),
            Column(heading="Broken"),
            Column(heading="Broken", unit="s"),
            Column(heading="Kept", align=Align.LEFT),
        ),
        rows=tuple(_bound_row(loss) for loss in report.bounds),
        footnotes=(*_stretch_notes(report.bounds), *_unreadable_note(report.bounds), _BOUND_NOTE),
    )


def age_table(report: LossReport) -> Table:
    """How old each topic was, B's beside fixed rates."""
    return Table(
        title="Age of information",
        columns=(
            Column(heading="Topic", align=Align.LEFT),
            Column(heading="B", unit="Hz", heads_group=True),
            Column(heading="Mean", unit="s"),
            Column(heading="p95", unit="s"),
            Column(heading="Max", unit="s"),
            Column(heading="Fixed", unit="Hz", heads_group=True),
            Column(heading="Mean", unit="s"),
            Column(heading="p95", unit="s"),
            Column(heading="Max", unit="s"),
        ),
        rows=tuple(_age_row(loss, report.duration_s) for loss in report.topics),
        footnotes=(_AGE_NOTE, *_after_end_note(report)),
    )


def _after_end_note(report: LossReport) -> Iterator[str]:
    if report.after_end:
        listed = ", ".join(f"{grouped(count)} of {topic}" for topic, count in report.after_end.items())
        yield f"Of B, {listed} came after the end of A, which no figure holds."


def crossing_table(report: LossReport) -> Table:
    """How the thresholds of checks were seen, B's beside fixed rates."""
    crossed = [loss for loss in report.crossings if loss.crossings]
    never = len(report.crossings) - len(crossed)
    note = (f"{never} of {len(report.crossings)} checks were never crossed.",) if never else ()
    return Table(
        title="Threshold crossings",
        columns=(
            Column(heading="Check", align=Align.LEFT),
            Column(heading="Crossed", heads_group=True),
            Column(heading="In time"),
            Column(heading="Missed"),
            Column(heading="Late"),
            Column(heading="mean", unit="s"),
            Column(heading="max", unit="s"),
            Column(heading="In time", unit="fixed", heads_group=True),
            Column(heading="Missed", unit="fixed"),
            Column(heading="Late", unit="fixed"),
            Column(heading="max", unit="s"),
        ),
        rows=tuple(_crossing_row(loss) for loss in crossed),
        footnotes=(_CROSSING_NOTE, *note),
    )


def image_table(report: LossReport) -> Table:
    """Frames of each topic of images, and the longest time without one."""
    return Table(
        title="Images",
        columns=(
            Column(heading="Topic", align=Align.LEFT),
            Column(heading="Sent", unit="frames", heads_group=True),
            Column(heading="Blind", unit="s"),
            Column(heading="Received", unit="frames", heads_group=True),
            Column(heading="Blind", unit="s"),
            Column(heading="Fixed", unit="frames", heads_group=True),
            Column(heading="Blind", unit="s"),
        ),
        rows=tuple(_image_row(loss) for loss in report.images),
        footnotes=(_IMAGE_NOTE,),
    )


def measured(value: float | None) -> Number:
    """``value`` in three significant digits, in two below 0.01; nothing of one that is not finite."""
    if value is None or not math.isfinite(value):
        return Number(None, decimals=0)
    if abs(value) < _NOISE:
        return Number(0.0, decimals=0)
    digits = 3 if abs(value) >= _SMALL else 2
    decimals = digits - 1 - math.floor(math.log10(abs(value)))
    return Number(value, decimals=max(decimals, 0))


def _error_row(loss: FieldLoss) -> Row:
    received, fixed = loss.received, loss.fixed
    held, held_fixed = (error.hold if error else None for error in (received, fixed))
    return Row(
        cells=(
            Text(f"{loss.topic} {loss.field}"),
            Text(loss.unit),
            measured(loss.value_range),
            _rmse(held),
            measured(held.maximum if held else None),
            _share(held),
            _rmse(received.interpolated if received else None),
            _rmse(held_fixed),
            _share(held_fixed),
            _rmse(fixed.interpolated if fixed else None),
        )
    )


def bound_name(loss: BoundLoss) -> str:
    """The picture that is bounded."""
    return f"{loss.topic} {loss.property_name}{', reckoned' if loss.reckons else ''}"


def _bound_row(loss: BoundLoss) -> Row:
    kept = "held" if loss.is_held else "broken"
    return Row(
        cells=(
            Text(bound_name(loss)),
            Text(loss.unit),
            measured(loss.bound),
            measured(loss.worst),
            Number(loss.in_force_s, decimals=1),
            _count(loss.messages),
            _count(loss.broken),
            Number(loss.broken_s, decimals=1),
            Text(kept if loss.messages else "not in force" if not loss.in_force_s else "no message"),
        )
    )


def _stretch_notes(losses: Iterable[BoundLoss]) -> Iterator[str]:
    """Of each bound that broke, when: the first stretches, and how many more."""
    for loss in losses:
        if loss.is_held:
            continue
        shown = loss.stretches[:_MOST_STRETCHES]
        named = "; ".join(
            f"{grouped(one.from_s, 2)} to {grouped(one.to_s, 2)} s{_by(one, loss.unit)}" for one in shown
        )
        more = loss.stretch_count - len(shown)
        rest = f"; and {grouped(more)} more" if more else ""
        yield f"{loss.topic} {loss.property_name} {loss.bound:g} broken: {named}{rest}."


def _unreadable_note(losses: Iterable[BoundLoss]) -> Iterator[str]:
    """How many messages each bound could not be judged by."""
    named = ", ".join(
        f"{loss.topic} {loss.property_name} {loss.bound:g} by {counted(loss.unreadable, 'message')}"
        for loss in losses
        if loss.unreadable
    )
    if named:
        yield f"Not judged, as they have no value there: {named}."


def _by(stretch: BrokenStretch, unit: str) -> str:
    if stretch.worst is None:
        return " (nothing shown)"
    return f" ({format_cell(measured(stretch.worst))}{f' {unit}' if unit else ''})"


def _age_row(loss: TopicLoss, duration_s: float) -> Row:
    cells: list[Cell] = [Text(loss.topic)]
    for arm in (loss.received, loss.fixed):
        cells += [Number(arm.messages / duration_s if duration_s else None), *_age_cells(arm.age)]
    return Row(cells=tuple(cells))


def _age_cells(age: Age | None) -> tuple[Number, ...]:
    seconds = (age.mean_s, age.p95_s, age.max_s) if age else (None, None, None)
    return tuple(Number(value, decimals=3) for value in seconds)


def _crossing_row(loss: CrossingLoss) -> Row:
    received, fixed = loss.received, loss.fixed
    return Row(
        cells=(
            Text(loss.check),
            _count(loss.crossings),
            *_counts(received),
            Number(received.late_mean_s, decimals=3),
            Number(received.late_max_s, decimals=3),
            *_counts(fixed),
            Number(fixed.late_max_s, decimals=3),
        )
    )


def _counts(seen: Sightings) -> tuple[Number, ...]:
    return _count(seen.in_time), _count(seen.missed), _count(seen.late)


def _image_row(loss: ImageLoss) -> Row:
    cells: list[Cell] = [Text(loss.topic)]
    for frames in (loss.sent, loss.received, loss.fixed):
        cells += [_count(frames.frames), Number(frames.longest_blind_s, decimals=3)]
    return Row(cells=tuple(cells))


def _count(count: int) -> Number:
    return Number(count, decimals=0)


def _rmse(size: ErrorSize | None) -> Number:
    return measured(size.rmse if size else None)


def _share(size: ErrorSize | None) -> Number:
    share = size.relative_rmse if size else None
    return Number(None if share is None else _PERCENT * share)


def _excluded_note(report: LossReport) -> tuple[str, ...]:
    parts = [
        f"{loss.topic} {loss.field} {loss.excluded_sent} in A, {loss.excluded_received} in B"
        for loss in report.fields
        if loss.excluded_sent or loss.excluded_received
    ]
    return (f"Left out, as no value is known: {'; '.join(parts)}.",) if parts else ()


_MOST_FIELDS = 7


def curve_table(curve: LossCurve) -> Table:
    """The error of each field at rising rates; of many fields the first, all are in ``--json``."""
    shown = curve.fields[:_MOST_FIELDS]
    hidden = len(curve.fields) - len(shown)
    proposal: tuple[str, ...] = ()
    if curve.breakpoints:
        tiers = ", ".join(f"{rate_hz:g}" for rate_hz in curve.breakpoints.tiers_hz)
        proposal = (f"Proposed levels: {tiers} Hz", f"({curve.breakpoints.origin})")
    return Table(
        title=f"{curve.topic}: RMSE over time when the last value received is held, by rate",
        subtitles=proposal,
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
