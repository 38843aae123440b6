# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Tables of a replay: the rates, the bounds and the volume of each relayed topic."""

from __future__ import annotations

from collections.abc import Iterator

from smarttestudo.bags.comparison import change_percent
from smarttestudo.pacing.bound import BoundRecord
from smarttestudo.replays.outcome import ReplayOutcome, TopicOutcome
from smarttestudo.report.comparison_tables import DECLARED, DECLARED_NOTE
from smarttestudo.report.table import WHOLE, Column, Table, change, decimals

_RATES_NOTE = (
    "Hz: (n − 1) / (last − first). Error: the mean against the target, or the source's mean where that is "
    "less. Target and error are weighted by time. Where the source's own rate varies, error says little."
)
_BOUNDS_NOTE = (
    "Bound and worst are in the property's unit: m, degrees, or the field's own. Worst is how far the "
    "operator's picture was off after any message of the source while the bound was in force; broken counts "
    "the messages after which it was more than the bound. Messages that cannot be read are not among them."
)
_FRAMES_NOTE = (
    "Transforms and other named streams have the rate for each, and so the means over them stand here."
)


def rates_table(outcome: ReplayOutcome) -> Table[tuple[str, TopicOutcome]]:
    """Table of each relayed topic's messages in and out, and how near its rate came to its target."""
    frames = any((topic.frames or 0) > 1 for topic in outcome.topics.values())
    return Table(
        title="Rates",
        columns=tuple(_rate_columns(repeats=any(topic.repeated for topic in outcome.topics.values()))),
        rows=[*outcome.topics.items()],
        footnotes=(_RATES_NOTE, _FRAMES_NOTE) if frames else (_RATES_NOTE,),
    )


def _rate_columns(*, repeats: bool) -> Iterator[Column[tuple[str, TopicOutcome]]]:
    yield Column("Topic", "", lambda row: row[0], is_text=True)
    yield Column("In", "", lambda row: row[1].messages_in, WHOLE)
    yield Column("Out", "", lambda row: row[1].messages_out, WHOLE)
    if repeats:
        yield Column("Repeated", "", lambda row: row[1].repeated, WHOLE)
    yield Column("Source", "Hz", lambda row: row[1].source_hz)
    yield Column("Target", "Hz", lambda row: row[1].target_hz)
    yield Column("Mean", "Hz", lambda row: row[1].mean_hz)
    yield Column("Error", "%", lambda row: row[1].error_percent, decimals(2, signed=True))


def bounds_table(outcome: ReplayOutcome) -> Table[tuple[str, str, BoundRecord]]:
    """How each bound of the receiver's picture was kept."""
    return Table(
        title="Bounds",
        columns=(
            Column("Topic", "", lambda row: row[0], is_text=True),
            Column("Property", "", lambda row: row[1], is_text=True),
            Column("Bound", "", lambda row: row[2].bound, decimals(3)),
            Column("Worst", "", lambda row: row[2].worst, decimals(3)),
            Column("Broken", "", lambda row: row[2].broken, WHOLE),
        ),
        rows=[
            (name, prop, record)
            for name, topic in outcome.topics.items()
            for prop, records in topic.bounds.items()
            for record in records
        ],
        footnotes=(_BOUNDS_NOTE,),
    )


def volume_table(outcome: ReplayOutcome) -> Table[tuple[str, TopicOutcome]]:
    """How much each relayed topic carried in and out, and the sum; declared sizes are labelled."""
    declared = any(topic.declared for topic in outcome.topics.values())
    return Table(
        title="Volume",
        columns=tuple(_volume_columns(outcome, declared=declared)),
        rows=[*outcome.topics.items()],
        footnotes=(DECLARED_NOTE,) if declared else (),
    )


def _volume_columns(outcome: ReplayOutcome, *, declared: bool) -> Iterator[Column[tuple[str, TopicOutcome]]]:
    in_kb = sum(topic.in_kb for topic in outcome.topics.values())
    out_kb = sum(topic.out_kb for topic in outcome.topics.values())
    changed = change_percent(in_kb, out_kb)
    yield Column("Topic", "", lambda row: row[0], is_text=True, sums=("All",))
    yield Column("In", "KB", lambda row: row[1].in_kb, decimals(1), sums=(in_kb,))
    yield Column("Out", "KB", lambda row: row[1].out_kb, decimals(1), sums=(out_kb,))
    yield Column("Change", "%", _change_percent, change, sums=(changed,))
    if declared:
        yield Column("Sizes", "", lambda row: DECLARED if row[1].declared else "", is_text=True)


def _change_percent(row: tuple[str, TopicOutcome]) -> float | None:
    return change_percent(row[1].in_kb, row[1].out_kb)
