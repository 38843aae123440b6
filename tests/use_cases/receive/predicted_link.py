# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A robot's loop, a link and operator's ends that predict, in virtual time.

After every message of the source it is judged what an operator's end shows at the stamp of that message. What
it shows is judged as soon as it has what the robot's end had relayed by then: until that came, the picture is
late by the link's delay, and how often it was so is counted.
"""

from __future__ import annotations

import heapq
import itertools
from collections import defaultdict
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

from link.simulated_link import MS, Link, S
from runtime.loop_driver import rule_set_of
from smarttestudo.domain.link import (
    LinkNeeds,
    MessageOrigin,
    MissedMessage,
    Prediction,
    ReceivedMessage,
    StreamInfo,
)
from smarttestudo.domain.link_state import LinkState, StreamCounts
from smarttestudo.domain.observation import SourceChanged
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.questions import Asked
from smarttestudo.domain.robot import Publisher, Qos
from smarttestudo.domain.status import RuntimeStatus
from smarttestudo.link.receiver import LinkReceiver
from smarttestudo.link.reports import Announcement, Report
from smarttestudo.link.sender import LinkSender
from smarttestudo.runtime import RelayLoop
from smarttestudo.runtime.inputs import ChangeInput, LoopInput, MessageInput, RulesInput, WakeInput
from smarttestudo.use_cases.live.link_watch import LINK_PERIOD_S, LinkWatch
from smarttestudo.use_cases.live.rules import LiveRules
from smarttestudo.use_cases.receive.prediction import Predictor

Poses = Mapping[str, float]
"""The x of each part of a message."""


class VirtualEnd:
    """The robot's end, as ``LinkWatch`` knows it."""

    robot = "ada"
    is_watched = False
    budget_kb_per_s = None

    def __init__(self, sender: LinkSender[None]) -> None:
        self.sender = sender
        self.now_ns = 0

    @property
    def state(self) -> LinkState:
        return self.sender.state(self.now_ns)

    def follow(self, needs: Mapping[str, LinkNeeds]) -> None:
        self.sender.follow(needs)

    def predict(self, predictions: Mapping[str, Prediction], anew: Collection[str]) -> None:
        self.sender.predict(predictions, anew, self.now_ns)

    def counts(self) -> dict[str, StreamCounts]:
        return {}

    def advertise(self, stream: StreamInfo) -> Publisher:
        raise NotImplementedError

    def tell(self, status: RuntimeStatus) -> None:
        raise NotImplementedError

    def keep_missed(self, origin: Callable[[], MessageOrigin | None]) -> None:
        raise NotImplementedError

    def take_missed(self, *, is_last: bool = False) -> list[MissedMessage]:
        raise NotImplementedError

    def take_question(self) -> Asked | None:
        raise NotImplementedError

    def offer_incidents(self, folder: Path) -> None:
        raise NotImplementedError

    def age_ms(self, topic: str) -> float | None:
        raise NotImplementedError


@dataclass
class Sent:
    """A message of the source: where the robot was, and the bound in force; ``reckons``: its end did."""

    at_ns: int
    poses: Poses
    bound: float
    reckons: bool


@dataclass
class Operator:
    """One operator's end, and what it gets of ``topic``."""

    number: int
    topic: str
    predicts: bool
    read: Callable[[bytes], Poses]
    hears: bool = True
    is_greeted: bool = False
    """Whether the robot's end knows that it came; before that it has no picture to judge."""
    newest: bytes | None = None
    late: int = 0
    waiting: dict[bytes, list[Sent]] = field(default_factory=lambda: defaultdict(list))

    def __post_init__(self) -> None:
        topics = frozenset({self.topic} if self.predicts else ())
        self.link = LinkReceiver("ada", self.number, lambda data, _most: data, topics)
        self.predictor = Predictor(topics, lambda _robot, _topic: None)
        self.got: list[ReceivedMessage] = []

    @property
    def is_told(self) -> bool:
        """Whether it predicts, as the robot's end said that it reckons, too."""
        return self.predicts and any(info.prediction is not None for info in self.link.streams.values())

    def shows(self, at_ns: int) -> Poses:
        """By the last messages alone, or by what is predicted for ``at_ns``."""
        shown: dict[str, float] = {}
        stream = next(iter(self.predictor._streams.values()), None)
        for message in self.got:
            payload: bytes | None = message.payload
            if stream is not None and stream.prediction is not None:
                payload = stream.picture.reckoned(message.payload, None, at_ns, stream.prediction.within)
            shown |= self.read(message.payload if payload is None else payload)
        return shown


class PredictedLink:
    """All of it, driven by events. ``write`` makes messages of a robot at ``x``, ``read`` reads them."""

    def __init__(
        self,
        topic: str,
        type_name: str,
        link: Link,
        rules: str,
        *,
        write: Callable[[int, int], bytes],
        read: Callable[[bytes], Poses],
    ) -> None:
        self.topic, self.link, self.write, self.read = topic, link, write, read
        self.now_ns = 0
        self.sender: LinkSender[None] = LinkSender()
        self.end = VirtualEnd(self.sender)
        self.watch = LinkWatch(self.end)
        qos = Qos(reliable=True, transient_local=False)
        stream = self.sender.open(StreamInfo(topic=topic, type_name=type_name, qos=qos), 0)
        assert stream is not None
        self.stream = stream
        self.rules = self._live(rules)
        self.loop = RelayLoop(self.rules.rule_set, Profile(), 0)
        self.operators: list[Operator] = []
        self.relayed: bytes | None = None
        self.sent = self.passed = 0
        self.judged: list[tuple[Operator, Sent, float]] = []
        self._events: list[tuple[int, int, Callable[[], None]]] = []
        self._order = itertools.count()
        self._take(
            ChangeInput(
                stamp_ns=0,
                change=SourceChanged(topic=topic, publishers=1, transient_local=False, type_name=type_name),
            )
        )
        self.at(0, self._look)

    # What happens.

    def at(self, at_ns: int, act: Callable[[], None]) -> None:
        heapq.heappush(self._events, (at_ns, next(self._order), act))

    def run(self, until_ns: int) -> None:
        while self._events and self._events[0][0] <= until_ns:
            self.now_ns, _, act = heapq.heappop(self._events)
            self.end.now_ns = self.now_ns
            self._wake()
            act()
            self._pump()

    def join(self, *, predicts: bool = True) -> Operator:
        operator = Operator(len(self.operators) + 1, self.topic, predicts, self.read)
        self.operators.append(operator)
        self._report(operator)
        return operator

    def reload(self, rules: str) -> None:
        self.rules = self._live(rules)
        self._take(RulesInput(stamp_ns=self.now_ns, rule_set=self.rules.rule_set, profile=self.rules.profile))

    def publish(self) -> None:
        payload = self.write(self.sent, self.now_ns)
        self.sent += 1
        self._take(MessageInput(self.now_ns, self.topic, payload, len(payload)))
        bound = self.loop.knowledge.plan[self.topic].within["position"]
        reckons = self.topic in self.loop.relays.pictures
        sent = Sent(self.now_ns, self.read(payload), bound, reckons)
        for operator in self.operators:
            if not operator.is_greeted:
                operator.late += 1
            elif self.relayed is not None and operator.newest == self.relayed:
                self._judge(operator, sent)
            elif self.relayed is not None:
                operator.late += 1
                operator.waiting[self.relayed].append(sent)

    # How it goes on.

    def _live(self, rules: str) -> LiveRules:
        rule_set = rule_set_of(rules)
        return LiveRules(rule_set=rule_set, output_topics={self.topic: self.topic}, profile=Profile())

    def _wake(self) -> None:
        wake_ns = self.loop.next_wake_ns
        if wake_ns is not None and wake_ns <= self.now_ns:
            self._take(WakeInput(stamp_ns=self.now_ns))

    def _take(self, given: LoopInput) -> None:
        relayed = self.loop.take(given)
        if relayed:
            self.watch.tell_pictures(self.rules, self.loop.relays.pictures)
        for one in relayed:
            self.relayed = one.payload[:]
            self.passed += 1
            self.sender.offer(self.stream, self.relayed, self.now_ns)

    def _look(self) -> None:
        plan = self.loop.knowledge.plan
        for change in self.watch.changed_receivers(self.rules, plan, ()):
            self._take(ChangeInput(stamp_ns=self.now_ns, change=change))
        for operator in self.operators:
            operator.is_greeted |= operator.number in self.sender._receivers.numbers
        self.watch.tell_pictures(self.rules, self.loop.relays.pictures)
        self.watch.follow(self.rules, plan)
        self.at(self.now_ns + int(LINK_PERIOD_S * S), self._look)

    def _pump(self) -> None:
        while (data := self.sender.next_chunk(self.now_ns)) is not None:
            arrival_ns = self.link.arrival_ns(len(data), self.now_ns)
            self.at(arrival_ns, partial(self._arrive, data))

    def _arrive(self, data: bytes) -> None:
        for operator in self.operators:
            if not operator.hears:
                continue
            got = operator.link.take(data, self.now_ns)
            if isinstance(got, Announcement) and got.info is not None:
                operator.predictor.open("ada", got.info)
            elif isinstance(got, ReceivedMessage):
                operator.predictor.take(got, self.now_ns)
                operator.got = [one for one in operator.got if not self._replaces(got, one)] + [got]
                operator.newest = got.payload
                for sent in operator.waiting.pop(got.payload, ()):
                    self._judge(operator, sent)

    def _replaces(self, new: ReceivedMessage, old: ReceivedMessage) -> bool:
        return self.read(new.payload).keys() >= self.read(old.payload).keys()

    def _judge(self, operator: Operator, sent: Sent) -> None:
        if operator.is_told != sent.reckons:
            # Who came, or what the robot's end does since then, has not been said at the other end yet.
            operator.late += 1
            return
        shown = operator.shows(sent.at_ns)
        error = max(abs(shown.get(name, 1e9) - x) for name, x in sent.poses.items())
        self.judged.append((operator, sent, error))

    def _report(self, operator: Operator) -> None:
        if not operator.hears:
            return
        if operator.link.wake_ns <= self.now_ns and self.link.rate(self.now_ns) > 0:
            report = Report.from_bytes(operator.link.next_report(self.now_ns))
            self.at(
                self.now_ns + int(self.link.delay_s * S),
                lambda: self.sender.take_report(report, self.now_ns),
            )
        self.at(max(operator.link.wake_ns, self.now_ns + 20 * MS), partial(self._report, operator))
