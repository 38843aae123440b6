# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The frequency and the bandwidth table of a comparison."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from smarttestudo.report.table import Align, Column, Number, Row, Table, Text, percent_cell

if TYPE_CHECKING:
    from smarttestudo.bags.comparison import Comparison, TopicComparison
    from smarttestudo.bags.statistics import TopicStatistics

DECLARED = "declared"
_TOPIC = Column(heading="Topic", align=Align.LEFT)
_CHANGE = Column(heading="Change", unit="%")
_RATE_NOTE = "Hz: mean count of the 1 s bins from first to last message."
_TARGET_NOTE = (
    " Target: planned rate, weighted by time. Mean: (n − 1) / (last − first) of {}. "
    "Error: that mean against the target, or the source's mean where that is less."
)
_FRAMES_NOTE = " Of transforms and other named streams the target is that of each, and there is no error."
BANDWIDTH_NOTE = "1 KB is 1000 bytes; 1 KB/s is 8 kbit/s."
DECLARED_NOTE = "declared: the size that the recording declares for its messages, not the one it holds."


@dataclass(frozen=True, slots=True, kw_only=True)
class RunNames:
    """The names of the two runs of a comparison in headings."""

    before: str = "Source"
    after: str = "SmartTestudo"


def frequency_table(comparison: Comparison, names: RunNames | None = None) -> Table:
    """The rate of each topic in both runs, its change, and how near it came to its target if there is any."""
    names = names or RunNames()
    targets = [pair.target for pair in comparison.topics if pair.target is not None]
    has_targets = bool(targets)
    frames_note = _FRAMES_NOTE if any(one.attainable_hz is None for one in targets) else ""
    target_columns = (
        Column(heading="Target", unit="Hz"),
        Column(heading="Mean", unit="Hz"),
        Column(heading="Error", unit="%"),
    )
    target_note = _TARGET_NOTE.format(names.after) + frames_note
    return Table(
        title="Frequency",
        columns=(
            _TOPIC,
            Column(heading=names.before, unit="Hz"),
            Column(heading=names.after, unit="Hz"),
            _CHANGE,
            *(target_columns if has_targets else ()),
        ),
        rows=tuple(_frequency_row(pair, has_targets=has_targets) for pair in comparison.topics),
        footnotes=(_RATE_NOTE + target_note if has_targets else _RATE_NOTE,),
    )


def bandwidth_table(comparison: Comparison, names: RunNames | None = None) -> Table:
    """The bandwidth of each topic in both runs with its change, and the sum; declared sizes are labelled."""
    names = names or RunNames()
    declared = any(_is_declared(pair) for pair in comparison.topics)
    columns = (
        _TOPIC,
        Column(heading=names.before, unit="KB/s"),
        Column(heading=names.after, unit="KB/s"),
        _CHANGE,
        Column(heading="Sizes", align=Align.LEFT),
    )
    rows = (*(_bandwidth_row(pair) for pair in comparison.topics), _total_row(comparison, declared=declared))
    return Table(
        title="Bandwidth",
        columns=columns,
        rows=rows,
        footnotes=(BANDWIDTH_NOTE, DECLARED_NOTE) if declared else (BANDWIDTH_NOTE,),
    )


def _frequency_row(pair: TopicComparison, *, has_targets: bool) -> Row:
    target = (
        Number(None if pair.target is None else pair.target.planned_hz),
        Number(None if pair.target is None or pair.after is None else pair.after.mean_hz),
        Number(pair.error_percent, signed=True),
    )
    return Row(
        cells=(
            Text(pair.topic),
            _frequency(pair.before),
            _frequency(pair.after),
            percent_cell(pair.change_percent, signed=True),
            *(target if has_targets else ()),
        )
    )


def _bandwidth_row(pair: TopicComparison) -> Row:
    return Row(
        cells=(
            Text(pair.topic),
            _bandwidth(pair.before),
            _bandwidth(pair.after),
            percent_cell(pair.bandwidth_change_percent, signed=True),
            Text(DECLARED if _is_declared(pair) else "recorded"),
        )
    )


def _total_row(comparison: Comparison, *, declared: bool) -> Row:
    return Row(
        cells=(
            Text("All topics"),
            Number(comparison.before_kb_per_s),
            Number(comparison.after_kb_per_s),
            percent_cell(comparison.bandwidth_change_percent, signed=True),
            Text("mixed" if declared else "recorded"),
        ),
        is_total=True,
    )


def _is_declared(pair: TopicComparison) -> bool:
    return any(side is not None and side.declared for side in (pair.before, pair.after))


def _frequency(side: TopicStatistics | None) -> Number:
    return Number(None if side is None else side.binned_hz)


def _bandwidth(side: TopicStatistics | None) -> Number:
    return Number(None if side is None else side.kb_per_s)
