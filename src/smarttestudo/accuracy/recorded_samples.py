# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The numbers in the messages of a recording."""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

from smarttestudo.accuracy.samples import Field, TopicSamples
from smarttestudo.bags.definitions import RosbagDecoder
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.profile import LevelUnit
from smarttestudo.domain.recording import TWO_TYPES, Channel, RecordingReader
from smarttestudo.domain.units import FIRST_STAMP_NS, LAST_STAMP_NS, counted
from smarttestudo.pacing.cdr import STREAM_TYPES, StreamReader

_MESSAGES_PER_REPORT = 4096


@dataclass(frozen=True, slots=True, kw_only=True)
class TopicReading:
    """How a topic is read: ``choose_fields`` gets its type and first message; ``None`` decodes nothing.

    Neither are messages of ``undecoded_types`` decoded for it. The messages are kept for pictures of
    ``properties``.
    """

    choose_fields: Callable[[str, object], Sequence[Field]] | None = None
    undecoded_types: frozenset[str] = frozenset()
    properties: tuple[str, ...] = ()
    level_unit: LevelUnit | None = None


def joined(*plans: Mapping[str, TopicReading]) -> dict[str, TopicReading]:
    """One way to read each topic that serves all ``plans``; fields are those of the first that has some."""
    found: dict[str, TopicReading] = {}
    for topic, reading in itertools.chain.from_iterable(plan.items() for plan in plans):
        known = found.get(topic, reading)
        properties = tuple(dict.fromkeys((*known.properties, *reading.properties)))
        found[topic] = replace(known if known.choose_fields else reading, properties=properties)
    return found


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordedSamples:
    """The samples of each topic that was to be read, by name; ``notices`` say what was left out.

    ``after_end`` counts messages that came after the time that was asked for, by topic.
    """

    topics: Mapping[str, TopicSamples]
    after_end: Mapping[str, int] = field(default_factory=dict)
    notices: tuple[str, ...] = ()


class SampleTaker:
    """Takes the numbers of messages that are shown to it, of the topics in ``readings``.

    Of a topic with two types the first counts. Messages that do not lie between ``start_ns`` and ``end_ns``
    are left out, but a picture shows also what came before. ``declared_bytes`` are their sizes where a
    recording declares them.
    """

    def __init__(
        self,
        readings: Mapping[str, TopicReading],
        declared_bytes: Mapping[str, int],
        *,
        start_ns: int = FIRST_STAMP_NS,
        end_ns: int = LAST_STAMP_NS,
    ) -> None:
        self._readings = readings
        self._declared_bytes = declared_bytes
        self._start_ns = start_ns
        self._end_ns = end_ns
        self._decoder = RosbagDecoder()
        self._readers: dict[str, StreamReader] = {}
        self._undecided: dict[str, Callable[[str, object], Sequence[Field]]] = {}
        self._undefined: list[tuple[TopicSamples, str]] = []
        self._of_second_type: Counter[str] = Counter()
        self._looked_at: set[tuple[str, str | None]] = set()
        self.samples: dict[str, TopicSamples] = {}
        """The samples taken, by topic."""
        self.after_end: Counter[str] = Counter()
        """Messages that came after ``end_ns``, by topic."""

    def add(self, channel: Channel) -> None:
        """Expect messages of ``channel``."""
        topic = channel.topic
        reading = self._readings.get(topic)
        if reading is None or topic in self.samples:
            return
        is_standard, why = self._decoder.is_standard(channel), self._decoder.why_undecodable(channel)
        properties = reading.properties if why is None else ()
        samples = self.samples[topic] = TopicSamples(
            channel, properties, reading.level_unit, is_standard=is_standard
        )
        if channel.type_name in STREAM_TYPES and is_standard and why is None:
            self._readers[topic] = StreamReader(channel.type_name)
        if reading.choose_fields is not None and channel.type_name not in reading.undecoded_types:
            if why is None:
                self._undecided[topic] = reading.choose_fields
            else:
                self._undefined.append((samples, why))
        self._looked_at.add((topic, channel.definition))

    def write(self, channel: Channel, stamp_ns: int, payload: bytes) -> None:
        """Take a message as the writer of a replay."""
        self.on_message(channel, stamp_ns, payload)

    def on_message(self, channel: Channel, stamp_ns: int, payload: bytes) -> bool:
        """Take a message, if it is one of those wanted; whether it is."""
        topic = channel.topic
        samples, counts = self.samples.get(topic), stamp_ns >= self._start_ns
        if samples is None:
            return False
        if stamp_ns > self._end_ns:
            self.after_end[topic] += 1
            return False
        if samples.channel is not channel:
            if samples.channel.type_name != channel.type_name:
                self._of_second_type[topic] += counts
                return False
            self._look_again(channel)
        track = samples.track
        if not counts and not track.is_used:
            return False
        frames = self._readers[topic].streams(payload) if topic in self._readers else ()
        has_fields = topic in self._undecided or bool(samples.fields)
        message = self._decoded(channel, payload) if has_fields or track.needs_decoded else None
        if track.is_used:
            track.add(stamp_ns, payload, message, frames)
        if counts:
            samples.add(stamp_ns, self._declared_bytes.get(topic, len(payload)), frames)
            if has_fields:
                self._read(samples, message)
        return counts

    def _look_again(self, channel: Channel) -> None:
        """Take the fields, too, that another definition has than the first one of the topic."""
        topic, key = channel.topic, (channel.topic, channel.definition)
        if key not in self._looked_at:
            self._looked_at.add(key)
            choose = self._readings[topic].choose_fields
            is_read = topic in self._undecided or bool(self.samples[topic].fields)
            if is_read and choose is not None and self._decoder.why_undecodable(channel) is None:
                self._undecided[topic] = choose

    def _read(self, samples: TopicSamples, message: object | None) -> None:
        """Take the fields of the message that was added last; the first one says which there are."""
        if message is None:
            samples.undecodable += 1
            return
        topic = samples.channel.topic
        choose = self._undecided.pop(topic, None)
        if choose is not None:
            samples.look_at(choose(samples.channel.type_name, message), self._readings[topic].level_unit)
        samples.read(message)

    def _decoded(self, channel: Channel, payload: bytes) -> object | None:
        try:
            return self._decoder.decode(channel, payload)
        except RecordingError:
            return None

    def notices(self) -> Iterator[str]:
        """Notices of what was left out, a line each."""
        for samples, why in self._undefined:
            if not samples.stamps_ns:
                continue
            messages = counted(len(samples.stamps_ns), "message")
            yield f"{samples.channel.topic}: {messages} not decoded: {why}"
        for name, samples in self.samples.items():
            if samples.undecodable:
                verb = "was" if samples.undecodable == 1 else "were"
                messages = counted(samples.undecodable, "message")
                left_out = f"could not be decoded and {verb} left out{self._decoder.reason(name)}"
                yield f"{name}: {messages} {left_out}"
        for name, count in (+self._of_second_type).items():
            yield f"{name}: {TWO_TYPES}: {counted(count, 'message')}"


def read_samples(
    recording: RecordingReader,
    readings: Mapping[str, TopicReading],
    *,
    start_ns: int | None = None,
    end_ns: int | None = None,
    topics: Collection[str] | None = None,
    report: Callable[[float], None],
) -> RecordedSamples:
    """Read the messages of the topics in ``readings`` in one pass, of all time or of that of another run.

    With ``topics`` no others are read from the disk, whose damage is then not seen.
    """
    taker = SampleTaker(
        readings,
        recording.declared_bytes,
        start_ns=recording.start_ns if start_ns is None else start_ns,
        end_ns=recording.end_ns if end_ns is None else end_ns,
    )
    for channel in recording.channels:
        taker.add(channel)
    for number, message in enumerate(recording.messages(topics)):
        if number % _MESSAGES_PER_REPORT == 0 and recording.message_count:
            report(number / recording.message_count)
        taker.on_message(*message)
    notices = (*recording.notices(), *taker.notices())
    return RecordedSamples(topics=taker.samples, after_end=taker.after_end, notices=notices)


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
