# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Tables of recordings, robots, topics and rules, the worst first."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TypeVar

from smarttestudo.domain.units import S_PER_HOUR, counted, utc_time
from smarttestudo.report.fleet.numbers import (
    BoundSums,
    RecordingNumbers,
    RuleSums,
    Sums,
    Volume,
    of_recording,
    percent,
)
from smarttestudo.report.fleet.totals import MOST_ROWS, FleetTotals
from smarttestudo.report.summary import volume_unit
from smarttestudo.report.table import WHOLE, Column, Table, decimals, measured, percent_number, percent_text

DEFAULTS = "Defaults"
_LOST_NOTE = (
    "Lost: messages of the robot that the operator did not get, also those that rules held back; %: of the "
    "messages of topics that both have. Age: the longest time without a newer message. Share: of all bytes "
    "received."
)
_OFF_NOTE = (
    " Off: the error of the robot's place when the last one received is held, the RMSE of a recording."
)
_RULE_NOTE = (
    "Decided: how long the rule decided more topics than other rules. All else is of topics while the rule "
    "decided them, to the second. The rules decided over the recordings of the robots once more."
)
_BOUND_NOTE = (
    "Messages of the robots while the bound was in force, broken where the operator's picture was more than "
    "the bound off after them. Worst: the largest error."
)
_Summed = TypeVar("_Summed", bound=Volume)


def recording_table(totals: FleetTotals) -> Table[tuple[RecordingNumbers, Sums]]:
    """The worst recordings."""
    shown = [(recording, of_recording(recording)) for recording in totals.worst]
    return Table(
        title="Recordings",
        columns=(
            Column("Recording", "", lambda row: row[0].a, is_text=True),
            *_loss_columns(totals),
            *_volume_columns(totals, [sums for _, sums in shown]),
            Column("Duration", "s", lambda row: row[0].span.duration_s, decimals(1), heads_group=True),
            Column(
                "Recorded",
                "UTC",
                lambda row: "" if row[0].span.is_empty else utc_time(row[0].span.start_ns)[:16],
                is_text=True,
            ),
        ),
        rows=shown,
        footnotes=_more(totals.all.recordings - len(shown), "recording"),
    )


def robot_table(totals: FleetTotals) -> Table[tuple[str, Sums]]:
    """The robots."""
    shown, more = worst(totals, totals.robots)
    return Table(
        title="Robots",
        columns=(
            Column("Robot", "", lambda row: row[0], is_text=True),
            *_loss_columns(totals),
            *_volume_columns(totals, [sums for _, sums in shown]),
            Column("Recordings", "", lambda row: row[1].recordings, WHOLE, heads_group=True),
            Column("Recorded", "h", lambda row: row[1].duration_s / S_PER_HOUR),
        ),
        rows=shown,
        footnotes=_more(more, "robot"),
    )


def topic_table(totals: FleetTotals) -> Table[tuple[str, Sums]]:
    """The topics, each with its share of all bytes."""
    shown, more = worst(totals, totals.topics)
    return Table(
        title="Topics",
        columns=(
            Column("Topic", "", lambda row: row[0], is_text=True),
            *_loss_columns(totals),
            Column("Share", "%", lambda row: cost_percent(totals, row[1]), percent_number, heads_group=True),
            *_volume_columns(totals, [sums for _, sums in shown]),
            Column("Recordings", "", lambda row: row[1].recordings, WHOLE, heads_group=True),
        ),
        rows=shown,
        footnotes=(*_more(more, "topic"), *_notes(totals)),
    )


def rule_table(totals: FleetTotals) -> Table[tuple[str, RuleSums]]:
    """The rules that decided, and the defaults."""
    shown, more = worst(totals, totals.rules)
    return Table(
        title="Rules",
        columns=(
            Column("Rule", "", lambda row: row[0] or DEFAULTS, is_text=True),
            *_lost_columns(totals),
            *_volume_columns(totals, [sums for _, sums in shown]),
            Column("Decided", "h", lambda row: row[1].decided_s / S_PER_HOUR, heads_group=True),
            Column("Decisions", "", lambda row: row[1].decisions, WHOLE),
            Column("Recordings", "", lambda row: row[1].recordings, WHOLE),
        ),
        rows=shown,
        footnotes=(*_more(more, "rule"), _RULE_NOTE),
    )


def bound_table(totals: FleetTotals) -> Table[tuple[tuple[str, float, str], BoundSums]]:
    """The bounds of the rules, those that were broken most often first."""
    ranked = sorted(
        totals.bounds.items(), key=lambda ranked_bound: (-ranked_bound[1].broken, ranked_bound[0])
    )
    return Table(
        title="Bounds of the rules",
        columns=(
            Column("Picture", "", lambda row: row[0][0], is_text=True),
            Column("Broken", "", lambda row: row[1].broken, WHOLE, heads_group=True),
            Column("Broken", "%", lambda row: percent(row[1].broken, row[1].messages), percent_number),
            Column("Worst", "", lambda row: row[1].worst, measured),
            Column("Bound", "", lambda row: row[0][1], measured),
            Column("Unit", "", lambda row: row[0][2], is_text=True),
            Column("Messages", "", lambda row: row[1].messages, WHOLE, heads_group=True),
            Column("Recordings", "", lambda row: row[1].recordings, WHOLE),
        ),
        rows=ranked[:MOST_ROWS],
        footnotes=(*_more(max(len(ranked) - MOST_ROWS, 0), "bound"), _BOUND_NOTE),
    )


def worst(totals: FleetTotals, of: Mapping[str, _Summed]) -> tuple[Sequence[tuple[str, _Summed]], int]:
    """The worst of topics, robots or rules by name, and how many more there are."""
    ranked = sorted(of.items(), key=lambda one: ([-part for part in totals.rank(one[1])], one[0]))
    return ranked[:MOST_ROWS], max(len(ranked) - MOST_ROWS, 0)


def share_text(percent_of_all: float | None) -> str:
    """A share in words."""
    return "no messages" if percent_of_all is None else percent_text(percent_of_all)


def cost_percent(totals: FleetTotals, sums: Sums) -> float | None:
    """The share of the bytes that the operator received, or, where nobody knows, of all."""
    if totals.are_pairs:
        return percent(sums.received_bytes, totals.all.received_bytes)
    return percent(sums.size_bytes, totals.all.size_bytes)


def _volume_columns(totals: FleetTotals, shown: Sequence[Volume]) -> Iterator[Column[tuple[object, Volume]]]:
    """In a unit of bytes in which the largest has three digits or more."""
    size, unit = volume_unit(max((sums.size_bytes for sums in shown), default=0) / 100)
    if totals.are_pairs:
        yield Column("Received", unit, lambda row: row[1].received_bytes / size, heads_group=True)
    yield Column("Volume", unit, lambda row: row[1].size_bytes / size, heads_group=not totals.are_pairs)
    yield Column("Messages", "", lambda row: row[1].messages, WHOLE)


def _loss_columns(totals: FleetTotals) -> Iterator[Column[tuple[object, Sums]]]:
    yield from _lost_columns(totals)
    if totals.are_pairs:
        yield Column("Age", "s", lambda row: row[1].age_max_s, decimals(1))
        if totals.all.position_m is not None:
            yield Column("Off", "m", lambda row: row[1].position_m, measured)


def _lost_columns(totals: FleetTotals) -> Iterator[Column[tuple[object, Volume]]]:
    if totals.are_pairs:
        yield Column("Lost", "", _lost, WHOLE, heads_group=True)
        yield Column("Lost", "%", lambda row: row[1].lost_percent, percent_number)


def _lost(row: tuple[object, Volume]) -> int | None:
    return row[1].lost if row[1].shared_messages else None


def _more(count: int, noun: str) -> tuple[str, ...]:
    return (
        (f"… and {counted(count, f'more {noun}')}; --json, --csv and --parquet have them all.",)
        if count
        else ()
    )


def _notes(totals: FleetTotals) -> tuple[str, ...]:
    if not totals.are_pairs:
        return ("Share: of all bytes.",)
    return (_LOST_NOTE + (_OFF_NOTE if totals.all.position_m is not None else ""),)
