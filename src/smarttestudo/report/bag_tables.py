# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Tables of a recording: its topics, their rates and their bandwidth."""

from __future__ import annotations

from smarttestudo.bags.bag_summary import BagSummary, BagTopic
from smarttestudo.bags.incident_mark import incident_subtitles
from smarttestudo.bags.statistics import LONGEST_LATENCY_S
from smarttestudo.domain.recording import readable_until
from smarttestudo.domain.units import BYTES_PER_KB, counted, grouped, utc_time
from smarttestudo.report.comparison_tables import BANDWIDTH_NOTE, DECLARED, DECLARED_NOTE
from smarttestudo.report.table import Align, Cell, Column, Number, Row, Table, Text

_MS_PER_S = 1000
_TOPIC = Column(heading="Topic", align=Align.LEFT)
_SIZES = Column(heading="Sizes", align=Align.LEFT)
_RATES_NOTE = (
    "Mean: (n − 1) / (last − first). Binned: mean count of the 1 s bins from first to last message. "
    "Longest gap: between two messages. Jitter: standard deviation of the intervals."
)
_LATENCY = (
    Column(heading="Latency", unit="ms"),
    Column(heading="p95", unit="ms"),
    Column(heading="max", unit="ms"),
)
_LATENCY_NOTE = (
    " Latency: receive time − header.stamp, mean, not exceeded by 95 %, and largest, "
    "of messages that begin with a header. Stamps of 0, 0.1 s after the reception or more than "
    f"{LONGEST_LATENCY_S} s before it do not count."
)


def info_table(bag: BagSummary) -> Table:
    """When and how the bag was recorded, and each topic with its type and quality of service."""
    has_declared = _has_declared(bag)
    rows = tuple(
        Row(
            cells=(
                Text(topic.name),
                Text(topic.type_name),
                Number(topic.statistics.messages, decimals=0),
                Number(_message_kb(topic)),
                *_sizes(topic, has_declared=has_declared),
                Text(topic.qos),
            )
        )
        for topic in bag.topics
    )
    span = bag.span
    return Table(
        title=f"{bag.name}: {bag.storage.value}, {grouped(span.duration_s, 3)} s, "
        f"{counted(bag.total.messages, 'message')}",
        subtitles=(
            *(() if span.is_empty else (f"from {utc_time(span.start_ns)} to {utc_time(span.end_ns)}",)),
            *incident_subtitles(bag.incident),
            *_damage(bag),
        ),
        columns=(
            _TOPIC,
            Column(heading="Type", align=Align.LEFT),
            Column(heading="Messages"),
            Column(heading="Mean size", unit="KB"),
            *_sizes_column(bag),
            Column(heading="QoS", align=Align.LEFT),
        ),
        rows=rows,
        footnotes=_notes(bag),
    )


def rates_table(bag: BagSummary) -> Table:
    """How fast and how evenly each topic came, and how late where that was measured."""
    has_latency = any(topic.latency is not None for topic in bag.topics)
    return Table(
        title=f"{bag.name}: rates",
        subtitles=incident_subtitles(bag.incident),
        columns=(
            _TOPIC,
            Column(heading="Messages"),
            Column(heading="Mean", unit="Hz"),
            Column(heading="Binned", unit="Hz"),
            Column(heading="Longest gap", unit="s"),
            Column(heading="Jitter", unit="ms"),
            *(_LATENCY if has_latency else ()),
        ),
        rows=tuple(Row(cells=_rate_cells(topic)) for topic in bag.topics),
        footnotes=(_RATES_NOTE + _LATENCY_NOTE if has_latency else _RATES_NOTE,),
    )


def _rate_cells(topic: BagTopic) -> tuple[Cell, ...]:
    latency = topic.latency
    latencies_s = () if latency is None else (latency.mean_s, latency.p95_s, latency.max_s)
    return (
        Text(topic.name),
        Number(topic.statistics.messages, decimals=0),
        Number(topic.statistics.mean_hz),
        Number(topic.statistics.binned_hz),
        Number(topic.longest_gap_s, decimals=3),
        *(_milliseconds(seconds) for seconds in (topic.jitter_s, *latencies_s)),
    )


def _milliseconds(seconds: float | None) -> Number:
    return Number(None if seconds is None else seconds * _MS_PER_S)


def bandwidth_table(bag: BagSummary) -> Table:
    """How much each topic carried, and the sum; declared sizes are labelled."""
    total = bag.total
    sum_row = Row(
        cells=(
            Text("All topics"),
            Number(total.size_bytes / BYTES_PER_KB),
            Number(total.kb_per_s),
            Number(total.kbit_per_s),
            *((Text(_total_label(bag)),) if _has_declared(bag) else ()),
        ),
        is_total=True,
    )
    rows = tuple(
        Row(
            cells=(
                Text(topic.name),
                Number(topic.statistics.size_bytes / BYTES_PER_KB),
                Number(topic.statistics.kb_per_s),
                Number(topic.statistics.kbit_per_s),
                *_sizes(topic, has_declared=_has_declared(bag)),
            )
        )
        for topic in bag.topics
    )
    return Table(
        title=f"{bag.name}: bandwidth",
        subtitles=incident_subtitles(bag.incident),
        columns=(
            _TOPIC,
            Column(heading="Volume", unit="KB"),
            Column(heading="Mean", unit="KB/s"),
            Column(heading="Mean", unit="kbit/s"),
            *_sizes_column(bag),
        ),
        rows=(*rows, sum_row),
        footnotes=(BANDWIDTH_NOTE, *_notes(bag)),
    )


def _damage(bag: BagSummary) -> tuple[str, ...]:
    if bag.readable_share == 1:
        return ()
    unknown = "; how much is missing is not known" if bag.readable_share is None else ""
    return (f"damaged: {readable_until(bag.readable_share, bag.span.end_ns)}{unknown}",)


def _message_kb(topic: BagTopic) -> float | None:
    statistics = topic.statistics
    return statistics.size_bytes / statistics.messages / BYTES_PER_KB if statistics.messages else None


def _has_declared(bag: BagSummary) -> bool:
    return any(topic.statistics.declared for topic in bag.topics)


def _total_label(bag: BagSummary) -> str:
    return DECLARED if all(topic.statistics.declared for topic in bag.topics) else "mixed"


def _sizes_column(bag: BagSummary) -> tuple[Column, ...]:
    return (_SIZES,) if _has_declared(bag) else ()


def _sizes(topic: BagTopic, *, has_declared: bool) -> tuple[Cell, ...]:
    label = DECLARED if topic.statistics.declared else "recorded"
    return (Text(label),) if has_declared else ()


def _notes(bag: BagSummary) -> tuple[str, ...]:
    return (DECLARED_NOTE,) if _has_declared(bag) else ()
