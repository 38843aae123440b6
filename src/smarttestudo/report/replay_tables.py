# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Tables of a replay: the rates, the bounds and the volume of each relayed topic."""

from __future__ import annotations

from smarttestudo.bags.comparison import change_percent
from smarttestudo.replays.outcome import ReplayOutcome, TopicOutcome
from smarttestudo.report.comparison_tables import DECLARED
from smarttestudo.report.table import Align, Column, Number, Row, Table, Text, percent_cell

_TOPIC = Column(heading="Topic", align=Align.LEFT)
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
_DECLARED_NOTE = "declared: the size that the recording declares for its messages, not the one it holds."


def rates_table(outcome: ReplayOutcome) -> Table:
    """Table of each relayed topic's messages in and out, and how near its rate came to its target."""
    repeats = any(topic.repeated for topic in outcome.topics.values())
    frames = any((topic.frames or 0) > 1 for topic in outcome.topics.values())
    return Table(
        title="Rates",
        columns=(
            _TOPIC,
            Column(heading="In"),
            Column(heading="Out"),
            *((Column(heading="Repeated"),) if repeats else ()),
            Column(heading="Source", unit="Hz"),
            Column(heading="Target", unit="Hz"),
            Column(heading="Mean", unit="Hz"),
            Column(heading="Error", unit="%"),
        ),
        rows=tuple(_rates(name, topic, repeats=repeats) for name, topic in outcome.topics.items()),
        footnotes=(_RATES_NOTE, _FRAMES_NOTE) if frames else (_RATES_NOTE,),
    )


def bounds_table(outcome: ReplayOutcome) -> Table:
    """How each bound of the receiver's picture was kept."""
    rows = tuple(
        Row(
            cells=(
                Text(name),
                Text(prop),
                Number(one.bound, decimals=3),
                Number(one.worst, decimals=3),
                Number(one.broken, decimals=0),
            )
        )
        for name, topic in outcome.topics.items()
        for prop, records in topic.bounds.items()
        for one in records
    )
    return Table(
        title="Bounds",
        columns=(
            _TOPIC,
            Column(heading="Property", align=Align.LEFT),
            Column(heading="Bound"),
            Column(heading="Worst"),
            Column(heading="Broken"),
        ),
        rows=rows,
        footnotes=(_BOUNDS_NOTE,),
    )


def volume_table(outcome: ReplayOutcome) -> Table:
    """How much each relayed topic carried in and out, and the sum; declared sizes are labelled."""
    topics = outcome.topics
    declared = any(topic.declared for topic in topics.values())
    total = Row(
        cells=(
            Text("All"),
            *_volumes(
                sum(topic.in_kb for topic in topics.values()), sum(topic.out_kb for topic in topics.values())
            ),
            *((Text(""),) if declared else ()),
        ),
        is_total=True,
    )
    return Table(
        title="Volume",
        columns=(
            _TOPIC,
            Column(heading="In", unit="KB"),
            Column(heading="Out", unit="KB"),
            Column(heading="Change", unit="%"),
            *((Column(heading="Sizes", align=Align.LEFT),) if declared else ()),
        ),
        rows=(*(_volume(name, topic, declared=declared) for name, topic in topics.items()), total),
        footnotes=(_DECLARED_NOTE,) if declared else (),
    )


def _rates(name: str, topic: TopicOutcome, *, repeats: bool) -> Row:
    return Row(
        cells=(
            Text(name),
            Number(topic.messages_in, decimals=0),
            Number(topic.messages_out, decimals=0),
            *((Number(topic.repeated, decimals=0),) if repeats else ()),
            Number(topic.source_hz),
            Number(topic.target_hz),
            Number(topic.mean_hz),
            Number(topic.error_percent, signed=True),
        )
    )


def _volume(name: str, topic: TopicOutcome, *, declared: bool) -> Row:
    label = (Text(DECLARED if topic.declared else ""),) if declared else ()
    return Row(cells=(Text(name), *_volumes(topic.in_kb, topic.out_kb), *label))


def _volumes(in_kb: float, out_kb: float) -> tuple[Number, Number, Number]:
    change = percent_cell(change_percent(in_kb, out_kb), signed=True)
    return Number(in_kb, decimals=1), Number(out_kb, decimals=1), change
