# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Tables of a recording: its topics, their rates and their bandwidth."""

from __future__ import annotations

from collections.abc import Iterator

from smarttestudo.bags.bag_summary import BagSummary, BagTopic
from smarttestudo.bags.incident_record import incident_subtitles
from smarttestudo.bags.statistics import LONGEST_LATENCY_S
from smarttestudo.domain.recording import readable_until
from smarttestudo.domain.units import BYTES_PER_KB, counted, grouped, utc_time
from smarttestudo.report.comparison_tables import BANDWIDTH_NOTE, DECLARED, DECLARED_NOTE
from smarttestudo.report.table import WHOLE, Column, Table, decimals

_MS_PER_S = 1000
_TOPIC: Column[BagTopic] = Column("Topic", "", lambda topic: topic.name, is_text=True)
_MESSAGES: Column[BagTopic] = Column("Messages", "", lambda topic: topic.statistics.messages, WHOLE)
_RATES_NOTE = (
    "Mean: (n − 1) / (last − first). Binned: mean count of the 1 s bins from first to last message. "
    "Longest gap: between two messages. Jitter: standard deviation of the intervals."
)
_LATENCY_NOTE = (
    " Latency: receive time − header.stamp, mean, not exceeded by 95 %, and largest, "
    "of messages that begin with a header. Stamps of 0, 0.1 s after the reception or more than "
    f"{LONGEST_LATENCY_S} s before it do not count."
)


def info_table(bag: BagSummary) -> Table[BagTopic]:
    """When and how the bag was recorded, and each topic with its type and quality of service."""
    span = bag.span
    return Table(
        title=f"{bag.name}: {bag.storage.value}, {grouped(span.duration_s, 3)} s, "
        f"{counted(bag.total.messages, 'message')}",
        subtitles=(
            *(() if span.is_empty else (f"from {utc_time(span.start_ns)} to {utc_time(span.end_ns)}",)),
            *incident_subtitles(bag.incident),
            *_damage(bag),
            *_own_topics(bag),
        ),
        columns=tuple(_info_columns(bag)),
        rows=bag.topics,
        footnotes=_notes(bag),
    )


def _info_columns(bag: BagSummary) -> Iterator[Column[BagTopic]]:
    yield _TOPIC
    yield Column("Type", "", lambda topic: topic.type_name, is_text=True)
    yield _MESSAGES
    yield Column("Mean size", "KB", _message_kb)
    if _has_declared(bag):
        yield Column("Sizes", "", _sizes, is_text=True)
    yield Column("QoS", "", lambda topic: topic.qos, is_text=True)


def rates_table(bag: BagSummary) -> Table[BagTopic]:
    """How fast and how evenly each topic arrived, and how late where that was measured."""
    has_latency = any(topic.latency is not None for topic in bag.topics)
    return Table(
        title=f"{bag.name}: rates",
        subtitles=incident_subtitles(bag.incident),
        columns=tuple(_rate_columns(has_latency=has_latency)),
        rows=bag.topics,
        footnotes=(_RATES_NOTE + _LATENCY_NOTE if has_latency else _RATES_NOTE,),
    )


def _rate_columns(*, has_latency: bool) -> Iterator[Column[BagTopic]]:
    yield _TOPIC
    yield _MESSAGES
    yield Column("Mean", "Hz", lambda topic: topic.statistics.mean_hz)
    yield Column("Binned", "Hz", lambda topic: topic.statistics.binned_hz)
    yield Column("Longest gap", "s", lambda topic: topic.longest_gap_s, decimals(3))
    yield Column("Jitter", "ms", lambda topic: _ms(topic.jitter_s))
    if has_latency:
        yield Column("Latency", "ms", lambda topic: _ms(topic.latency.mean_s if topic.latency else None))
        yield Column("p95", "ms", lambda topic: _ms(topic.latency.p95_s if topic.latency else None))
        yield Column("max", "ms", lambda topic: _ms(topic.latency.max_s if topic.latency else None))


def _ms(seconds: float | None) -> float | None:
    return None if seconds is None else seconds * _MS_PER_S


def bandwidth_table(bag: BagSummary) -> Table[BagTopic]:
    """How much each topic carried, and the sum; declared sizes are labelled."""
    return Table(
        title=f"{bag.name}: bandwidth",
        subtitles=incident_subtitles(bag.incident),
        columns=tuple(_bandwidth_columns(bag)),
        rows=bag.topics,
        footnotes=(BANDWIDTH_NOTE, *_notes(bag)),
    )


def _bandwidth_columns(bag: BagSummary) -> Iterator[Column[BagTopic]]:
    total = bag.total
    volume_kb = total.size_bytes / BYTES_PER_KB
    yield Column("Topic", "", lambda topic: topic.name, is_text=True, sums=("All topics",))
    yield Column("Volume", "KB", lambda topic: topic.statistics.size_bytes / BYTES_PER_KB, sums=(volume_kb,))
    yield Column("Mean", "KB/s", lambda topic: topic.statistics.kb_per_s, sums=(total.kb_per_s,))
    yield Column("Mean", "kbit/s", lambda topic: topic.statistics.kbit_per_s, sums=(total.kbit_per_s,))
    if _has_declared(bag):
        all_declared = all(topic.statistics.declared for topic in bag.topics)
        yield Column("Sizes", "", _sizes, is_text=True, sums=(DECLARED if all_declared else "mixed",))


def _damage(bag: BagSummary) -> tuple[str, ...]:
    if bag.readable_share == 1:
        return ()
    unknown = "; how much is missing is not known" if bag.readable_share is None else ""
    return (f"damaged: {readable_until(bag.readable_share, bag.span.end_ns)}{unknown}",)


def _own_topics(bag: BagSummary) -> tuple[str, ...]:
    if not bag.own_topics:
        return ()
    listed = ", ".join(
        f"{topic.name} ({counted(topic.statistics.messages, 'message')})" for topic in bag.own_topics
    )
    return (f"beside them, in no sum, what SmartTestudo said of itself: {listed}",)


def _message_kb(topic: BagTopic) -> float | None:
    statistics = topic.statistics
    return statistics.size_bytes / statistics.messages / BYTES_PER_KB if statistics.messages else None


def _has_declared(bag: BagSummary) -> bool:
    return any(topic.statistics.declared for topic in bag.topics)


def _sizes(topic: BagTopic) -> str:
    return DECLARED if topic.statistics.declared else "recorded"


def _notes(bag: BagSummary) -> tuple[str, ...]:
    return (DECLARED_NOTE,) if _has_declared(bag) else ()
