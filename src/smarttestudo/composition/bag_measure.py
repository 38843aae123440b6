# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Measuring a recording without reading its payloads."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import groupby
from operator import attrgetter
from pathlib import Path

from smarttestudo.adapters.rosbag import open_recording, qos_in_words
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.intervals import Intervals
from smarttestudo.domain.recording import Channel, RecordingReader
from smarttestudo.visualizer.bag_summary import BagSummary, BagTopic
from smarttestudo.visualizer.statistics import RecordingSpan, topic_statistics
from smarttestudo.visualizer.trace import TraceAccumulator

_MESSAGES_PER_REPORT = 4096
_topic_of = attrgetter("topic")


def measure_bag(path: Path, report: Callable[[float], None]) -> BagSummary:
    """The topics of the recording at ``path``, by name; ``report`` is told the share done now and then.

    Sizes are those that the recording declares, and where it does not, those of its messages.

    Raises:
        RecordingError: it cannot be read, or is empty.
    """
    with open_recording(path) as recording:
        if not recording.message_count:
            lost = "; ".join(recording.notices())
            raise RecordingError("the bag holds no message", place=str(path), remedy=lost or None)
        span = RecordingSpan(start_ns=recording.start_ns, end_ns=recording.end_ns)
        counters = {channel.topic: _TopicCounter() for channel in recording.channels}
        _count(recording, counters, report)
        by_topic = groupby(sorted(recording.channels, key=_topic_of), key=_topic_of)
        topics = tuple(
            _topic(tuple(channels), counters[topic], span, is_declared=topic in recording.declared_bytes)
            for topic, channels in by_topic
        )
        return BagSummary(
            name=str(path),
            storage=recording.storage,
            span=span,
            topics=topics,
            readable_share=recording.readable_share,
            notices=tuple(recording.notices()),
        )


class _TopicCounter:
    __slots__ = ("intervals", "trace")

    def __init__(self) -> None:
        self.trace = TraceAccumulator()
        self.intervals = Intervals()

    def add(self, stamp_ns: int, size_bytes: int) -> None:
        self.trace.add(stamp_ns, size_bytes)
        self.intervals.record(stamp_ns)


def _count(
    recording: RecordingReader, counters: dict[str, _TopicCounter], report: Callable[[float], None]
) -> None:
    declared_bytes = recording.declared_bytes
    for number, (channel, stamp_ns, size_bytes) in enumerate(recording.sizes()):
        counters[channel.topic].add(stamp_ns, declared_bytes.get(channel.topic, size_bytes))
        if number % _MESSAGES_PER_REPORT == 0 and recording.message_count:
            report(number / recording.message_count)


def _topic(
    channels: Sequence[Channel], counter: _TopicCounter, span: RecordingSpan, *, is_declared: bool
) -> BagTopic:
    """The topic of ``channels``, of which there are several if it has several types."""
    return BagTopic(
        name=channels[0].topic,
        type_name=" or ".join(channel.type_name for channel in channels),
        qos=qos_in_words(profile for channel in channels for profile in channel.qos),
        statistics=topic_statistics(counter.trace, span, declared=is_declared),
        longest_gap_s=counter.intervals.longest_s,
        jitter_s=counter.intervals.jitter_s,
    )
