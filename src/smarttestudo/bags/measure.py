# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Measuring a recording in one pass, without reading payloads where nothing in them is asked for."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain, groupby, islice
from operator import attrgetter
from pathlib import Path
from typing import TYPE_CHECKING

from smarttestudo.bags.bag_summary import BagSummary, BagTopic
from smarttestudo.bags.incident_record import incident_notices, record_beside
from smarttestudo.bags.message_types import MessageTypes
from smarttestudo.bags.qos import qos_in_words
from smarttestudo.bags.reader import open_recording
from smarttestudo.bags.statistics import (
    IntervalHistogram,
    LatencyAccumulator,
    RecordingSpan,
    TraceAccumulator,
    topic_statistics,
)
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.names import is_own_topic
from smarttestudo.domain.rate_meter import Intervals
from smarttestudo.domain.recording import Channel, RecordedSize, RecordingReader
from smarttestudo.pacing.cdr import STAMPED_BYTES, header_stamp_ns

if TYPE_CHECKING:
    from smarttestudo.bags.robot_path import PathPoint, PathReader
    from smarttestudo.domain.incident import IncidentRecord


class TopicCounter:
    """Messages, bytes and intervals of a topic; memory does not grow with their number."""

    __slots__ = ("intervals", "latencies", "trace")

    def __init__(self, *, with_latency: bool = False) -> None:
        self.trace = TraceAccumulator()
        self.intervals = Intervals()
        self.latencies = LatencyAccumulator() if with_latency else None

    def add_all(self, stamps_ns: Sequence[int], sizes_bytes: Sequence[int]) -> None:
        """Count messages in time order."""
        self.trace.add_all(stamps_ns, sizes_bytes)
        self.intervals.record_all(stamps_ns)

    def add_stamp(self, stamp_ns: int, head: bytes) -> None:
        """Count the latency of a message that begins with ``head``, if its header was stamped."""
        sent_ns = header_stamp_ns(head)
        if self.latencies is not None:
            self.latencies.add(None if sent_ns is None else stamp_ns - sent_ns)

    def topic(self, channels: Sequence[Channel], span: RecordingSpan, *, is_declared: bool) -> BagTopic:
        """The topic of ``channels``, of which there are several if it has several types."""
        return BagTopic(
            name=channels[0].topic,
            type_name=" or ".join(dict.fromkeys(channel.type_name for channel in channels)),
            qos=qos_in_words(profile for channel in channels for profile in channel.qos),
            statistics=topic_statistics(self.trace, span, declared=is_declared),
            longest_gap_s=self.intervals.longest_s,
            jitter_s=self.intervals.jitter_s,
            latency=None if self.latencies is None else self.latencies.latency(),
        )


class RunCounter(TopicCounter):
    """Also how often which interval arrived."""

    __slots__ = ("histogram",)

    def __init__(self) -> None:
        super().__init__()
        self.histogram = IntervalHistogram()

    def add_all(self, stamps_ns: Sequence[int], sizes_bytes: Sequence[int]) -> None:
        """Count messages in time order."""
        super().add_all(stamps_ns, sizes_bytes)
        for stamp_ns in stamps_ns:
            self.histogram.record(stamp_ns)


_MESSAGES_PER_REPORT = 4096
_topic_of = attrgetter("topic")


@dataclass(frozen=True, slots=True, kw_only=True)
class MeasuredRun:
    """A recording's numbers and channels, its topics over time by name, and the robot's places, if known."""

    summary: BagSummary
    channels: tuple[Channel, ...]
    topics: Mapping[str, RunCounter]
    path: tuple[PathPoint, ...]


def measure_bag(path: Path, report: Callable[[float], None], *, with_latency: bool = False) -> BagSummary:
    """The topics of the recording at ``path``, by name; ``report`` gets the share done now and then.

    Sizes are those that the recording declares, and where it does not, those of its messages. Latency needs
    the beginning of each payload.

    Raises:
        RecordingError: it cannot be read.
    """
    with open_recording(path) as recording:
        types = MessageTypes()
        counters = {channel.topic: TopicCounter(with_latency=with_latency) for channel in recording.channels}
        sizes = _sizes_noting_latency(recording, types, counters) if with_latency else recording.sizes()
        _count(recording, sizes, counters, report)
        notices = chain(types.notices(recording.channels), _clock_notices(counters))
        return _summary(path, recording, counters, notices)


def measure_run(
    path: Path, report: Callable[[float], None], *, with_places: bool = True, by_transforms: bool = False
) -> MeasuredRun:
    """Measure a recording as ``measure_bag`` does, and its course over time.

    ``with_places`` reads payloads to know where the robot was, ``by_transforms`` from its transforms even
    where it has odometry.

    Raises:
        RecordingError: it cannot be read.
    """
    with open_recording(path) as recording:
        counters = {channel.topic: RunCounter() for channel in recording.channels}
        robot = _Robot(recording, by_transforms=by_transforms) if with_places else None
        _count(recording, robot.sizes() if robot else recording.sizes(), counters, report)
        return MeasuredRun(
            summary=_summary(
                path,
                recording,
                counters,
                (*MessageTypes().notices(recording.channels), *(robot.notices() if robot else ())),
            ),
            channels=tuple(recording.channels),
            topics=counters,
            path=robot.path if robot else (),
        )


class _Robot:
    """Is followed while its messages are counted; one that does not say where it is costs a place."""

    def __init__(self, recording: RecordingReader, *, by_transforms: bool) -> None:
        # They need the language and rosbags, which take longer to import than many a recording to count.
        from smarttestudo.bags.definitions import RosbagDecoder  # noqa: PLC0415
        from smarttestudo.bags.robot_path import places_in  # noqa: PLC0415

        self._recording = recording
        self._places: PathReader | None = places_in(
            recording.channels, RosbagDecoder(), recording.start_ns, by_transforms=by_transforms
        )
        self._unknown: Counter[str] = Counter()

    @property
    def path(self) -> tuple[PathPoint, ...]:
        """The places where the robot was."""
        return tuple(self._places.path) if self._places else ()

    def sizes(self) -> Iterator[RecordedSize]:
        if self._places is None:
            yield from self._recording.sizes()
            return
        for channel, stamp_ns, payload in self._recording.messages():
            try:
                self._places.on_message(channel, stamp_ns, payload)
            except RecordingError as error:
                self._unknown[error.cause] += 1
            yield channel, stamp_ns, len(payload)

    def notices(self) -> Iterator[str]:
        """Places of the robot that are not known."""
        from smarttestudo.bags.robot_path import notice_of_unknown  # noqa: PLC0415

        return notice_of_unknown(self._unknown)


def _sizes_noting_latency(
    recording: RecordingReader, types: MessageTypes, counters: Mapping[str, TopicCounter]
) -> Iterator[RecordedSize]:
    # What is latched is kept for those who come later, however long.
    stamped = {
        id(channel)
        for channel in recording.channels
        if not channel.transient_local and types.has_header(channel)
    }
    for channel, stamp_ns, (size_bytes, head) in recording.heads(STAMPED_BYTES):
        if id(channel) in stamped:
            counters[channel.topic].add_stamp(stamp_ns, head)
        yield channel, stamp_ns, size_bytes


def _count(
    recording: RecordingReader,
    sizes: Iterable[RecordedSize],
    counters: Mapping[str, TopicCounter],
    report: Callable[[float], None],
) -> None:
    declared_bytes, messages = recording.declared_bytes, recording.message_count
    done, rest = 0, iter(sizes)
    while batch := [*islice(rest, _MESSAGES_PER_REPORT)]:
        report(done / (messages or len(batch)))
        done += len(batch)
        by_topic: dict[str, tuple[list[int], list[int]]] = defaultdict(lambda: ([], []))
        for channel, stamp_ns, size_bytes in batch:
            stamps_ns, sizes_bytes = by_topic[channel.topic]
            stamps_ns.append(stamp_ns)
            sizes_bytes.append(size_bytes)
        for topic, (stamps_ns, sizes_bytes) in by_topic.items():
            declared = declared_bytes.get(topic)
            counted_bytes = sizes_bytes if declared is None else [declared] * len(stamps_ns)
            counters[topic].add_all(stamps_ns, counted_bytes)


def _summary(
    path: Path, recording: RecordingReader, counters: Mapping[str, TopicCounter], more_notices: Iterable[str]
) -> BagSummary:
    """The summary of a recording that was counted."""
    span = RecordingSpan(
        start_ns=recording.start_ns, end_ns=recording.end_ns, is_empty=not recording.message_count
    )
    incident, incident_lacks = _incident(path, span)
    by_topic = groupby(sorted(recording.channels, key=_topic_of), key=_topic_of)
    measured = [
        counters[topic].topic(tuple(channels), span, is_declared=topic in recording.declared_bytes)
        for topic, channels in by_topic
    ]
    own = tuple(topic for topic in measured if is_own_topic(topic.name, topic.type_name))
    return BagSummary(
        name=str(path),
        storage=recording.storage,
        span=span,
        topics=tuple(topic for topic in measured if topic not in own),
        own_topics=own,
        readable_share=recording.readable_share,
        notices=(
            *recording.notices(),
            *_notices_of_types(recording.channels),
            *more_notices,
            *incident_lacks,
        ),
        incident=incident,
    )


def _notices_of_types(channels: Iterable[Channel]) -> Iterator[str]:
    """Topics that were recorded with several types."""
    types: dict[str, dict[str, None]] = defaultdict(dict)
    for channel in channels:
        types[channel.topic][channel.type_name] = None
    for topic, names in sorted(types.items()):
        if len(names) > 1:
            yield f"{topic}: recorded with several types, {', '.join(names)}; its numbers are of all of them"


def _incident(path: Path, span: RecordingSpan) -> tuple[IncidentRecord | None, tuple[str, ...]]:
    """Record of the incident that the recording is, if it is one, and what is odd about it."""
    try:
        record = record_beside(path)
    except RecordingError as error:
        return None, (f"what happened is not known: {error}",)
    return record, () if record is None else tuple(incident_notices(record, span))


def _clock_notices(counters: Mapping[str, TopicCounter]) -> Iterator[str]:
    """Topics of which not all headers are stamped by the clock of their reception, those alike together."""
    alike: dict[str, list[str]] = defaultdict(list)
    for topic, counter in sorted(counters.items()):
        notice = counter.latencies.notice() if counter.latencies else None
        if notice is not None:
            alike[notice].append(topic)
    for notice, topics in alike.items():
        yield f"{', '.join(topics)}: {notice}"
