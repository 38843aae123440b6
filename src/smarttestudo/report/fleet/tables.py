# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Tables of recordings, robots, topics and rules, the worst first."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TypeVar

from smarttestudo.domain.units import counted, utc_time
from smarttestudo.report.fleet.sums import Sums, Volume, of_recording, percent
from smarttestudo.report.fleet.totals import MOST_ROWS, FleetTotals
from smarttestudo.report.loss_tables import measured
from smarttestudo.report.summary import volume_unit
from smarttestudo.report.table import (
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

DEFAULTS = "Defaults"
_S_PER_H = 3600
_LOST = (Column(heading="Lost", heads_group=True), Column(heading="Lost", unit="%"))
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


def recording_table(totals: FleetTotals) -> Table:
    """The worst recordings."""
    shown = [(one, of_recording(one)) for one in totals.worst]
    unit = _unit([sums for _, sums in shown])
    return Table(
        title="Recordings",
        columns=(
            Column(heading="Recording", align=Align.LEFT),
            *_loss_columns(totals),
            *_volume_columns(totals, unit),
            Column(heading="Duration", unit="s", heads_group=True),
            Column(heading="Recorded", unit="UTC", align=Align.LEFT),
        ),
        rows=tuple(
            Row(
                cells=(
                    Text(one.a),
                    *_loss_cells(totals, sums),
                    *_volume_cells(totals, sums, unit),
                    Number(one.duration_s, decimals=1),
                    Text("" if one.is_empty else utc_time(one.start_ns)[:16]),
                )
            )
            for one, sums in shown
        ),
        footnotes=_more(totals.all.recordings - len(shown), "recording"),
    )


def robot_table(totals: FleetTotals) -> Table:
    """The robots."""
    shown, more = worst(totals, totals.robots)
    unit = _unit([sums for _, sums in shown])
    return Table(
        title="Robots",
        columns=(
            Column(heading="Robot", align=Align.LEFT),
            *_loss_columns(totals),
            *_volume_columns(totals, unit),
            Column(heading="Recordings", heads_group=True),
            Column(heading="Recorded", unit="h"),
        ),
        rows=tuple(
            Row(
                cells=(
                    Text(name),
                    *_loss_cells(totals, sums),
                    *_volume_cells(totals, sums, unit),
                    Number(sums.recordings, decimals=0),
                    Number(sums.duration_s / _S_PER_H),
                )
            )
            for name, sums in shown
        ),
        footnotes=_more(more, "robot"),
    )


def topic_table(totals: FleetTotals) -> Table:
    """The topics, each with its share of all bytes."""
    shown, more = worst(totals, totals.topics)
    unit = _unit([sums for _, sums in shown])
    return Table(
        title="Topics",
        columns=(
            Column(heading="Topic", align=Align.LEFT),
            *_loss_columns(totals),
            Column(heading="Share", unit="%", heads_group=True),
            *_volume_columns(totals, unit),
            Column(heading="Recordings", heads_group=True),
        ),
        rows=tuple(
            Row(
                cells=(
                    Text(name),
                    *_loss_cells(totals, sums),
                    percent_cell(cost_percent(totals, sums)),
                    *_volume_cells(totals, sums, unit),
                    Number(sums.recordings, decimals=0),
                )
            )
            for name, sums in shown
        ),
        footnotes=(*_more(more, "topic"), *_notes(totals)),
    )


def rule_table(totals: FleetTotals) -> Table:
    """The rules that decided, and the defaults."""
    shown, more = worst(totals, totals.rules)
    unit = _unit([sums for _, sums in shown])
    return Table(
        title="Rules",
        columns=(
            Column(heading="Rule", align=Align.LEFT),
            *(_LOST if totals.are_pairs else ()),
            *_volume_columns(totals, unit),
            Column(heading="Decided", unit="h", heads_group=True),
            Column(heading="Decisions"),
            Column(heading="Recordings"),
        ),
        rows=tuple(
            Row(
                cells=(
                    Text(name or DEFAULTS),
                    *(_lost_cells(sums) if totals.are_pairs else ()),
                    *_volume_cells(totals, sums, unit),
                    Number(sums.decided_s / _S_PER_H),
                    Number(sums.decisions, decimals=0),
                    Number(sums.recordings, decimals=0),
                )
            )
            for name, sums in shown
        ),
        footnotes=(*_more(more, "rule"), _RULE_NOTE),
    )


def bound_table(totals: FleetTotals) -> Table:
    """The bounds of the rules, those that were broken most often first."""
    ranked = sorted(totals.bounds.items(), key=lambda one: (-one[1].broken, one[0]))
    return Table(
        title="Bounds of the rules",
        columns=(
            Column(heading="Picture", align=Align.LEFT),
            Column(heading="Broken", heads_group=True),
            Column(heading="Broken", unit="%"),
            Column(heading="Worst"),
            Column(heading="Bound"),
            Column(heading="Unit", align=Align.LEFT),
            Column(heading="Messages", heads_group=True),
            Column(heading="Recordings"),
        ),
        rows=tuple(
            Row(
                cells=(
                    Text(picture),
                    Number(sums.broken, decimals=0),
                    percent_cell(percent(sums.broken, sums.messages)),
                    measured(sums.worst),
                    measured(bound),
                    Text(unit),
                    Number(sums.messages, decimals=0),
                    Number(sums.recordings, decimals=0),
                )
            )
            for (picture, bound, unit), sums in ranked[:MOST_ROWS]
        ),
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


_Unit = tuple[int, str]


def _unit(shown: Sequence[Volume]) -> _Unit:
    """A unit of bytes in which the largest has three digits or more."""
    return volume_unit(max((sums.size_bytes for sums in shown), default=0) / 100)


def _volume_columns(totals: FleetTotals, unit: _Unit) -> tuple[Column, ...]:
    received = (Column(heading="Received", unit=unit[1], heads_group=True),) if totals.are_pairs else ()
    return (
        *received,
        Column(heading="Volume", unit=unit[1], heads_group=not received),
        Column(heading="Messages"),
    )


def _volume_cells(totals: FleetTotals, sums: Volume, unit: _Unit) -> tuple[Cell, ...]:
    received = (Number(sums.received_bytes / unit[0]),) if totals.are_pairs else ()
    return (*received, Number(sums.size_bytes / unit[0]), Number(sums.messages, decimals=0))


def _loss_columns(totals: FleetTotals) -> tuple[Column, ...]:
    if not totals.are_pairs:
        return ()
    off = (Column(heading="Off", unit="m"),) if totals.all.position_m is not None else ()
    return (*_LOST, Column(heading="Age", unit="s"), *off)


def _loss_cells(totals: FleetTotals, sums: Sums) -> tuple[Cell, ...]:
    if not totals.are_pairs:
        return ()
    off = (measured(sums.position_m),) if totals.all.position_m is not None else ()
    return (*_lost_cells(sums), Number(sums.age_max_s, decimals=1), *off)


def _lost_cells(sums: Volume) -> tuple[Cell, ...]:
    lost = Number(sums.lost if sums.shared_messages else None, decimals=0)
    return lost, percent_cell(sums.lost_percent)


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
