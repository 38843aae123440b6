# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The robot's end of what operators send: which messages are young enough, and what to report."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

from smarttestudo.domain.errors import LinkError
from smarttestudo.domain.link import MAX_AGE_NS, CommandTopic
from smarttestudo.domain.units import NS_PER_MS, NS_PER_S
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

TICK_NS = NS_PER_S
"""How often to tell the time of the robot's clock though nothing came."""
ACKNOWLEDGE_NS = NS_PER_S // 20
MAX_HZ = 100
"""Messages of one topic that are delivered in a second at most."""
MAX_BURST = 20

_TELL_NS = NS_PER_S
_TELL_AGAIN_NS = 5 * NS_PER_S
_FORGET_NS = 10 * NS_PER_S
_REVISIONS = 2**16


class Delivery(NamedTuple):
    """A message to be published on a topic of the robot."""

    topic: str
    payload: bytes


@dataclass(slots=True, eq=False)
class _Topic:
    """``credit_ns`` is the time for which messages may come at once at the highest rate."""

    told: CommandTopic
    revision: int = 0
    credit_ns: int = MAX_BURST * NS_PER_S // MAX_HZ
    credited_ns: int | None = None

    def admits(self, now_ns: int) -> bool:
        """Whether one more message is within the rate."""
        since_ns = 0 if self.credited_ns is None else now_ns - self.credited_ns
        self.credit_ns = min(self.credit_ns + since_ns, MAX_BURST * NS_PER_S // MAX_HZ)
        self.credited_ns = now_ns
        if self.credit_ns < NS_PER_S // MAX_HZ:
            return False
        self.credit_ns -= NS_PER_S // MAX_HZ
        return True

    def count(self, **counts: int) -> None:
        """Add to the counts of that name."""
        self.told = replace(self.told, **{name: getattr(self.told, name) + n for name, n in counts.items()})


@dataclass(slots=True, eq=False)
class _Sender:
    """An operator's end."""

    heard_ns: int
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
        self._told: tuple[CommandTopic, ...] = ()
        self._told_ns: int | None = None
        self._reported_ns: int | None = None
        self._has_news = False

    @property
    def topics(self) -> list[CommandTopic]:
        """The topics with their counts."""
        return [topic.told for topic in self._topics]

    def follow(self, topic: str, type_name: str | None, problem: str | None = None) -> None:
        """From now on deliver messages of ``topic`` with that type; without one, none."""
        for one in self._topics:
            known = (one.told.type_name, one.told.problem)
            if one.told.topic != topic or known == (type_name, problem):
                continue
            if one.told.type_name != type_name:
                one.revision = (one.revision + 1) % _REVISIONS
            one.told = replace(one.told, type_name=type_name, problem=problem)
            self._told_ns = None
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
        for one in self._topics:
            if one.told.topic == topic:
                one.count(delivered=-1, refused=1)

    def sent_names(self, now_ns: int) -> list[tuple[str, ...]]:
        """The names that each operator's end sends, of the ends that were heard lately."""
        return [
            sender.names
            for sender in self._senders.values()
            if sender.names is not None and now_ns - sender.heard_ns <= _FORGET_NS
        ]

    @property
    def wake_ns(self) -> int:
        """When the next report is due."""
        if self._reported_ns is None:
            return 0
        return self._reported_ns + (ACKNOWLEDGE_NS if self._has_news else TICK_NS)

    def next_report(self, now_ns: int) -> bytes:
        """The report to send now."""
        self._reported_ns, self._has_news = now_ns, False
        told = tuple(self.topics)
        after_ns = _TELL_AGAIN_NS if told == self._told else _TELL_NS
        streams: list[AcceptedStream] = []
        if self._told_ns is None or now_ns - self._told_ns >= after_ns:
            self._told, self._told_ns = told, now_ns
            streams = [AcceptedStream(topic=_short(one.told), revision=one.revision) for one in self._topics]
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
            topic.told = replace(topic.told, age_ms=age_ns / NS_PER_MS)
        if age_ns > MAX_AGE_NS:
            topic.count(too_old=1)
            return None
        # A stamp is never later than its message: one of the future is of a clock that is not known.
        is_of_type = topic.told.type_name is not None and command.revision == topic.revision
        if age_ns < 0 or not is_new or not is_of_type or not topic.admits(now_ns):
            topic.count(refused=1)
            return None
        topic.count(delivered=1)
        return Delivery(topic.told.topic, command.payload)

    def _sender(self, number: int, now_ns: int) -> _Sender:
        sender = self._senders.get(number)
        if sender is None:
            if len(self._senders) >= MAX_SENDERS:
                del self._senders[min(self._senders, key=lambda one: self._senders[one].heard_ns)]
            sender = self._senders[number] = _Sender(now_ns)
            # Who has just come wants to know the topics.
            self._told = ()
        sender.heard_ns = now_ns
        return sender


def _short(topic: CommandTopic) -> CommandTopic:
    return replace(topic, problem=topic.problem and topic.problem[:MAX_PROBLEM])
