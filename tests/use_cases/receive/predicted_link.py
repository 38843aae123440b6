# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A robot's end, a link and operator's ends that predict, in virtual time.

After every message of the source it is judged what an operator's end shows at the stamp of that message. What
it shows is judged as soon as it has what the robot's end had relayed by then: until that came, the picture is
late by the link's delay, and how often it was so is counted.
"""

from __future__ import annotations

import heapq
import itertools
from collections import defaultdict
from collections.abc import Callable, Collection, Hashable, Mapping
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

from link.simulated_link import MS, Link, S
from runtime.loop_driver import rule_set_of
from smarttestudo.adapters.zenoh.arrivals import RobotPresence, StreamSaid
from smarttestudo.cdr import child_frames
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
from smarttestudo.domain.payload import Payload
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.questions import Asked
from smarttestudo.domain.robot import Publisher, Qos
from smarttestudo.domain.status import RuntimeStatus
from smarttestudo.link.receiver import LinkReceiver
from smarttestudo.link.reports import Announcement, Report
from smarttestudo.link.sender import LinkSender
from smarttestudo.reckoning.gauges import MovingPart, PoseState
from smarttestudo.reckoning.picture import Picture, Shown
from smarttestudo.runtime import RelayLoop
from smarttestudo.runtime.inputs import ChangeInput, LoopInput, MessageInput, RulesInput, WakeInput
from smarttestudo.use_cases.live.link_watch import LINK_PERIOD_S, LinkWatch
from smarttestudo.use_cases.live.rules import LiveRules
from smarttestudo.use_cases.live.topic import PublisherPool
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
        return VirtualPublisher(self, stream)

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


class VirtualPublisher:
    """One stream of the robot's end."""

    def __init__(self, end: VirtualEnd, info: StreamInfo) -> None:
        number = end.sender.open(info, end.now_ns)
        assert number is not None
        self._end, self._number = end, number

    def publish(self, payload: Payload) -> None:
        data = payload[:]
        self._end.sender.offer(self._number, data, self._end.now_ns, child_frames(data) or None)

    def close(self) -> None:
        self._end.sender.close(self._number, self._end.now_ns)


@dataclass
class Sent:
    """A message of the source: where the robot was, and the bound in force; ``reckons``: its end did.

    ``stamps_ns`` are those of its parts, by name.
    """

    at_ns: int
    poses: Poses
    stamps_ns: Mapping[str, int]
    bound: float
    reckons: bool


class Robot:
    """One run of the robot's end, whose loop relays ``topic``."""

    def __init__(self, topic: str, type_name: str, rules: str, boot: str, now_ns: int) -> None:
        self.topic, self.boot = topic, boot
        self.sender: LinkSender[None] = LinkSender()
        self.end = VirtualEnd(self.sender)
        self.end.now_ns = now_ns
        self.watch = LinkWatch(self.end)
        self.in_flight = 0
        """Chunks that were sent and have not arrived."""
        self.relayed: bytes | None = None
        self.passed = 0
        self.relays: list[tuple[int, bytes]] = []
        """All that was relayed, with the time of that."""
        numbers = itertools.count()
        qos = Qos(reliable=True, transient_local=False)
        self.pool = PublisherPool(
            lambda: self.end.advertise(
                StreamInfo(topic=topic, type_name=type_name, qos=qos, publisher=next(numbers))
            ),
            one_each=True,
        )
        self.rules = self._live(rules)
        self.loop = RelayLoop(self.rules.rule_set, Profile(), now_ns)
        change = SourceChanged(topic=topic, publishers=1, transient_local=False, type_name=type_name)
        self.take(ChangeInput(stamp_ns=now_ns, change=change))

    @property
    def picture(self) -> Picture | None:
        """What it believes that receivers reckon."""
        return self._picture if self.topic in self.loop.relays.pictures else None

    def stamps_ns(self, payload: bytes, now_ns: int) -> Mapping[str, int]:
        """The stamps of the parts in ``payload``."""
        (parts,) = self._picture.read(payload, None, now_ns)
        return {part.name: part.at_ns for part in parts or ()}

    @property
    def _picture(self) -> Picture:
        accuracy = self.loop.relays._relays[self.topic]._accuracy
        assert accuracy is not None
        return accuracy.picture

    @property
    def is_idle(self) -> bool:
        """Whether all that was relayed has arrived."""
        return self.in_flight == 0 and self.sender._outbox.is_empty

    def reload(self, rules: str, now_ns: int) -> None:
        self.rules = self._live(rules)
        self.take(RulesInput(stamp_ns=now_ns, rule_set=self.rules.rule_set, profile=self.rules.profile))

    def take(self, given: LoopInput) -> None:
        relayed = self.loop.take(given)
        if relayed:
            loop = self.loop
            self.watch.tell_pictures(self.rules, loop.knowledge.plan, loop.relays.pictures)
        for one in relayed:
            self.relayed = one.payload[:]
            self.passed += 1
            self.relays.append((given.stamp_ns, self.relayed))
            self.pool.publish(one.payload, one.publisher)

    def look(self, now_ns: int) -> None:
        self.take(WakeInput(stamp_ns=now_ns))
        plan = self.loop.knowledge.plan
        for change in self.watch.changed_receivers(self.rules, plan, ()):
            self.take(ChangeInput(stamp_ns=now_ns, change=change))
        self.watch.tell_pictures(self.rules, plan, self.loop.relays.pictures)
        self.watch.follow(self.rules, plan)

    def _live(self, rules: str) -> LiveRules:
        rule_set = rule_set_of(rules)
        return LiveRules(rule_set=rule_set, output_topics={self.topic: self.topic}, profile=Profile())


@dataclass
class Operator:
    """One operator's end, and what it gets of ``topic``."""

    number: int
    topic: str
    predicts: bool
    read: Callable[[bytes], Poses]
    source_hz: float | None = None
    hears: bool = True
    is_greeted: bool = False
    """Whether the robot's end knows that it came; before that it has no picture to judge."""
    newest: bytes | None = None
    late: int = 0
    waiting: dict[bytes, list[Sent]] = field(default_factory=lambda: defaultdict(list))

    def __post_init__(self) -> None:
        self.warnings: list[str] = []
        topics = frozenset({self.topic} if self.predicts else ())
        self.predictor = Predictor(topics, lambda _robot, _topic: self.source_hz, self.warnings.append)
        self.got: list[ReceivedMessage] = []
        self.predicted: list[tuple[int, bytes]] = []
        """What it predicted, with the time of that."""
        self.screen: dict[str, MovingPart] = {}
        """What the last message, arrived or predicted, said of each part that the picture can have."""
        self._topics = topics
        self.meet("0")

    def meet(self, boot: str) -> None:
        """Hear of another run of the robot's end."""
        self.link = LinkReceiver("ada", self.number, lambda data, _most: data, self._topics, boot=boot)

    @property
    def is_told(self) -> bool:
        """Whether it predicts, as the robot's end said that it reckons, too."""
        return self.predicts and any(info.prediction is not None for info in self.link.streams.values())

    @property
    def picture(self) -> Picture | None:
        """What it reckons with, if there is something."""
        return next((topic.picture for topic in self.predictor._topics.values()), None)

    def take(self, data: bytes, now_ns: int) -> bytes | None:
        """A chunk arrived: the message that is whole with it."""
        got = self.link.take(data, now_ns)
        if isinstance(got, Announcement):
            said = StreamSaid(robot="ada", boot=self.link.boot, number=got.stream, info=got.info)
            self.predictor.take(said, now_ns)
        elif isinstance(got, ReceivedMessage):
            self.predictor.take(got, now_ns)
            names = self.read(got.payload).keys()
            self.got = [one for one in self.got if not names >= self.read(one.payload).keys()] + [got]
            self.newest = got.payload
            self._see(got.payload)
            return got.payload
        return None

    def predict(self, now_ns: int) -> None:
        for message in self.predictor.predicted(now_ns):
            self.predicted.append((now_ns, message.payload))
            self._see(message.payload)

    def _see(self, payload: bytes) -> None:
        if self.picture is not None:
            parts = self.picture._gauges[0].read(payload, None, 0) or ()
            self.screen |= {part.name: part for part in parts}

    def shows(self, stamps_ns: Mapping[str, int]) -> Poses:
        """By the last messages alone, or by what is reckoned for these stamps."""
        shown: dict[str, float] = {}
        for message in self.got:
            shown |= self.read(message.payload)
        if self.is_told and self.picture is not None:
            gauge = self.picture._gauges[0]
            for parts in self.picture.moving().values():
                for name in {one.part.name for one in parts} & stamps_ns.keys():
                    (one,) = (one for one in parts if one.part.name == name)
                    shown[name] = x_of(one.at(gauge, stamps_ns[name]))
        return shown


def x_of(state: object) -> float:
    """Where a part is: the position of a joint, or the x of a pose."""
    if isinstance(state, PoseState):
        return state.pose.position.x
    assert isinstance(state, tuple)
    return float(state[0])


def parts_of(picture: Picture) -> dict[Hashable, Shown]:
    """What is shown of each thing."""
    known = picture._shown[0].values()
    return {one.part.name or one.part.frames: one for one in known}


class PredictedLink:
    """All of it, driven by events.

    ``write`` makes the message of that number and time, which ``read`` reads; ``publishes`` is its publisher.
    """

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
        self.topic, self.type_name, self.link, self.write, self.read = topic, type_name, link, write, read
        self.now_ns = 0
        self.rules = rules
        self.robot = Robot(topic, type_name, rules, "0", 0)
        self.operators: list[Operator] = []
        self.publisher: Hashable = "first"
        self.sent = 0
        self.judged: list[tuple[Operator, Sent, float]] = []
        self.watched: Callable[[], None] = lambda: None
        """Called after everything that happened."""
        self._events: list[tuple[int, int, Callable[[], None]]] = []
        self._order = itertools.count()
        self.at(0, self._look)

    # What happens.

    def at(self, at_ns: int, act: Callable[[], None]) -> None:
        heapq.heappush(self._events, (at_ns, next(self._order), act))

    def run(self, until_ns: int) -> None:
        while self._events and self._events[0][0] <= until_ns:
            self.now_ns, _, act = heapq.heappop(self._events)
            self.robot.end.now_ns = self.now_ns
            self._wake()
            act()
            self._pump()
            for operator in self.operators:
                operator.predict(self.now_ns)
                due_ns = operator.predictor.due_ns
                if due_ns is not None and self._is_first(due_ns):
                    self.at(max(due_ns, self.now_ns + 1), lambda: None)
            self.watched()

    def join(self, *, predicts: bool = True, source_hz: float | None = None) -> Operator:
        operator = Operator(len(self.operators) + 1, self.topic, predicts, self.read, source_hz)
        operator.meet(self.robot.boot)
        self.operators.append(operator)
        self._report(operator, self.robot)
        return operator

    def reload(self, rules: str) -> None:
        self.rules = rules
        self.robot.reload(rules, self.now_ns)

    def restart_source(self) -> None:
        """Another publisher comes in the place of the one that is there, which is noticed a while later."""
        gone, self.publisher = self.publisher, f"after {self.publisher} at {self.now_ns}"
        robot = self.robot
        self.at(self.now_ns + int(0.4 * S), lambda: robot.pool.forget([gone]))

    def restart_robot(self) -> None:
        """The robot's end is started anew."""
        gone = self.robot
        boot = str(int(gone.boot) + 1)
        self.robot = Robot(self.topic, self.type_name, self.rules, boot, self.now_ns)
        for operator in self.operators:
            for one, is_present in ((boot, True), (gone.boot, False)):
                event = RobotPresence(robot="ada", boot=one, is_present=is_present)
                operator.predictor.take(event, self.now_ns)
            operator.meet(boot)
            operator.is_greeted = False
            self._report(operator, self.robot)

    def publish(self) -> None:
        self.give(self.write(self.sent, self.now_ns))
        self.sent += 1

    def give(self, payload: bytes) -> None:
        """The source sends a message."""
        robot = self.robot
        given = MessageInput(self.now_ns, self.topic, payload, len(payload), None, self.publisher)
        robot.take(given)
        (bound,) = robot.loop.knowledge.plan[self.topic].within.values()
        sent = Sent(
            self.now_ns,
            self.read(payload),
            robot.stamps_ns(payload, self.now_ns),
            bound,
            robot.picture is not None,
        )
        for operator in self.operators:
            if not operator.is_greeted:
                operator.late += 1
            elif robot.relayed is not None and operator.newest == robot.relayed:
                self._judge(operator, sent)
            elif robot.relayed is not None:
                operator.late += 1
                operator.waiting[robot.relayed].append(sent)

    # How it goes on.

    def _is_first(self, at_ns: int) -> bool:
        return not self._events or at_ns < self._events[0][0]

    def _wake(self) -> None:
        wake_ns = self.robot.loop.next_wake_ns
        if wake_ns is not None and wake_ns <= self.now_ns:
            self.robot.take(WakeInput(stamp_ns=self.now_ns))

    def _look(self) -> None:
        self.robot.look(self.now_ns)
        for operator in self.operators:
            operator.is_greeted |= operator.number in self.robot.sender._receivers.numbers
        self.at(self.now_ns + int(LINK_PERIOD_S * S), self._look)

    def _pump(self) -> None:
        robot = self.robot
        while (data := robot.sender.next_chunk(self.now_ns)) is not None:
            robot.in_flight += 1
            self.at(self.link.arrival_ns(len(data), self.now_ns), partial(self._arrive, robot, data))

    def _arrive(self, robot: Robot, data: bytes) -> None:
        robot.in_flight -= 1
        for operator in self.operators:
            if operator.hears and operator.link.boot == robot.boot:
                payload = operator.take(data, self.now_ns)
                for sent in operator.waiting.pop(payload, ()) if payload is not None else ():
                    self._judge(operator, sent)

    def _judge(self, operator: Operator, sent: Sent) -> None:
        if operator.is_told != sent.reckons:
            # Who came, or what the robot's end does since then, has not been said at the other end yet.
            operator.late += 1
            return
        shown = operator.shows(sent.stamps_ns)
        error = max(abs(shown.get(name, 1e9) - x) for name, x in sent.poses.items())
        self.judged.append((operator, sent, error))

    def _report(self, operator: Operator, robot: Robot) -> None:
        if not operator.hears or operator.link.boot != robot.boot:
            return
        if operator.link.wake_ns <= self.now_ns and self.link.rate(self.now_ns) > 0:
            report = Report.from_bytes(operator.link.next_report(self.now_ns))
            arrival_ns = self.now_ns + int(self.link.delay_s * S)
            self.at(arrival_ns, lambda: robot.sender.take_report(report, self.now_ns))
        next_ns = max(operator.link.wake_ns, self.now_ns + 20 * MS)
        self.at(next_ns, partial(self._report, operator, robot))
