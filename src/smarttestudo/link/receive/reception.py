# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Messages of robots, put where they are wanted, and how they arrived."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import NamedTuple

from smarttestudo.domain.errors import error_at, said
from smarttestudo.domain.link import ReceivedMessage, Sink, StreamInfo
from smarttestudo.domain.rate_meter import Flow, FlowMeter
from smarttestudo.domain.texts import SayOnce
from smarttestudo.domain.units import NS_PER_MS
from smarttestudo.link.receive.prediction import Predictor
from smarttestudo.link.zenoh.arrivals import LinkEvent, RobotPresence, StreamSaid


class StreamKey(NamedTuple):
    """A stream as a run of a robot's end numbers it."""

    boot: str
    number: int


class CountedStream(NamedTuple):
    """The stream that counts as that of a publisher."""

    key: StreamKey
    info: StreamInfo

    def is_of_another_kind(self, before: CountedStream) -> bool:
        """Whether it is of another run than the one ``before``, and not alike."""
        return self.key.boot != before.key.boot and _kind(self.info) != _kind(before.info)

    def said_by(self, robot: str, *, has_it: bool = True) -> StreamSaid:
        """The sentence that ``robot`` has it, or has it no more."""
        boot, number = self.key
        return StreamSaid(robot=robot, boot=boot, number=number, info=self.info if has_it else None)


class _Kind(NamedTuple):
    """Properties that streams of one topic must have in common."""

    type_name: str
    is_reliable: bool
    is_latched: bool
    definition: str


class TopicStreams:
    """The streams of one topic; ``owner`` is the run that the topic belongs to.

    Of the runs that have it, that is the one of the lowest of ``ranks``, which arrived first: a second robot
    of the name takes a topic from nobody, and the first one has it again after an outage. What others have of
    it counts where the owner has a stream of the same type, QoS and definition.
    """

    def __init__(self, ranks: Mapping[str, int]) -> None:
        self.owner: str | None = None
        self._ranks = ranks
        self._of_boots: dict[str, dict[int, StreamInfo]] = {}
        self._of_publishers: dict[int, dict[StreamKey, StreamInfo]] = {}
        self._kinds: Counter[_Kind] = Counter()

    def follow(self, key: StreamKey, info: StreamInfo | None) -> Iterable[int]:
        """A run has a stream, or has it no more; the publishers of which other streams may count now."""
        before = self._forget(key)
        if info is not None:
            self._of_boots.setdefault(key.boot, {})[key.number] = info
            self._of_publishers.setdefault(info.publisher, {})[key] = info
        touched = {known_info.publisher for known_info in (before, info) if known_info is not None}
        owner = min(self._of_boots, key=self._rank, default=None)
        if owner != self.owner:
            self.owner = owner
            self._kinds = Counter(map(_kind, self._of_boots.get(owner or "", {}).values()))
            return {*touched, *self._of_publishers}
        if key.boot != self.owner:
            return touched
        has_changed = self._count(before, -1) | self._count(info, 1)
        return {*touched, *self._of_publishers} if has_changed and len(self._of_boots) > 1 else touched

    def counted(self, publisher: int) -> CountedStream | None:
        """The stream that counts as that of a publisher: the owner's last one before all others."""
        known = self._of_publishers.get(publisher, {})
        counting = [CountedStream(key, info) for key, info in known.items() if self.counts(key.boot, info)]
        of_owner = [stream for stream in counting if stream.key.boot == self.owner]
        return of_owner[-1] if of_owner else next(iter(counting), None)

    def counts(self, boot: str, info: StreamInfo) -> bool:
        return self.owner is None or boot == self.owner or _kind(info) in self._kinds

    def refused(self) -> str | None:
        """Difference to the owner of the first stream that does not count, if there is one."""
        if len(self._of_boots) < 2:
            return None
        streams = ((boot, info) for boot, known in self._of_boots.items() for info in known.values())
        return next((self._difference(info) for boot, info in streams if not self.counts(boot, info)), None)

    def _difference(self, info: StreamInfo) -> str:
        of_owner = list(self._of_boots.get(self.owner or "", {}).values())
        alike = [one for one in of_owner if one.type_name == info.type_name]
        if not alike:
            return f"as {info.type_name}, not {' or '.join(sorted({one.type_name for one in of_owner}))}"
        has_qos = any(_kind(one)[1:3] == _kind(info)[1:3] for one in alike)
        return "with another definition" if has_qos else "with another QoS"

    def _rank(self, boot: str) -> int:
        return self._ranks.get(boot, 0)

    def _forget(self, key: StreamKey) -> StreamInfo | None:
        streams = self._of_boots.get(key.boot, {})
        info = streams.pop(key.number, None)
        if not streams:
            self._of_boots.pop(key.boot, None)
        if info is not None:
            known = self._of_publishers[info.publisher]
            del known[key]
            if not known:
                del self._of_publishers[info.publisher]
        return info

    def _count(self, info: StreamInfo | None, change: int) -> bool:
        """Count one of the owner's streams; whether there is a kind more, or one less."""
        if info is None:
            return False
        kind = _kind(info)
        had = kind in self._kinds
        self._kinds[kind] += change
        if self._kinds[kind] <= 0:
            del self._kinds[kind]
        return had is not (kind in self._kinds)


def _kind(info: StreamInfo) -> _Kind:
    return _Kind(info.type_name, info.qos.reliable, info.qos.transient_local, info.definition)


@dataclass(slots=True)
class ReceivedTopic:
    """How one topic of a robot arrives: ``age_ms`` is that of its last message, as far as it is known.

    ``predicted`` messages were made here; they count as nothing else. ``opened`` are the streams that count,
    by publisher. ``refused`` says what a second robot of the name has otherwise, ``failure`` why what arrives
    is not put where it is wanted.
    """

    type_name: str
    streams: TopicStreams
    flow: Flow
    meter: FlowMeter
    age_ms: float | None = None
    predicted: int = 0
    opened: dict[int, CountedStream] = field(default_factory=dict)
    refused: str | None = None
    failure: str | None = None

    @property
    def problem(self) -> str | None:
        """Why not all that arrives is put where it is wanted."""
        return self.failure or self.refused


@dataclass(slots=True)
class ReceivedRobot:
    """One robot; ``boots`` are the runs of its end that are connected now.

    ``streams`` are those that it has, by run and number; those of a run that left stay while there is no
    other, as it may come back. ``ranks`` tell which run arrived first.
    """

    boots: set[str] = field(default_factory=set)
    streams: dict[StreamKey, StreamInfo] = field(default_factory=dict)
    ranks: dict[str, int] = field(default_factory=dict)
    topics: dict[str, ReceivedTopic] = field(default_factory=dict)


_MOST_RANKS = 1_000
_MOST_SAID = 1_000
_MOST_HELD = 1_000
_MOST_HELD_BYTES = 16_000_000


class Reception:
    """Takes the events of the operator's end, in order, and gives what they bring to ``sinks``.

    Where there is a ``predictor``, so is what it makes of them. Whatever one of them fails of for a topic
    costs that topic there, which ``warn`` is told once, and is tried again. Of robots of one name the one
    that arrived first has a topic (``TopicStreams``); what another one latched meanwhile is given out once it
    has the topic. ``note`` is told of all that counts. Times are ns of a clock that never jumps.
    """

    def __init__(
        self,
        sinks: Sequence[Sink],
        predictor: Predictor | None = None,
        warn: Callable[[str], None] = lambda _: None,
        note: Callable[[LinkEvent], None] = lambda _: None,
    ) -> None:
        self.robots: dict[str, ReceivedRobot] = {}
        self._sinks = sinks
        self._predictor = predictor
        self._say = SayOnce(warn, most=_MOST_SAID)
        self._note = note
        self._held: dict[tuple[str, str, str, int], ReceivedMessage] = {}
        self._held_bytes = 0

    def handle(self, event: LinkEvent, now_ns: int) -> None:
        robot = event.robot
        known = self.robots.setdefault(robot, ReceivedRobot())
        match event:
            case RobotPresence(boot=boot, is_present=is_present):
                _rank(known, boot)
                (known.boots.add if is_present else known.boots.discard)(boot)
                self._tell(event, now_ns)
                self._forget_earlier(robot)
            case StreamSaid(boot=boot, number=number, info=info):
                _rank(known, boot)
                self._follow(robot, StreamKey(boot, number), info, now_ns)
            case ReceivedMessage(stream=stream, boot=boot):
                topic = _topic(known, stream)
                if topic.streams.counts(boot, stream):
                    self._receive(topic, event, now_ns)
                elif stream.qos.transient_local:
                    self._hold(event)

    def predict(self, now_ns: int) -> int | None:
        """Give ``sinks`` what is predicted and due; when there is more."""
        if self._predictor is None:
            return None
        try:
            for message in self._predictor.predicted(now_ns):
                topic = _topic(self.robots[message.robot], message.stream)
                topic.predicted += 1
                self._write(topic, message)
        except Exception as error:  # noqa: BLE001 - that topic waits for its next message
            self._say(said(error))
        return self._predictor.due_ns

    def measure(self, now_ns: int) -> None:
        """Measure the rates anew; to be called about once a second."""
        for robot in self.robots.values():
            for topic in robot.topics.values():
                topic.meter.measure(now_ns)

    def _receive(self, topic: ReceivedTopic, message: ReceivedMessage, now_ns: int) -> None:
        topic.age_ms = None if message.age_ns is None else message.age_ns / NS_PER_MS
        topic.flow.record(now_ns, len(message.payload))
        self._write(topic, message)
        self._tell(message, now_ns)

    def _write(self, topic: ReceivedTopic, message: ReceivedMessage) -> None:
        topic.failure = self._each(message.stream.topic, lambda sink: sink.write(message))

    def _each(self, topic: str, act: Callable[[Sink], str | None]) -> str | None:
        """Have each sink act; the first reason why one cannot."""
        problems = [self._attempt(topic, act, sink) for sink in self._sinks]
        return next(filter(None, problems), None)

    def _attempt(self, topic: str, act: Callable[[Sink], str | None], sink: Sink) -> str | None:
        try:
            return act(sink)
        except Exception as error:  # noqa: BLE001 - whatever it fails of costs this topic there
            problem = error_at(topic, error)
            self._say(str(problem))
            return problem.cause

    def _tell(self, event: LinkEvent, now_ns: int) -> None:
        """Tell of what counts."""
        self._note(event)
        try:
            if self._predictor is not None:
                self._predictor.handle(event, now_ns)
        except Exception as error:  # noqa: BLE001 - as a sink
            self._say(f"{event.robot}: {said(error)}")

    def _follow(self, robot: str, key: StreamKey, info: StreamInfo | None, now_ns: int) -> None:
        """A robot has a stream, or has it no more."""
        known = self.robots[robot]
        before = known.streams.pop(key, None)
        if info is not None:
            known.streams[key] = info
        if before is not None and before != info:
            self._drop_held(robot, key.boot, before)
        for stream in {
            known_info.topic: known_info for known_info in (before, info) if known_info is not None
        }.values():
            topic = _topic(known, stream)
            publishers = topic.streams.follow(key, info if stream is info else None)
            said_again = stream.publisher if stream is info else None
            self._settle(robot, topic, sorted(publishers), said_again, now_ns)
            topic.refused = self._refusal(robot, stream.topic, topic)

    def _settle(
        self, robot: str, topic: ReceivedTopic, publishers: Iterable[int], said_again: int | None, now_ns: int
    ) -> None:
        """Open the streams of ``publishers`` that count now, and forget those that count no more."""
        changes = [
            (publisher, topic.opened.pop(publisher, None), topic.streams.counted(publisher))
            for publisher in publishers
        ]
        # Another type can be opened only once all of the one before are gone.
        for _, before, now in changes:
            if before is not None and (now is None or now.is_of_another_kind(before)):
                self._each(before.info.topic, partial(_forget, robot, before.info))
                self._tell(before.said_by(robot, has_it=False), now_ns)
        for publisher, before, now in changes:
            if now is not None:
                topic.opened[publisher] = now
                if now != before or publisher == said_again:
                    self._open(robot, topic, now, now_ns)

    def _open(self, robot: str, topic: ReceivedTopic, stream: CountedStream, now_ns: int) -> None:
        info = stream.info
        topic.type_name = info.type_name
        topic.failure = self._each(info.topic, lambda sink: sink.open(robot, info))
        self._tell(stream.said_by(robot), now_ns)
        held = self._drop_held(robot, stream.key.boot, info)
        if held is not None:
            self._receive(topic, held, now_ns)

    def _hold(self, message: ReceivedMessage) -> None:
        """Keep the newest latched message of a stream that does not count yet."""
        stream = message.stream
        self._drop_held(message.robot, message.boot, stream)
        self._held[message.robot, message.boot, stream.topic, stream.publisher] = message
        self._held_bytes += len(message.payload)
        while len(self._held) > _MOST_HELD or self._held_bytes > _MOST_HELD_BYTES:
            oldest = next(iter(self._held.values()))
            self._drop_held(oldest.robot, oldest.boot, oldest.stream)

    def _drop_held(self, robot: str, boot: str, stream: StreamInfo) -> ReceivedMessage | None:
        held = self._held.pop((robot, boot, stream.topic, stream.publisher), None)
        if held is not None:
            self._held_bytes -= len(held.payload)
        return held

    def _refusal(self, robot: str, name: str, topic: ReceivedTopic) -> str | None:
        refused = topic.streams.refused()
        if refused is not None:
            self._say(
                f"{robot}: a second robot of this name sends {name} {refused}; that is refused while the "
                "first one is there: give each a name of its own with --robot"
            )
        return refused and f"another {robot} sends it {refused}"

    def _forget_earlier(self, robot: str) -> None:
        """Where a run of a robot's end is there, those that are gone have nothing until they are back."""
        known = self.robots[robot]
        if known.boots:
            for key in [key for key in known.streams if key.boot not in known.boots]:
                self._follow(robot, key, None, 0)


def _forget(robot: str, stream: StreamInfo, sink: Sink) -> None:
    sink.forget(robot, stream)


def _rank(robot: ReceivedRobot, boot: str) -> None:
    if boot not in robot.ranks:
        robot.ranks[boot] = max(robot.ranks.values(), default=0) + 1
        while len(robot.ranks) > _MOST_RANKS:
            del robot.ranks[next(rank for rank in robot.ranks if rank not in robot.boots and rank != boot)]


def _topic(robot: ReceivedRobot, stream: StreamInfo) -> ReceivedTopic:
    topic = robot.topics.get(stream.topic)
    if topic is None:
        flow = Flow()
        streams = TopicStreams(robot.ranks)
        topic = robot.topics[stream.topic] = ReceivedTopic(stream.type_name, streams, flow, FlowMeter(flow))
    return topic
