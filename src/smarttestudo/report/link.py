# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A robot's link over time, from the statuses of a recording, and its section."""

from __future__ import annotations

from array import array
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import Any

from smarttestudo.bags.definitions import RosbagDecoder
from smarttestudo.bags.reader import open_recording
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.link import StreamCounts, TopicOnLink
from smarttestudo.domain.names import STATUS_TOPIC, TEXT_TYPE
from smarttestudo.domain.recording import Channel
from smarttestudo.domain.status import RuntimeStatus, status_from_text
from smarttestudo.domain.units import BYTES_PER_MB, NS_PER_S, counted, grouped
from smarttestudo.report.axes import legend, line_entry
from smarttestudo.report.markup import Markup, tag
from smarttestudo.report.page import figure, folded_tables, section, topic_name
from smarttestudo.report.rule_timeline import RuleStyle, StyleSpan, bounded
from smarttestudo.report.run_report import (
    MAX_CHARTS,
    LinkHistory,
    Series,
    SeriesPoint,
    TopicOverLink,
    coarser,
)
from smarttestudo.report.table import WHOLE, Column, Table, decimals, format_number
from smarttestudo.report.time_chart import BANDWIDTH, ChartLine, Run, TimeChart, value_heights
from smarttestudo.report.time_drawing import STRIP, WIDE, draw_chart

MAX_TOPICS = 100
_MAX_VALUES = 20_000
_MAX_POINTS = 2000
_MAX_SILENCES = 1000
_MOST_VALUE = 1e12
_MOST_COUNT = 10**15
_LATE_PERIODS = 3.5
_LEAST_STATUS_HZ = 0.01
_MESSAGES_PER_REPORT = 4096


@dataclass(slots=True)
class _Values:
    """Values with their times; of a long recording one in two, four or eight."""

    times_s: array[float] = field(default_factory=lambda: array("d"))
    values: array[float] = field(default_factory=lambda: array("d"))
    every: int = 1
    seen: int = 0

    def add(self, t_s: float, value: float | None) -> None:
        # It comes from a stranger; a chart with an infinite value shows nothing.
        if value is None or not 0 <= value <= _MOST_VALUE:
            return
        if self.seen % self.every == 0:
            self.times_s.append(t_s)
            self.values.append(value)
        self.seen += 1
        if len(self.values) > _MAX_VALUES:
            self.times_s, self.values = self.times_s[::2], self.values[::2]
            self.every *= 2

    def series(self) -> Series:
        pairs = zip(self.times_s, self.values, strict=True)
        points = [SeriesPoint(t_s=t_s, lowest=value, mean=value, highest=value) for t_s, value in pairs]
        return coarser(points, _MAX_POINTS)


@dataclass(slots=True)
class _Topic:
    ages_ms: _Values = field(default_factory=_Values)
    counts: StreamCounts = field(default_factory=StreamCounts)
    before: StreamCounts = field(default_factory=StreamCounts)
    """What earlier runs of the robot counted, less what was there at the first status."""

    def count(self, counts: StreamCounts) -> None:
        if counts.sent < self.counts.sent:
            # The runtime was started again, and counts from 0.
            self.before = self.total()
        self.counts = counts

    def total(self) -> StreamCounts:
        total = self.before + self.counts
        bounded_counts: dict[str, Any] = {
            one.name: _bounded(getattr(total, one.name)) for one in fields(total)
        }
        return replace(StreamCounts(**bounded_counts), queued_bytes=0, is_losing=False)


class LinkHistoryBuilder:
    """Takes statuses in order of time; memory does not grow with their number."""

    def __init__(self, start_ns: int) -> None:
        self.left_out = 0
        """Topics beyond ``MAX_TOPICS``, counted each time that a status named one."""
        self._start_ns = start_ns
        self._capacity, self._budget = _Values(), _Values()
        self._silences: list[tuple[float, float]] = []
        self._silent_since_s: float | None = None
        self._outages, self._outages_before = 0, 0
        self._topics: dict[str, _Topic] = {}
        self._end_s: float | None = None

    def on_status(self, stamp_ns: int, status: RuntimeStatus) -> None:
        """Add the status of ``stamp_ns``."""
        link = status.link
        if link is None:
            return
        t_s = (stamp_ns - self._start_ns) / NS_PER_S
        late_s = _LATE_PERIODS / max(status.status_hz, _LEAST_STATUS_HZ)
        if self._end_s is None:
            self._begin(link.outages, status)
        elif t_s - self._end_s > late_s and self._silent_since_s is None:
            # In an outage no status arrives.
            self._silent_since_s = self._end_s
        self._end_s = t_s
        self._capacity.add(t_s, link.capacity_kb_per_s)
        self._budget.add(t_s, status.budget_kb_per_s)
        if link.outages < self._outages:
            self._outages_before += self._outages
        self._outages = link.outages
        if not link.is_connected and self._silent_since_s is None:
            self._silent_since_s = t_s
        elif link.is_connected:
            self._end_silence(t_s)
        for name, topic in _on_link(status):
            if (known := self._topic(name)) is None:
                self.left_out += 1
                continue
            known.count(topic.counts)
            known.ages_ms.add(t_s, topic.age_ms)

    def _begin(self, outages: int, status: RuntimeStatus) -> None:
        """Count from here on: what was before is in no recording of this time."""
        self._outages_before = -outages
        for name, topic in _on_link(status):
            if (known := self._topic(name)) is not None:
                known.before = StreamCounts() - topic.counts

    def _topic(self, name: str) -> _Topic | None:
        if name not in self._topics and len(self._topics) >= MAX_TOPICS:
            return None
        return self._topics.setdefault(name, _Topic())

    def history(self) -> LinkHistory | None:
        """All of it, or ``None`` where no status has a link."""
        if self._end_s is None:
            return None
        self._end_silence(self._end_s)
        return LinkHistory(
            capacity=self._capacity.series(),
            budget=self._budget.series(),
            silences=tuple(self._silences),
            outages=_bounded(self._outages_before + self._outages),
            topics=tuple(
                TopicOverLink(
                    topic=name,
                    ages=topic.ages_ms.series(),
                    sorted_ages_ms=tuple(sorted(topic.ages_ms.values)),
                    counts=topic.total(),
                )
                for name, topic in sorted(self._topics.items())
            ),
        )

    def _end_silence(self, end_s: float) -> None:
        if self._silent_since_s is not None and len(self._silences) < _MAX_SILENCES:
            self._silences.append((self._silent_since_s, end_s))
        self._silent_since_s = None


def _on_link(status: RuntimeStatus) -> Iterator[tuple[str, TopicOnLink]]:
    return ((name, topic.on_link) for name, topic in status.topics.items() if topic.on_link is not None)


def _bounded(count: int) -> int:
    # It comes from a stranger, too.
    return max(0, min(count, _MOST_COUNT))


def link_table(history: LinkHistory) -> Table[TopicOverLink]:
    """The ages of each topic in the statuses, and what became of its messages at the robot's end."""
    return Table(
        title="Topics over the link",
        columns=(
            Column("Topic", "", lambda topic: topic.topic, is_text=True),
            Column("Age p50", "ms", lambda topic: _quantile(topic.sorted_ages_ms, 0.5), WHOLE),
            Column("p95", "ms", lambda topic: _quantile(topic.sorted_ages_ms, 0.95), WHOLE),
            Column("Maximum", "ms", lambda topic: _quantile(topic.sorted_ages_ms, 1.0), WHOLE),
            Column("Sent", "", lambda topic: topic.counts.sent, WHOLE),
            Column("Replaced", "", lambda topic: topic.counts.replaced, WHOLE),
            Column("Overflowed", "", lambda topic: topic.counts.overflowed, WHOLE),
            Column("Repaired", "", lambda topic: topic.counts.repaired, WHOLE),
            Column("Lost", "", lambda topic: topic.counts.lost, WHOLE),
            Column("On the link", "MB", lambda topic: topic.counts.sent_bytes / BYTES_PER_MB, decimals(2)),
        ),
        rows=history.topics,
        footnotes=(
            "Age: of the last message before each status. Replaced: gave way to a newer message. "
            "Overflowed: dropped because the topic's queue was full. Repaired: arrived because lost parts "
            "were sent again. Lost: by the radio, and replaced or too late. Counts begin at the first "
            "status.",
        ),
    )


def _quantile(ordered: Sequence[float], share: float) -> float | None:
    """The value that ``share`` of the values do not exceed."""
    return ordered[min(len(ordered) - 1, int(len(ordered) * share))] if ordered else None


def has_statuses(channels: Iterable[Channel]) -> bool:
    """Whether a recording with these channels lists statuses of a runtime."""
    return any(map(_is_status, channels))


def link_history(
    path: Path, start_ns: int, report: Callable[[float], None]
) -> tuple[LinkHistory | None, tuple[str, ...]]:
    """The history of a link by a recording's statuses, timed from ``start_ns``, and what was not understood.

    Raises:
        RecordingError: it cannot be read.
    """
    builder, decoder, unread = LinkHistoryBuilder(start_ns), RosbagDecoder(), 0
    with open_recording(path) as recording:
        length_ns = max(recording.end_ns - recording.start_ns, 1)
        for number, (channel, stamp_ns, payload) in enumerate(recording.messages({STATUS_TOPIC})):
            if number % _MESSAGES_PER_REPORT == 0:
                report((stamp_ns - recording.start_ns) / length_ns)
            if not _is_status(channel):
                continue
            try:
                text = getattr(decoder.decode(channel, payload), "data", "")
                builder.on_status(stamp_ns, status_from_text(str(text)))
            except (RecordingError, ValueError):
                unread += 1
    notices = []
    if unread:
        notices.append(f"{counted(unread, 'message')} on {STATUS_TOPIC} could not be understood")
    if builder.left_out:
        notices.append(f"of the link, the first {MAX_TOPICS} topics are shown")
    return builder.history(), tuple(notices)


def _is_status(channel: Channel) -> bool:
    return channel.topic == STATUS_TOPIC and channel.type_name == TEXT_TYPE


_OUTAGE = RuleStyle(css_class="by-other", name="Nothing arrived")
_WIDE_POINTS = 400
_POINTS_OF_ALL_CHARTS = 2000
_MOST_SPANS = 120
_AGE = "ms"
_EXPLANATION = (
    "What the robot told each second: the link's capacity, and the budget that rates are planned within; and "
    "what the operator received, before compression. Below, how old messages were when they arrived."
)


def link_section(history: LinkHistory, received: Series, duration_s: float) -> Markup:
    """The link over time, its outages, and the ages of each topic."""
    silences = _silences(history, duration_s)
    link, ages = link_chart(history, received, duration_s), age_charts(history, duration_s)
    lines = [line_entry("before", "Capacity"), line_entry("after", "Received")]
    if history.budget:
        lines.append(line_entry("budget", "Budget"))
    if silences:
        lines.append(line_entry(f"strip {_OUTAGE.css_class}", _OUTAGE.name))
    points = max(_POINTS_OF_ALL_CHARTS // max(len(ages), 1), 40)
    left_out = sum(bool(topic.ages) for topic in history.topics) - len(ages)
    more = [tag("p", f"{grouped(left_out)} more topics are in the table.", class_="note")] if left_out else []
    readout = tag("span", class_="quiet readout")
    return section(
        "What the link did",
        legend(*lines),
        tag(
            "div",
            figure(draw_chart(link, WIDE, _WIDE_POINTS), tag("span", link.name, class_="name"), kind="rate"),
            *(
                figure(draw_chart(chart, STRIP, points), topic_name(chart.name), readout, kind="rate")
                for chart in ages
            ),
            class_="strips",
        ),
        tag("p", _outages(history), class_="note"),
        *more,
        *folded_tables([link_table(history)]),
        explanation=_EXPLANATION,
    )


def link_chart(history: LinkHistory, received: Series, duration_s: float) -> TimeChart:
    """Capacity, budget and what was received over time."""
    lines = ((Run.BEFORE, history.capacity), (Run.AFTER, received), (Run.BUDGET, history.budget))
    highest = max((point.highest for _, points in lines for point in points), default=1.0)
    return TimeChart(
        name="Capacity and what was received",
        meaning="What the link carries, the budget and what was received over time, in KB/s",
        unit=BANDWIDTH,
        duration_s=duration_s,
        heights=value_heights(highest, None),
        lines=tuple(ChartLine(run=run, points=points) for run, points in lines if points),
        tints=_silences(history, duration_s),
    )


def age_charts(history: LinkHistory, duration_s: float) -> list[TimeChart]:
    """For each topic whose ages are known, those, the oldest topics first; at most ``MAX_CHARTS``."""
    known = sorted((topic for topic in history.topics if topic.ages), key=_oldest, reverse=True)
    return [
        TimeChart(
            name=topic.topic,
            meaning=f"Age of the messages of {topic.topic} at the operator over time, in ms",
            unit=_AGE,
            duration_s=duration_s,
            heights=value_heights(_highest(topic.ages), None),
            lines=(ChartLine(run=Run.AFTER, points=topic.ages),),
            tints=_silences(history, duration_s),
        )
        for topic in known[:MAX_CHARTS]
    ]


def _oldest(topic: TopicOverLink) -> float:
    return topic.sorted_ages_ms[-1]


def _highest(points: Series) -> float:
    return max(point.highest for point in points)


def _silences(history: LinkHistory, duration_s: float) -> tuple[StyleSpan, ...]:
    spans: Sequence[StyleSpan] = [
        StyleSpan(start_s=start_s, end_s=min(end_s, duration_s), style=_OUTAGE)
        for start_s, end_s in history.silences
        if start_s < duration_s
    ]
    return tuple(bounded(spans, _MOST_SPANS))


def _outages(history: LinkHistory) -> str:
    silent_s = sum(end_s - start_s for start_s, end_s in history.silences)
    if not history.outages and not history.silences:
        return "No outage."
    return f"Outages: {grouped(history.outages)}; nothing arrived for {format_number(silent_s, 0)} s."
