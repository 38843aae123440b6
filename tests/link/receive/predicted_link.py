# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A robot's end, a link and operator's ends that predict, in virtual time.

After every message of the source it is judged what an operator's end shows at the stamp of that message. What
it shows is judged as soon as it has what the robot's end had relayed by then: until that came, the
estimate is late by the link's delay, and how often it was so is counted.
"""

from __future__ import annotations

import heapq
import itertools
from collections import defaultdict
from collections.abc import Callable, Hashable, Mapping
from dataclasses import dataclass, field
from functools import partial

from link.protocol.simulated_link import MS, Link, S
from link.receive.virtual_robot import Robot
from smarttestudo.domain.link import ReceivedMessage
from smarttestudo.link.parts.live_link import LINK_PERIOD_S
from smarttestudo.link.protocol.messages import REPORTS, Announcement
from smarttestudo.link.protocol.receiver import LinkReceiver
from smarttestudo.link.receive.prediction import Predictor
from smarttestudo.link.zenoh.arrivals import RobotPresence, StreamSaid
from smarttestudo.loop.inputs import MessageInput, WakeInput
from smarttestudo.pacing.reckoning.estimate import Estimate, Shown
from smarttestudo.pacing.reckoning.gauges import MovingPart, PoseState

Poses = Mapping[str, float]
"""The x of each part of a message."""


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
    """Whether the robot's end knows that it came; before that it has no estimate to judge."""
    newest: bytes | None = None
    late: int = 0
    waiting: dict[bytes, list[Sent]] = field(default_factory=lambda: defaultdict(list))

    def __post_init__(self) -> None:
        self.warnings: list[str] = []
        topics = frozenset({self.topic} if self.predicts else ())
        self.predictor = Predictor(topics, lambda _robot, _topic: self.source_hz, self.warnings.append)
        self.got: list[Poses] = []
        """What the messages said of which no newer one says all."""
        self.predicted: list[tuple[int, bytes]] = []
        """What it predicted, with the time of that."""
        self.screen: dict[str, MovingPart] = {}
        """What the last message, arrived or predicted, said of each part that the estimate can have."""
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
    def estimate(self) -> Estimate | None:
        """What it reckons with, if there is something."""
        return next((topic.estimate for topic in self.predictor._topics.values()), None)

    def take(self, data: bytes, now_ns: int) -> bytes | None:
        """A chunk arrived: the message that is whole with it."""
        got = self.link.receive(data, now_ns)
        if isinstance(got, Announcement):
            said = StreamSaid(robot="ada", boot=self.link.boot, number=got.stream, info=got.info)
            self.predictor.handle(said, now_ns)
        elif isinstance(got, ReceivedMessage):
            self.predictor.handle(got, now_ns)
            said_now = self.read(got.payload)
            self.got = [one for one in self.got if not said_now.keys() >= one.keys()] + [said_now]
            self.newest = got.payload
            self._see(got.payload)
            return got.payload
        return None

    def predict(self, now_ns: int) -> None:
        for message in self.predictor.predicted(now_ns):
            self.predicted.append((now_ns, message.payload))
            self._see(message.payload)

    def _see(self, payload: bytes) -> None:
        if self.estimate is not None:
            parts = self.estimate._gauges[0].read(payload, None, 0) or ()
            self.screen |= {part.name: part for part in parts}

    def shows(self, stamps_ns: Mapping[str, int]) -> Poses:
        """By the last messages alone, or by what is reckoned for these stamps."""
        shown: dict[str, float] = {}
        for poses in self.got:
            shown |= poses
        if self.is_told and self.estimate is not None:
            gauge = self.estimate._gauges[0]
            for parts in self.estimate.moving().values():
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


def parts_of(estimate: Estimate) -> dict[Hashable, Shown]:
    """What is shown of each thing."""
    known = estimate._shown[0].values()
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
                operator.predictor.handle(event, self.now_ns)
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
            robot.estimate is not None,
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
        while (data := robot.sender.scheduler.next_chunk(self.now_ns)) is not None:
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
            report = REPORTS.from_bytes(operator.link.next_report(self.now_ns))
            arrival_ns = self.now_ns + int(self.link.delay_s * S)
            self.at(arrival_ns, lambda: robot.sender.handle_report(report, self.now_ns))
        next_ns = max(operator.link.wake_ns, self.now_ns + 20 * MS)
        self.at(next_ns, partial(self._report, operator, robot))
