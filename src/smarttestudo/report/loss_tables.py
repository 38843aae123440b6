# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Tables of what an operator lost."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import Any

from smarttestudo.accuracy.bounds import BoundLoss, BrokenStretch
from smarttestudo.accuracy.curve import CurvePoint, LossCurve
from smarttestudo.accuracy.loss_report import (
    Age,
    CrossingLoss,
    ErrorSize,
    FieldError,
    FieldLoss,
    ImageLoss,
    LossReport,
    TopicArm,
    TopicLoss,
)
from smarttestudo.domain.units import BYTES_PER_KB, counted, grouped
from smarttestudo.report.comparison_tables import RunNames
from smarttestudo.report.table import WHOLE, Column, Table, decimals, measured

_PERCENT = 100.0
_MUCH_MORE = 1.25
_ERROR_NOTE = (
    "Error over time against {a}, in the field's unit: when the last value received is held, and when "
    "values are interpolated afterwards between those received. %: RMSE relative to the field's range in "
    "{a}. Fields that never changed are left out."
)
_AGE_NOTE = "Age: time since the newest message received. Hz: messages over the recording's duration."
_WRONG_NOTE = (
    "Wrong is for how long the operator believed something else of a text or a state, or knew nothing yet."
)
_CROSSING_NOTE = (
    "In time: before {a}'s next message. Missed: the value was back before a message came, or the way back "
    "from such a crossing. Late: mean and longest delay of those that were late."
)
_BOUND_NOTE = (
    "Messages of {a} while the bound was in force, broken where {b}'s picture was more than the bound off "
    "after them. Worst: the largest error, in the property's unit. Times are in s since the start of {a}."
)
LETTERS = RunNames(before="A", after="B")
"""The recordings as `testudo bag loss` names them."""
_MOST_STRETCHES = 3
_IMAGE_NOTE = "Blind: the longest time without a new frame."


def _named(note: str, names: RunNames) -> str:
    return note.format(a=names.before, b=names.after)


def arms_lines(report: LossReport) -> list[str]:
    """Which recordings are compared, and what stands beside them."""
    carried = report.carried
    fixed_kb, received_kb = (size / BYTES_PER_KB for size in (carried.fixed_bytes, carried.received_bytes))
    return [
        f"A: {report.a}",
        f"B: {report.b}",
        "Fixed: A at the best fixed rates for the bytes of B "
        f"({grouped(fixed_kb)} KB; B has {grouped(received_kb)})",
        *excess_note(report),
    ]


def excess_note(report: LossReport, names: RunNames = LETTERS) -> Iterator[str]:
    """Says so where fixed rates took many more bytes than were received, and are no baseline for those."""
    fixed_bytes, received_bytes = report.carried.fixed_bytes, report.carried.received_bytes
    if received_bytes and fixed_bytes > _MUCH_MORE * received_bytes:
        yield (
            f"Fixed took {fixed_bytes / received_bytes:.1f} times the bytes of {names.after}: a rate is for "
            "each stream of a topic, as each frame of /tf, and slow ones pass whole. For those bytes "
            "its errors would be larger."
        )


def loss_tables(report: LossReport, names: RunNames = LETTERS) -> Iterator[Table[Any]]:
    """Errors, bounds, ages, crossings and images, each where there are any."""
    if report.fields:
        yield error_table(report, names)
    if report.bounds:
        yield bound_table(report, names)
    yield age_table(report, names)
    if report.crossings:
        yield crossing_table(report, names)
    if report.images:
        yield image_table(report)


def error_table(report: LossReport, names: RunNames = LETTERS) -> Table[FieldLoss]:
    """The errors of each field, those received beside those of fixed rates."""
    return Table(
        title="Error of the fields",
        columns=(
            Column("Field", "", lambda loss: f"{loss.topic} {loss.field}", is_text=True),
            Column("Unit", "", lambda loss: loss.unit, is_text=True),
            Column("Range", "", lambda loss: loss.value_range, measured, heads_group=True),
            Column("Hold", "RMSE", lambda loss: _rmse(_held(loss.received)), measured),
            Column("Hold", "max", lambda loss: _maximum(_held(loss.received)), measured),
            Column("Hold", "%", lambda loss: _rmse_percent(_held(loss.received))),
            Column("Interp.", "RMSE", lambda loss: _rmse(_interpolated(loss.received)), measured),
            Column("Fixed", "hold", lambda loss: _rmse(_held(loss.fixed)), measured, heads_group=True),
            Column("Fixed", "hold %", lambda loss: _rmse_percent(_held(loss.fixed))),
            Column("Fixed", "interp.", lambda loss: _rmse(_interpolated(loss.fixed)), measured),
        ),
        rows=report.fields,
        footnotes=(_named(_ERROR_NOTE, names), *_excluded_note(report, names)),
    )


def _held(error: FieldError | None) -> ErrorSize | None:
    return error.hold if error else None


def _interpolated(error: FieldError | None) -> ErrorSize | None:
    return error.interpolated if error else None


def _rmse(size: ErrorSize | None) -> float | None:
    return size.rmse if size else None


def _maximum(size: ErrorSize | None) -> float | None:
    return size.maximum if size else None


def _rmse_percent(size: ErrorSize | None) -> float | None:
    share = size.relative_rmse if size else None
    return None if share is None else _PERCENT * share


def _excluded_note(report: LossReport, names: RunNames) -> tuple[str, ...]:
    parts = [
        f"{loss.topic} {loss.field} {loss.excluded_sent} in {names.before}, "
        f"{loss.excluded_received} in {names.after}"
        for loss in report.fields
        if loss.excluded_sent or loss.excluded_received
    ]
    return (f"Left out, as no value is known: {'; '.join(parts)}.",) if parts else ()


def bound_table(report: LossReport, names: RunNames = LETTERS) -> Table[BoundLoss]:
    """How each bound of the rules was kept."""
    return Table(
        title="Bounds of the rules",
        columns=(
            Column("Picture", "", bound_name, is_text=True),
            Column("Unit", "", lambda loss: loss.unit, is_text=True),
            Column("Bound", "", lambda loss: loss.bound, measured, heads_group=True),
            Column("Worst", "", lambda loss: loss.worst, measured),
            Column("In force", "s", lambda loss: loss.in_force_s, decimals(1)),
            Column("Messages", "", lambda loss: loss.messages, WHOLE),
            Column("Broken", "", lambda loss: loss.broken, WHOLE),
            Column("Broken", "s", lambda loss: loss.broken_s, decimals(1)),
            Column("Kept", "", _kept, is_text=True),
        ),
        rows=report.bounds,
        footnotes=(
            *_stretch_notes(report.bounds),
            *_unreadable_note(report.bounds),
            _named(_BOUND_NOTE, names),
        ),
    )


def bound_name(loss: BoundLoss) -> str:
    """The picture that is bounded."""
    return f"{loss.topic} {loss.property_name}{', reckoned' if loss.reckons else ''}"


def _kept(loss: BoundLoss) -> str:
    if loss.messages:
        return "held" if loss.is_held else "broken"
    return "no message" if loss.in_force_s else "not in force"


def _stretch_notes(losses: Iterable[BoundLoss]) -> Iterator[str]:
    """Of each bound that broke, when: the first stretches, and how many more."""
    for loss in losses:
        if loss.is_held:
            continue
        shown = loss.stretches[:_MOST_STRETCHES]
        named = "; ".join(
            f"{grouped(stretch.from_s, 2)} to {grouped(stretch.to_s, 2)} s{_by(stretch, loss.unit)}"
            for stretch in shown
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
    return f" ({measured(stretch.worst)}{f' {unit}' if unit else ''})"


def age_table(report: LossReport, names: RunNames = LETTERS) -> Table[TopicLoss]:
    """How old each topic was, as received beside fixed rates."""
    return Table(
        title="Age of information",
        columns=(
            Column("Topic", "", lambda loss: loss.topic, is_text=True),
            *_arm_columns(names.after, lambda loss: loss.received, report.duration_s),
            *_arm_columns("Fixed", lambda loss: loss.fixed, report.duration_s),
        ),
        rows=report.topics,
        footnotes=(_AGE_NOTE, *_after_end_note(report, names)),
    )


def _arm_columns(
    heading: str, arm: Callable[[TopicLoss], TopicArm], duration_s: float
) -> Iterator[Column[TopicLoss]]:
    def rate_hz(loss: TopicLoss) -> float | None:
        return arm(loss).messages / duration_s if duration_s else None

    def seconds(of: Callable[[Age], float]) -> Callable[[TopicLoss], float | None]:
        return lambda loss: None if (age := arm(loss).age) is None else of(age)

    yield Column(heading, "Hz", rate_hz, heads_group=True)
    yield Column("Mean", "s", seconds(lambda age: age.mean_s), decimals(3))
    yield Column("p95", "s", seconds(lambda age: age.p95_s), decimals(3))
    yield Column("Max", "s", seconds(lambda age: age.max_s), decimals(3))


def _after_end_note(report: LossReport, names: RunNames) -> Iterator[str]:
    if report.after_end:
        listed = ", ".join(f"{grouped(count)} of {topic}" for topic, count in report.after_end.items())
        yield f"Of {names.after}, {listed} came after the end of {names.before}, which no figure holds."


def crossing_table(report: LossReport, names: RunNames = LETTERS) -> Table[CrossingLoss]:
    """How the thresholds of checks were seen, as received beside fixed rates."""
    crossed = [loss for loss in report.crossings if loss.crossings]
    never = len(report.crossings) - len(crossed)
    wrong: tuple[Column[CrossingLoss], ...] = (
        Column("Wrong", "s", lambda loss: loss.received.wrong_s, decimals(3), heads_group=True),
        Column("Wrong", "fixed, s", lambda loss: loss.fixed.wrong_s, decimals(3)),
    )
    note = (f"{never} of {len(report.crossings)} checks were never crossed.",) if never else ()
    has_words = any(loss.received.wrong_s is not None for loss in crossed)
    return Table(
        title="Threshold crossings",
        columns=(
            Column("Check", "", lambda loss: loss.check, is_text=True),
            Column("Crossed", "", lambda loss: loss.crossings, WHOLE, heads_group=True),
            Column("In time", "", lambda loss: loss.received.in_time, WHOLE),
            Column("Missed", "", lambda loss: loss.received.missed, WHOLE),
            Column("Late", "", lambda loss: loss.received.late, WHOLE),
            Column("mean", "s", lambda loss: loss.received.late_mean_s, decimals(3)),
            Column("max", "s", lambda loss: loss.received.late_max_s, decimals(3)),
            Column("In time", "fixed", lambda loss: loss.fixed.in_time, WHOLE, heads_group=True),
            Column("Missed", "fixed", lambda loss: loss.fixed.missed, WHOLE),
            Column("Late", "fixed", lambda loss: loss.fixed.late, WHOLE),
            Column("max", "s", lambda loss: loss.fixed.late_max_s, decimals(3)),
            *(wrong if has_words else ()),
        ),
        rows=crossed,
        footnotes=(_named(_CROSSING_NOTE, names), *((_WRONG_NOTE,) if has_words else ()), *note),
    )


def image_table(report: LossReport) -> Table[ImageLoss]:
    """Frames of each topic of images, and the longest time without one."""
    return Table(
        title="Images",
        columns=(
            Column("Topic", "", lambda loss: loss.topic, is_text=True),
            Column("Sent", "frames", lambda loss: loss.sent.frames, WHOLE, heads_group=True),
            Column("Blind", "s", lambda loss: loss.sent.longest_blind_s, decimals(3)),
            Column("Received", "frames", lambda loss: loss.received.frames, WHOLE, heads_group=True),
            Column("Blind", "s", lambda loss: loss.received.longest_blind_s, decimals(3)),
            Column("Fixed", "frames", lambda loss: loss.fixed.frames, WHOLE, heads_group=True),
            Column("Blind", "s", lambda loss: loss.fixed.longest_blind_s, decimals(3)),
        ),
        rows=report.images,
        footnotes=(_IMAGE_NOTE,),
    )


_MOST_FIELDS = 7


def curve_table(curve: LossCurve) -> Table[CurvePoint]:
    """The error of each field at rising rates; of many fields the first, all are in ``--json``."""
    hidden = max(len(curve.fields) - _MOST_FIELDS, 0)
    proposal: tuple[str, ...] = ()
    if curve.breakpoints:
        tiers = ", ".join(f"{rate_hz:g}" for rate_hz in curve.breakpoints.tiers_hz)
        proposal = (f"Proposed levels: {tiers} Hz", f"({curve.breakpoints.origin})")
    return Table(
        title=f"{curve.topic}: RMSE over time when the last value received is held, by rate",
        subtitles=proposal,
        columns=tuple(_curve_columns(curve)),
        rows=curve.points,
        footnotes=(f"{hidden} more fields are in --json.",) if hidden else (),
    )


def _curve_columns(curve: LossCurve) -> Iterator[Column[CurvePoint]]:
    def rmse(number: int) -> Callable[[CurvePoint], float | None]:
        return lambda point: _rmse(_held(point.errors[number]))

    yield Column("Rate", "Hz", lambda point: point.rate_hz, measured)
    yield Column("Volume", "KB/s", lambda point: point.kb_per_s, measured)
    yield Column("Age", "s", lambda point: point.age.mean_s if point.age else None, decimals(3))
    for number, field in enumerate(curve.fields[:_MOST_FIELDS]):
        yield Column(field.name, field.unit, rmse(number), measured)
