# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Both ends of what operators send to a robot."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

from smarttestudo.domain.errors import LinkError
from smarttestudo.domain.link import MAX_AGE_NS, MAX_COMMAND_BYTES, CommandTopic, SentCounts
from smarttestudo.domain.units import NS_PER_MS, NS_PER_S
from smarttestudo.link.protocol.keys import Boot
from smarttestudo.link.protocol.messages import (
    COMMAND_REPORTS,
    COMMANDS,
    MAX_PROBLEM,
    MAX_SENDERS,
    AcceptedStream,
    CommandMessage,
    CommandReport,
    SentNames,
)
from smarttestudo.link.protocol.window import CLOCK_WINDOW_NS, LeastOfWindow

MAX_PUBLISHERS = 8
"""Publishers of a topic that are kept apart."""
LOST_AFTER_NS = 3 * NS_PER_S
"""A robot's end that said nothing for so long is no longer there; it says something once a second."""

_DRIFT = 1_000
"""Two clocks differ by at most one part in so many: each is slewed by half of that at most."""
_NAMES_PERIOD_NS = 5 * NS_PER_S
_TRIP_WINDOW_NS = 10 * NS_PER_S
_QUEUE_NS = 150 * NS_PER_MS
"""A round trip that is longer than the least by so much shows that messages wait on the link."""
_LOST_FLIGHT_NS = NS_PER_S
_FIRST_WINDOW, _MOST_WINDOW = 16, 32
_MOST_FLYING_BYTES = 8_000
_KEPT_FLIGHTS = 64


@dataclass(frozen=True, slots=True, kw_only=True)
class CommandedRobot:
    """A robot's end that accepts something, as it was heard last, and what was sent to it, by topic."""

    boot: Boot
    topics: Mapping[str, CommandTopic]
    counts: Mapping[str, SentCounts]
    round_trip_ms: float | None


class ClockBound:
    """The least that the robot's clock shows, from times of it that arrived here. No clock need be right.

    A time that arrives was true when it was sent, so the robot's clock is at least that far ahead of ours;
    from then on the two may drift apart.
    """

    def __init__(self) -> None:
        self._least = LeastOfWindow(CLOCK_WINDOW_NS)

    def add(self, robot_ns: int, now_ns: int) -> None:
        """The robot's clock was at ``robot_ns`` at ``now_ns`` or before."""
        self._least.add(now_ns - robot_ns - now_ns // _DRIFT, now_ns)

    def stamp_ns(self, then_ns: int, now_ns: int) -> int | None:
        """A time of the robot's clock not after ``then_ns``, which is at most ``now_ns``."""
        least = self._least.at(now_ns)
        if least is None:
            return None
        # Rounding down would be later by one.
        drift_ns = now_ns // _DRIFT + (now_ns - then_ns) // _DRIFT + 2
        return then_ns - (least + drift_ns)


@dataclass(slots=True, eq=False)
class _Waiting:
    """The newest message of a publisher."""

    payload: bytes
    offered_ns: int


@dataclass(frozen=True, slots=True)
class _Flight:
    """A message under way."""

    number: int
    size_bytes: int
    sent_ns: int


class CommandSender:
    """Messages for one robot, in the time that is passed in; the robot's own clock may be another.

    Give it reports (``handle_report``) and messages (``put``), and send what ``next_command`` gives while
    it gives something, ten times a second at least. ``names`` are the topics that are sent, ``new_sender``
    makes random numbers of 64 bits.
    """

    def __init__(self, names: Sequence[str], new_sender: Callable[[], int]) -> None:
        self.counts: dict[str, SentCounts] = {name: SentCounts() for name in names}
        self.malformed = 0
        """Reports that were not readable."""
        self._names = tuple(names)
        self._new_sender = new_sender
        self._sender = new_sender()
        self._streams: dict[str, tuple[int, AcceptedStream]] = {}
        self._clock = ClockBound()
        self._received_ns: int | None = None
        self._named_ns: int | None = None
        self._waiting: dict[tuple[str, Hashable], _Waiting] = {}
        self._number = 0
        self._sent: deque[_Flight] = deque(maxlen=_KEPT_FLIGHTS)
        self._acknowledged = self._given_up = 0
        self._trips = LeastOfWindow(_TRIP_WINDOW_NS)
        self._trip_ns: int | None = None
        self._window = _FIRST_WINDOW
        self._was_full = False

    @property
    def topics(self) -> dict[str, CommandTopic]:
        """The topics that the robot accepts, as it told."""
        return {name: stream.topic for name, (_, stream) in self._streams.items()}

    @property
    def round_trip_ms(self) -> float | None:
        """How long the last message and its acknowledgement took; ``None`` before the first."""
        return None if self._trip_ns is None else self._trip_ns / NS_PER_MS

    def is_present(self, now_ns: int) -> bool:
        """Whether the robot's end was heard lately."""
        return self._received_ns is not None and now_ns - self._received_ns <= LOST_AFTER_NS

    def handle_report(self, data: bytes, now_ns: int) -> None:
        """The robot's end says what it has."""
        try:
            report = COMMAND_REPORTS.from_bytes(data)
        except LinkError:
            self.malformed += 1
            return
        self._received_ns = now_ns
        self._clock.add(report.sent_ns, now_ns)
        if report.streams:
            self._streams = {
                topic_stream.topic.topic: (number, topic_stream)
                for number, topic_stream in enumerate(report.streams)
            }
        self._acknowledge(report.acknowledged.get(self._sender), now_ns)

    def put(self, topic: str, publisher: Hashable, payload: bytes, now_ns: int) -> bool:
        """Have a message sent instead of an earlier one of its publisher; whether it is small enough."""
        counts = self.counts[topic]
        if len(payload) > MAX_COMMAND_BYTES:
            counts.too_large += 1
            return False
        key = (topic, publisher)
        others = [waiting for waiting in self._waiting if waiting[0] == topic and waiting != key]
        if len(others) >= MAX_PUBLISHERS:
            del self._waiting[others[0]]
            counts.replaced += 1
        # In the place of the earlier one, so that each publisher has its turn.
        counts.replaced += key in self._waiting
        self._waiting[key] = _Waiting(payload, now_ns)
        return True

    def next_command(self, now_ns: int) -> bytes | None:
        if not self.is_present(now_ns):
            self._expire(now_ns)
            return None
        if self._named_ns is None or now_ns - self._named_ns >= _NAMES_PERIOD_NS:
            self._named_ns = now_ns
            return COMMANDS.to_bytes(SentNames(sender=self._sender, topics=self._names))
        self._expire(now_ns)
        self._give_up_flights(now_ns)
        for key, waiting in self._waiting.items():
            if not self._has_room(len(waiting.payload)):
                self._was_full = True
                return None
            stream = self._streams.get(key[0])
            stamp_ns = self._clock.stamp_ns(waiting.offered_ns, now_ns)
            if stream is not None and stream[1].topic.type_name is not None and stamp_ns is not None:
                del self._waiting[key]
                return self._command(key[0], stream, waiting.payload, stamp_ns, now_ns)
        return None

    def _command(
        self, topic: str, stream: tuple[int, AcceptedStream], payload: bytes, stamp_ns: int, now_ns: int
    ) -> bytes:
        self._number += 1
        self._sent.append(_Flight(self._number, len(payload), now_ns))
        self.counts[topic].sent += 1
        command = CommandMessage(
            sender=self._sender,
            number=self._number,
            topic=stream[0],
            revision=stream[1].revision,
            stamp_ns=stamp_ns,
            payload=payload,
        )
        return COMMANDS.to_bytes(command)

    def _expire(self, now_ns: int) -> None:
        """Drop what would be too old in any case."""
        for key, waiting in list(self._waiting.items()):
            if now_ns - waiting.offered_ns > MAX_AGE_NS:
                del self._waiting[key]
                self.counts[key[0]].expired += 1

    @property
    def _flights(self) -> list[_Flight]:
        """The messages under way."""
        known = max(self._acknowledged, self._given_up)
        return [flight for flight in self._sent if flight.number > known]

    def _has_room(self, size_bytes: int) -> bool:
        flights = self._flights
        flying_bytes = sum(flight.size_bytes for flight in flights)
        return not flights or (
            len(flights) < self._window and flying_bytes + size_bytes <= _MOST_FLYING_BYTES
        )

    def _acknowledge(self, number: int | None, now_ns: int) -> None:
        if number is None or number == self._acknowledged:
            return
        if number > self._number:
            # Somebody else sends with our number: what we send would be taken for a repetition.
            self._sender, self._named_ns = self._new_sender(), None
            self._number = self._acknowledged = self._given_up = 0
            self._sent.clear()
            return
        self._acknowledged = max(self._acknowledged, number)
        newest = next((flight for flight in self._sent if flight.number == number), None)
        if newest is None:
            return
        self._trip_ns = now_ns - newest.sent_ns
        if self._trip_ns > self._trips.add(self._trip_ns, now_ns) + _QUEUE_NS:
            self._window = max(1, self._window // 2)
        elif self._was_full:
            self._window = min(self._window + 1, _MOST_WINDOW)
        self._was_full = False

    def _give_up_flights(self, now_ns: int) -> None:
        """Give up what was not acknowledged for long: it is lost, or too old when it arrives."""
        after_ns = _LOST_FLIGHT_NS + 2 * (self._trips.at(now_ns) or 0)
        if self._sent and now_ns - self._sent[-1].sent_ns > after_ns and self._flights:
            self._given_up = self._number
            self._window = 1


TICK_NS = NS_PER_S
"""How often to tell the time of the robot's clock though nothing arrived."""
ACKNOWLEDGE_NS = NS_PER_S // 20
MAX_HZ = 100
"""Messages of one topic that are delivered in a second at most."""
MAX_BURST = 20

_REPORT_STREAMS_NS = NS_PER_S
_REPEAT_STREAMS_NS = 5 * NS_PER_S
_FORGET_NS = 10 * NS_PER_S
_REVISIONS = 2**16


class Delivery(NamedTuple):
    """A message to be published on a topic of the robot."""

    topic: str
    payload: bytes


@dataclass(slots=True, eq=False)
class _Topic:
    """``credit_ns`` is the time for which messages may come at once at the highest rate."""

    state: CommandTopic
    revision: int = 0
    credit_ns: int = MAX_BURST * NS_PER_S // MAX_HZ
    credited_ns: int | None = None

    def admits(self, now_ns: int) -> bool:
        since_ns = 0 if self.credited_ns is None else now_ns - self.credited_ns
        self.credit_ns = min(self.credit_ns + since_ns, MAX_BURST * NS_PER_S // MAX_HZ)
        self.credited_ns = now_ns
        if self.credit_ns < NS_PER_S // MAX_HZ:
            return False
        self.credit_ns -= NS_PER_S // MAX_HZ
        return True

    def count(self, **counts: int) -> None:
        self.state = replace(
            self.state, **{name: getattr(self.state, name) + n for name, n in counts.items()}
        )


@dataclass(slots=True, eq=False)
class _Sender:
    """An operator's end."""

    last_ns: int
    number: int = 0
    names: tuple[str, ...] | None = None


class CommandReceiver:
    """Takes messages of ``topics`` that come over a link. The time that is passed in is the robot's clock.

    Give it what comes (``receive``), deliver what it returns, and send what ``next_report`` gives at
    ``wake_ns``. Nothing older than ``MAX_AGE_NS`` is delivered, and nothing twice, out of order or of
    another type than the one that holds now.
    """

    def __init__(self, topics: Sequence[str]) -> None:
        self.malformed = 0
        """Frames that were no message, or one of no accepted topic."""
        self._topics = [_Topic(CommandTopic(topic=topic)) for topic in topics]
        self._senders: dict[int, _Sender] = {}
        self._reported: tuple[CommandTopic, ...] = ()
        self._reported_streams_ns: int | None = None
        self._reported_ns: int | None = None
        self._has_news = False

    @property
    def topics(self) -> list[CommandTopic]:
        return [topic.state for topic in self._topics]

    def follow(self, topic: str, type_name: str | None, problem: str | None = None) -> None:
        """From now on deliver messages of ``topic`` with that type; without one, none."""
        for accepted in self._topics:
            known = (accepted.state.type_name, accepted.state.problem)
            if accepted.state.topic != topic or known == (type_name, problem):
                continue
            if accepted.state.type_name != type_name:
                accepted.revision = (accepted.revision + 1) % _REVISIONS
            accepted.state = replace(accepted.state, type_name=type_name, problem=problem)
            self._reported_streams_ns = None
            self._has_news = True

    def receive(self, data: bytes, now_ns: int) -> Delivery | None:
        """The message of ``data``, if it is to be delivered."""
        try:
            command = COMMANDS.from_bytes(data)
        except LinkError:
            self.malformed += 1
            return None
        sender = self._sender(command.sender, now_ns)
        if isinstance(command, SentNames):
            sender.names = command.topics
            self._has_news = True
            return None
        if command.topic >= len(self._topics):
            self.malformed += 1
            return None
        return self._message(self._topics[command.topic], sender, command, now_ns)

    def fail(self, topic: str) -> None:
        """The last message of ``topic`` could not be published."""
        for accepted in self._topics:
            if accepted.state.topic == topic:
                accepted.count(delivered=-1, refused=1)

    def sent_names(self, now_ns: int) -> list[tuple[str, ...]]:
        """The names that each operator's end sends, of the ends that were heard lately."""
        return [
            sender.names
            for sender in self._senders.values()
            if sender.names is not None and now_ns - sender.last_ns <= _FORGET_NS
        ]

    @property
    def wake_ns(self) -> int:
        if self._reported_ns is None:
            return 0
        return self._reported_ns + (ACKNOWLEDGE_NS if self._has_news else TICK_NS)

    def next_report(self, now_ns: int) -> bytes:
        self._reported_ns, self._has_news = now_ns, False
        topics = tuple(self.topics)
        after_ns = _REPEAT_STREAMS_NS if topics == self._reported else _REPORT_STREAMS_NS
        streams: list[AcceptedStream] = []
        if self._reported_streams_ns is None or now_ns - self._reported_streams_ns >= after_ns:
            self._reported, self._reported_streams_ns = topics, now_ns
            streams = [
                AcceptedStream(topic=_short(topic.state), revision=topic.revision) for topic in self._topics
            ]
        acknowledged = {number: sender.number for number, sender in self._senders.items()}
        report = CommandReport(sent_ns=now_ns, acknowledged=acknowledged, streams=streams)
        return COMMAND_REPORTS.to_bytes(report)

    def _message(
        self, topic: _Topic, sender: _Sender, command: CommandMessage, now_ns: int
    ) -> Delivery | None:
        age_ns = now_ns - command.stamp_ns
        is_new = command.number > sender.number
        sender.number = max(sender.number, command.number)
        self._has_news = True
        topic.count(received=1)
        if age_ns >= 0:
            topic.state = replace(topic.state, age_ms=age_ns / NS_PER_MS)
        if age_ns > MAX_AGE_NS:
            topic.count(too_old=1)
            return None
        # A stamp is never later than its message: one of the future is of a clock that is not known.
        is_of_type = topic.state.type_name is not None and command.revision == topic.revision
        if age_ns < 0 or not is_new or not is_of_type or not topic.admits(now_ns):
            topic.count(refused=1)
            return None
        topic.count(delivered=1)
        return Delivery(topic.state.topic, command.payload)

    def _sender(self, number: int, now_ns: int) -> _Sender:
        sender = self._senders.get(number)
        if sender is None:
            if len(self._senders) >= MAX_SENDERS:
                del self._senders[min(self._senders, key=lambda key: self._senders[key].last_ns)]
            sender = self._senders[number] = _Sender(now_ns)
            # Who has just come wants to know the topics.
            self._reported = ()
        sender.last_ns = now_ns
        return sender


def _short(topic: CommandTopic) -> CommandTopic:
    return replace(topic, problem=topic.problem and topic.problem[:MAX_PROBLEM])
