# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Tables 7.1 and 7.2 of the thesis (Riccardi 2025): what adaptive monitoring changes of each topic.

They compare frequency and bandwidth without rules (default) and with them (adaptive).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from types import MappingProxyType

from smarttestudo.bags.comparison import Comparison, TopicComparison
from smarttestudo.bags.statistics import TopicStatistics
from smarttestudo.report.table import Align, Column, Number, Row, Table, Text, percent_cell

THESIS_CHANGE_PERCENT: Mapping[str, float] = MappingProxyType(
    {
        "/camera/camera_info": -89.5,
        "/camera/image_raw": -89.6,
        "/imu": -94.7,
        "/joint_states": -38.9,
        "/scan": 18.0,
        "/tf": -66.4,
    }
)
"""The changes of frequencies that the thesis reports, as far as they are known here."""

_KBIT_PER_KB = 8
_DEFAULT, _ADAPTIVE = "Default", "Adaptive"
_TOPIC = Column(heading="Topic", align=Align.LEFT)
_CHANGE = Column(heading="Change", unit="%")
_RATE_NOTE = "Frequency: mean count of the 1 s bins from the first to the last message, as in the thesis."
_THESIS_NOTE = "Thesis: the change that the thesis reports, where that is known here."
_KBIT_NOTES = (
    "1 kbit is 1000 bits.",
    "The thesis counts by 1024 in places: its absolute numbers differ by that, its changes do not.",
)


def frequency_as_in_thesis(comparison: Comparison) -> Table:
    """Table 7.1: the frequency of each topic that both runs have, and its change beside the thesis's."""
    return Table(
        title="Table 7.1: frequency of each topic",
        columns=(
            _TOPIC,
            Column(heading=_DEFAULT, unit="Hz"),
            Column(heading=_ADAPTIVE, unit="Hz"),
            _CHANGE,
            Column(heading="Thesis", unit="%"),
        ),
        rows=tuple(
            Row(
                cells=(
                    Text(pair.topic),
                    Number(before.binned_hz),
                    Number(after.binned_hz),
                    percent_cell(pair.change_percent, signed=True),
                    percent_cell(THESIS_CHANGE_PERCENT.get(pair.topic), signed=True),
                )
            )
            for pair, before, after in _in_both(comparison)
        ),
        footnotes=(_RATE_NOTE, _THESIS_NOTE),
    )


def bandwidth_as_in_thesis(comparison: Comparison) -> Table:
    """Table 7.2: the bandwidth of each topic that both runs have, in kbit/s, and its change."""
    return Table(
        title="Table 7.2: bandwidth of each topic",
        columns=(
            _TOPIC,
            Column(heading=_DEFAULT, unit="kbit/s"),
            Column(heading=_ADAPTIVE, unit="kbit/s"),
            _CHANGE,
        ),
        rows=tuple(
            Row(
                cells=(
                    Text(pair.topic),
                    _kbit_per_s(before),
                    _kbit_per_s(after),
                    percent_cell(pair.bandwidth_change_percent, signed=True),
                )
            )
            for pair, before, after in _in_both(comparison)
        ),
        footnotes=_KBIT_NOTES,
    )


def _in_both(
    comparison: Comparison,
) -> Iterable[tuple[TopicComparison, TopicStatistics, TopicStatistics]]:
    return (
        (pair, pair.before, pair.after)
        for pair in comparison.topics
        if pair.before is not None and pair.after is not None
    )


def _kbit_per_s(side: TopicStatistics) -> Number:
    return Number(None if side.kb_per_s is None else _KBIT_PER_KB * side.kb_per_s)
