# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Measuring a recording in one pass, without reading payloads where nothing in them is asked for."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from operator import attrgetter
from pathlib import Path

from smarttestudo.adapters.rosbag import RosbagDecoder, open_recording, qos_in_words
from smarttestudo.composition.robot_places import Places, places_in
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.intervals import Intervals
from smarttestudo.domain.recording import Channel, RecordedSize, RecordingReader
from smarttestudo.visualizer.bag_summary import BagSummary, BagTopic
from smarttestudo.visualizer.floor import PathPoint
from smarttestudo.visualizer.interval_histogram import IntervalHistogram
from smarttestudo.visualizer.statistics import RecordingSpan, topic_statistics
from smarttestudo.visualizer.trace import TraceAccumulator

_MESSAGES_PER_REPORT = 4096
_topic_of = attrgetter("topic")


@dataclass(frozen=True, slots=True, kw_only=True)
class TopicRun:
    """How one topic came over time."""

    trace: TraceAccumulator
    histogram: IntervalHistogram


@dataclass(frozen=True, slots=True, kw_only=True)
class MeasuredRun:
    """A recording's numbers, its topics over time by name, and the places of the robot, if known."""

    summary: BagSummary
    topics: Mapping[str, TopicRun]
    path: tuple[PathPoint, ...]


def measure_bag(path: Path, report: Callable[[float], None]) -> BagSummary:
    """The topics of the recording at ``path``, by name; ``report`` is told the share done now and then.

    Sizes are those that the recording declares, and where it does not, those of its messages.

    Raises:
        RecordingError: it cannot be read, or is empty.
    """
    with open_recording(path) as recording:
        counters = {channel.topic: _TopicCounter() for channel in recording.channels}
        _count(recording, recording.sizes(), counters, report)
        return _summary(path, recording, counters)


def measure_run(
    path: Path, report: Callable[[float], None], *, with_places: bool = True, by_transforms: bool = False
) -> MeasuredRun:
    """What ``measure_bag`` gives, and the course of it over time.

    ``with_places`` reads payloads to know where the robot was, ``by_transforms`` from its transforms even
    where it has odometry.

    Raises:
        RecordingError: it cannot be read, or is empty.
    """
    with open_recording(path) as recording:
        counters = {channel.topic: _RunCounter() for channel in recording.channels}
        places = _Followed(recording, by_transforms=by_transforms) if with_places else None
        _count(recording, places.sizes() if places else recording.sizes(), counters, report)
        return MeasuredRun(
            summary=_summary(path, recording, counters, places.notices() if places else ()),
            topics={
                topic: TopicRun(trace=one.trace, histogram=one.histogram) for topic, one in counters.items()
            },
            path=places.path if places else (),
        )


class _TopicCounter:
    __slots__ = ("intervals", "trace")

    def __init__(self) -> None:
        self.trace = TraceAccumulator()
        self.intervals = Intervals()

    def add(self, stamp_ns: int, size_bytes: int) -> None:
        self.trace.add(stamp_ns, size_bytes)
        self.intervals.record(stamp_ns)


class _RunCounter(_TopicCounter):
    __slots__ = ("histogram",)

    def __init__(self) -> None:
        super().__init__()
        self.histogram = IntervalHistogram()

    def add(self, stamp_ns: int, size_bytes: int) -> None:
        super().add(stamp_ns, size_bytes)
        self.histogram.record(stamp_ns)


class _Followed:
    """Follows the robot while its messages are counted; one that cannot be decoded costs a place."""

    def __init__(self, recording: RecordingReader, *, by_transforms: bool) -> None:
        self._recording = recording
        self._places: Places | None = places_in(
            recording.channels, RosbagDecoder(), recording.start_ns, by_transforms=by_transforms
        )
        self._undecodable = 0

    @property
    def path(self) -> tuple[PathPoint, ...]:
        """Where the robot was."""
        return tuple(self._places.path) if self._places else ()

    def sizes(self) -> Iterator[RecordedSize]:
        """As ``RecordingReader.sizes``."""
        if self._places is None:
            yield from self._recording.sizes()
            return
        for channel, stamp_ns, payload in self._recording.messages():
            try:
                self._places.take(channel, stamp_ns, payload)
            except RecordingError:
                self._undecodable += 1
            yield channel, stamp_ns, len(payload)

    def notices(self) -> tuple[str, ...]:
        """What could not be decoded."""
        count = self._undecodable
        return (f"{count:,} places of the robot could not be decoded",) if count else ()


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


def _summary(
    path: Path,
    recording: RecordingReader,
    counters: Mapping[str, _TopicCounter],
    more_notices: Sequence[str] = (),
) -> BagSummary:
    """The summary of a recording that was counted."""
    if not any(counter.trace.messages for counter in counters.values()):
        lost = "; ".join(recording.notices())
        raise RecordingError("the bag holds no message", place=str(path), remedy=lost or None)
    span = RecordingSpan(start_ns=recording.start_ns, end_ns=recording.end_ns)
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
        notices=(*recording.notices(), *more_notices),
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
    )
