# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The numbers in the messages of a recording."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from smarttestudo.accuracy.samples import Field, TopicSamples
from smarttestudo.bags.definitions import RosbagDecoder
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.profile import LevelUnit
from smarttestudo.domain.recording import Channel, MessageDecoder, RecordingReader
from smarttestudo.domain.units import counted
from smarttestudo.pacing.cdr import FrameReader
from smarttestudo.pacing.sample import StreamKind

_MESSAGES_PER_REPORT = 4096


@dataclass(frozen=True, slots=True, kw_only=True)
class TopicReading:
    """How a topic is read: ``choose_fields`` gets its type and first message; ``None`` decodes nothing.

    Neither are messages of ``undecoded_types`` decoded.
    """

    choose_fields: Callable[[str, object], Sequence[Field]] | None = None
    undecoded_types: frozenset[str] = frozenset()
    level_unit: LevelUnit | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordedSamples:
    """The samples of each topic that was to be read, by name; ``notices`` say what was left out."""

    topics: Mapping[str, TopicSamples]
    notices: tuple[str, ...] = ()


@dataclass(slots=True)
class _Topic:
    samples: TopicSamples
    reading: TopicReading
    frames: FrameReader | None
    decodes: bool
    has_fields: bool = False


@dataclass(slots=True)
class _Left:
    second_types: Counter[str] = field(default_factory=Counter)
    undefined: dict[str, Channel] = field(default_factory=dict)


class SampleTaker:
    """Takes the numbers of messages that are shown to it, of the topics in ``readings``.

    Of a topic with two types the first counts. Messages that do not lie between ``start_ns`` and ``end_ns``
    are left out; ``declared_bytes`` are their sizes where a recording declares them.
    """

    def __init__(
        self,
        readings: Mapping[str, TopicReading],
        declared_bytes: Mapping[str, int],
        *,
        start_ns: int,
        end_ns: int,
    ) -> None:
        self._readings = readings
        self._declared_bytes = declared_bytes
        self._start_ns = start_ns
        self._end_ns = end_ns
        self._decoder = RosbagDecoder()
        self._left = _Left()
        self._topics: dict[str, _Topic] = {}

    @property
    def samples(self) -> dict[str, TopicSamples]:
        """What was taken, by topic."""
        return {name: topic.samples for name, topic in self._topics.items()}

    def add(self, channel: Channel) -> None:
        """Expect messages of ``channel``."""
        topic = channel.topic
        if topic in self._readings and topic not in self._topics:
            self._topics[topic] = _topic(channel, self._readings[topic], self._decoder, self._left)

    def take(self, channel: Channel, stamp_ns: int, payload: bytes) -> bool:
        """Take a message, if it is one of those wanted; whether it is."""
        topic = self._topics.get(channel.topic)
        if topic is None or not self._start_ns <= stamp_ns <= self._end_ns:
            return False
        if topic.samples.channel is not channel:
            self._left.second_types[channel.topic] += 1
            return False
        frames = topic.frames.child_frames(payload) if topic.frames else ()
        size_bytes = self._declared_bytes.get(channel.topic, len(payload))
        topic.samples.add(stamp_ns, size_bytes, frames)
        if topic.decodes:
            _read(topic, payload, self._decoder)
        return True

    def notices(self) -> Iterator[str]:
        """What was left out, a line each."""
        return _notices(self.samples, self._left)


def read_samples(
    recording: RecordingReader,
    readings: Mapping[str, TopicReading],
    *,
    start_ns: int,
    end_ns: int,
    report: Callable[[float], None],
) -> RecordedSamples:
    """The messages from ``start_ns`` to ``end_ns`` of the topics in ``readings``, in one pass."""
    taker = SampleTaker(readings, recording.declared_bytes, start_ns=start_ns, end_ns=end_ns)
    for channel in recording.channels:
        taker.add(channel)
    for number, message in enumerate(recording.messages()):
        if number % _MESSAGES_PER_REPORT == 0 and recording.message_count:
            report(number / recording.message_count)
        taker.take(*message)
    return RecordedSamples(topics=taker.samples, notices=(*recording.notices(), *taker.notices()))


def require_numbers(topics: Mapping[str, TopicSamples], asked: Mapping[str, Sequence[str]]) -> None:
    """Raise ``RecordingError`` for a field that was asked for and that no message has."""
    for topic, names in asked.items():
        samples = topics[topic]
        for name in names:
            if samples.series(Field(name=name)).unknown == len(samples.stamps_ns):
                known = ", ".join(field.name for field in samples.fields if field.name not in names)
                raise RecordingError(
                    f"no message has a number at {name}",
                    place=topic,
                    remedy=f"it has {known}" if known else "name a numeric field by its path",
                )


def _topic(channel: Channel, reading: TopicReading, decoder: MessageDecoder, left: _Left) -> _Topic:
    samples = TopicSamples(channel)
    is_wanted = reading.choose_fields is not None and channel.type_name not in reading.undecoded_types
    decodes = is_wanted and decoder.can_decode(channel)
    if is_wanted and not decodes:
        left.undefined[channel.topic] = channel
    frames = FrameReader() if samples.kind is StreamKind.TRANSFORMS else None
    return _Topic(samples=samples, reading=reading, frames=frames, decodes=decodes)


def _read(topic: _Topic, payload: bytes, decoder: MessageDecoder) -> None:
    """Take the fields of the message that was added last; its first one says which there are."""
    samples, reading = topic.samples, topic.reading
    try:
        message = decoder.decode(samples.channel, payload)
    except RecordingError:
        samples.undecodable += 1
        return
    if not topic.has_fields and reading.choose_fields is not None:
        topic.has_fields = True
        samples.look_at(reading.choose_fields(samples.channel.type_name, message), reading.level_unit)
        topic.decodes = bool(samples.fields)
    samples.read(message)


def _notices(topics: Mapping[str, TopicSamples], left: _Left) -> Iterator[str]:
    for name, channel in left.undefined.items():
        messages = counted(len(topics[name].stamps_ns), "message")
        yield f"{name}: {messages} not decoded: nobody defines the type {channel.type_name}"
    for name, samples in topics.items():
        if samples.undecodable:
            verb = "was" if samples.undecodable == 1 else "were"
            messages = counted(samples.undecodable, "message")
            yield f"{name}: {messages} could not be decoded and {verb} left out"
    for name, count in left.second_types.items():
        yield f"{name}: recorded with two types; left out of the second: {counted(count, 'message')}"
