# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Measuring a recording without reading its payloads."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import groupby
from operator import attrgetter
from pathlib import Path

from smarttestudo.adapters.rosbag import MessageTypes, open_recording, qos_in_words
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.intervals import Intervals
from smarttestudo.domain.recording import Channel, RecordedSize, RecordingReader
from smarttestudo.pacing.cdr import HEADER_BYTES, STAMP_BYTES, header_stamp_ns
from smarttestudo.visualizer.bag_summary import BagSummary, BagTopic
from smarttestudo.visualizer.latency import LatencyAccumulator
from smarttestudo.visualizer.statistics import RecordingSpan, topic_statistics
from smarttestudo.visualizer.trace import TraceAccumulator

_MESSAGES_PER_REPORT = 4096
_topic_of = attrgetter("topic")


def measure_bag(path: Path, report: Callable[[float], None], *, with_latency: bool = False) -> BagSummary:
    """The topics of the recording at ``path``, by name; ``report`` is told the share done now and then.

    Sizes are those that the recording declares, and where it does not, those of its messages. Latency needs
    the beginning of each payload.

    Raises:
        RecordingError: it cannot be read, or is empty.
    """
    with open_recording(path) as recording:
        if not recording.message_count:
            lost = "; ".join(recording.notices())
            raise RecordingError("the bag holds no message", place=str(path), remedy=lost or None)
        span = RecordingSpan(start_ns=recording.start_ns, end_ns=recording.end_ns)
        counters = {channel.topic: _TopicCounter(with_latency=with_latency) for channel in recording.channels}
        types = MessageTypes()
        sizes = _sizes_noting_latency(recording, types, counters) if with_latency else recording.sizes()
        _count(recording, sizes, counters, report)
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
            notices=(*recording.notices(), *_undefined(recording.channels, types)),
        )


class _TopicCounter:
    __slots__ = ("intervals", "latencies", "trace")

    def __init__(self, *, with_latency: bool) -> None:
        self.trace = TraceAccumulator()
        self.intervals = Intervals()
        self.latencies = LatencyAccumulator() if with_latency else None

    def add(self, stamp_ns: int, size_bytes: int) -> None:
        self.trace.add(stamp_ns, size_bytes)
        self.intervals.record(stamp_ns)

    def add_stamp(self, stamp_ns: int, head: bytes) -> None:
        """Count the latency of a message that begins with ``head``, if its header was stamped."""
        sent_ns = header_stamp_ns(head)
        if sent_ns is not None and self.latencies is not None:
            self.latencies.add(stamp_ns - sent_ns)


def _sizes_noting_latency(
    recording: RecordingReader, types: MessageTypes, counters: Mapping[str, _TopicCounter]
) -> Iterator[RecordedSize]:
    stamped = {
        (channel.topic, channel.type_name) for channel in recording.channels if types.has_header(channel)
    }
    for channel, stamp_ns, (size_bytes, head) in recording.heads(HEADER_BYTES + STAMP_BYTES):
        if (channel.topic, channel.type_name) in stamped:
            counters[channel.topic].add_stamp(stamp_ns, head)
        yield channel, stamp_ns, size_bytes


def _count(
    recording: RecordingReader,
    sizes: Iterator[RecordedSize],
    counters: Mapping[str, _TopicCounter],
    report: Callable[[float], None],
) -> None:
    declared_bytes, messages = recording.declared_bytes, recording.message_count
    for number, (channel, stamp_ns, size_bytes) in enumerate(sizes):
        counters[channel.topic].add(stamp_ns, declared_bytes.get(channel.topic, size_bytes))
        if number % _MESSAGES_PER_REPORT == 0 and messages:
            report(number / messages)


def _undefined(channels: Sequence[Channel], types: MessageTypes) -> Iterator[str]:
    for channel in channels:
        if not types.is_defined(channel):
            yield (
                f"{channel.topic}: neither the recording nor ROS 2 defines {channel.type_name}; "
                "its messages are counted, but cannot be decoded"
            )


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
        latency=None if counter.latencies is None else counter.latencies.latency(),
    )
