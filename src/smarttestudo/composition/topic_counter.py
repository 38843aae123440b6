# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What is counted of one topic while a recording is read."""

from __future__ import annotations

from collections.abc import Sequence

from smarttestudo.adapters.rosbag import qos_in_words
from smarttestudo.domain.intervals import Intervals
from smarttestudo.domain.recording import Channel
from smarttestudo.pacing.cdr import header_stamp_ns
from smarttestudo.visualizer.bag_summary import BagTopic
from smarttestudo.visualizer.interval_histogram import IntervalHistogram
from smarttestudo.visualizer.latency import LatencyAccumulator
from smarttestudo.visualizer.statistics import RecordingSpan, topic_statistics
from smarttestudo.visualizer.trace import TraceAccumulator


class TopicCounter:
    """Messages, bytes and intervals of a topic; memory does not grow with their number."""

    __slots__ = ("intervals", "latencies", "trace")

    def __init__(self, *, with_latency: bool = False) -> None:
        self.trace = TraceAccumulator()
        self.intervals = Intervals()
        self.latencies = LatencyAccumulator() if with_latency else None

    def add(self, stamp_ns: int, size_bytes: int) -> None:
        """Count one message."""
        self.trace.add(stamp_ns, size_bytes)
        self.intervals.record(stamp_ns)

    def add_stamp(self, stamp_ns: int, head: bytes) -> None:
        """Count the latency of a message that begins with ``head``, if its header was stamped."""
        sent_ns = header_stamp_ns(head)
        if sent_ns is not None and self.latencies is not None:
            self.latencies.add(stamp_ns - sent_ns)

    def topic(self, channels: Sequence[Channel], span: RecordingSpan, *, is_declared: bool) -> BagTopic:
        """The topic of ``channels``, of which there are several if it has several types."""
        return BagTopic(
            name=channels[0].topic,
            type_name=" or ".join(channel.type_name for channel in channels),
            qos=qos_in_words(profile for channel in channels for profile in channel.qos),
            statistics=topic_statistics(self.trace, span, declared=is_declared),
            longest_gap_s=self.intervals.longest_s,
            jitter_s=self.intervals.jitter_s,
            latency=None if self.latencies is None else self.latencies.latency(),
        )


class RunCounter(TopicCounter):
    """Also how often which interval came."""

    __slots__ = ("histogram",)

    def __init__(self) -> None:
        super().__init__()
        self.histogram = IntervalHistogram()

    def add(self, stamp_ns: int, size_bytes: int) -> None:
        """Count one message."""
        super().add(stamp_ns, size_bytes)
        self.histogram.record(stamp_ns)
