# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The summary of a replay."""

from __future__ import annotations

from smarttestudo.composition.replay_outcome import ReplayOutcome, TopicOutcome
from smarttestudo.visualizer.comparison import change_percent
from smarttestudo.visualizer.table import Align, Column, Number, Row, Table, Text

_RATES_NOTE = (
    "Hz: (n − 1) / (last − first). Error: the mean against the lesser of target and source at each time; "
    "both are weighted by time."
)
_DECLARED_NOTE = "declared: the size that the recording declares for its messages, not the one it holds."


def replay_table(outcome: ReplayOutcome) -> Table:
    """Each relayed topic's messages, rates and volume, and the sum."""
    declared = any(topic.declared for topic in outcome.topics.values())
    rows = [_row(name, topic) for name, topic in outcome.topics.items()]
    return Table(
        title="Relayed topics",
        columns=(
            Column(heading="Topic", align=Align.LEFT),
            Column(heading="In"),
            Column(heading="Out"),
            Column(heading="Source", unit="Hz"),
            Column(heading="Target", unit="Hz"),
            Column(heading="Mean", unit="Hz"),
            Column(heading="Error", unit="%"),
            Column(heading="In", unit="KB"),
            Column(heading="Out", unit="KB"),
            Column(heading="Change", unit="%"),
            Column(heading="Sizes", align=Align.LEFT),
        ),
        rows=(*rows, _total(outcome)),
        footnotes=(_RATES_NOTE, _DECLARED_NOTE) if declared else (_RATES_NOTE,),
    )


def _row(name: str, topic: TopicOutcome) -> Row:
    return Row(
        cells=(
            Text(name),
            Number(topic.messages_in, decimals=0),
            Number(topic.messages_out, decimals=0),
            Number(topic.source_hz),
            Number(topic.target_hz),
            Number(topic.mean_hz),
            Number(topic.error_percent, signed=True),
            Number(topic.in_kb, decimals=1),
            Number(topic.out_kb, decimals=1),
            Number(change_percent(topic.in_kb, topic.out_kb), decimals=1, signed=True),
            Text("declared" if topic.declared else ""),
        )
    )


def _total(outcome: ReplayOutcome) -> Row:
    topics = outcome.topics.values()
    in_kb, out_kb = sum(topic.in_kb for topic in topics), sum(topic.out_kb for topic in topics)
    nothing = Number(None)
    return Row(
        cells=(
            Text("All"),
            Number(sum(topic.messages_in for topic in topics), decimals=0),
            Number(sum(topic.messages_out for topic in topics), decimals=0),
            *(nothing, nothing, nothing, nothing),
            Number(in_kb, decimals=1),
            Number(out_kb, decimals=1),
            Number(change_percent(in_kb, out_kb), decimals=1, signed=True),
            Text(""),
        ),
        is_total=True,
    )
