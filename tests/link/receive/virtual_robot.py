# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A robot's end in virtual time: its loop, its publishers on the link, and what it has receivers reckon."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Collection, Mapping
from pathlib import Path

from loop.loop_driver import rule_set_of
from smarttestudo.domain.link import (
    LinkNeeds,
    LinkState,
    MessageOrigin,
    MissedMessage,
    Prediction,
    StreamCounts,
    StreamInfo,
)
from smarttestudo.domain.observation import SourceChanged
from smarttestudo.domain.parameter import Asked
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.robot import Payload, Publisher, Qos
from smarttestudo.link.parts.live_link import LinkWatch
from smarttestudo.link.protocol.sender import LinkSender
from smarttestudo.loop import RelayLoop
from smarttestudo.loop.inputs import ChangeInput, LoopInput, RulesInput, WakeInput
from smarttestudo.pacing.cdr import StreamReader
from smarttestudo.pacing.reckoning.estimate import Estimate
from smarttestudo.robot.live_rules import LiveRules
from smarttestudo.robot.topic import PublisherPool


class VirtualEnd:
    """The robot's end, as ``LinkWatch`` knows it."""

    robot = "ada"
    is_settled = True
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

    def tell(self, status: Mapping[str, object]) -> None:
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
        self._reader = StreamReader(info.type_name)

    def publish(self, payload: Payload) -> None:
        data = payload[:]
        self._end.sender.put(self._number, data, self._end.now_ns, self._reader.streams(data) or None)

    def close(self) -> None:
        self._end.sender.close(self._number, self._end.now_ns)


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
    def estimate(self) -> Estimate | None:
        """What it believes that receivers reckon."""
        return self._estimate if self.topic in self.loop.relays.estimates else None

    def stamps_ns(self, payload: bytes, now_ns: int) -> Mapping[str, int]:
        """The stamps of the parts in ``payload``."""
        (parts,) = self._estimate.read(payload, None, now_ns)
        return {part.name: part.at_ns for part in parts or ()}

    @property
    def _estimate(self) -> Estimate:
        accuracy = self.loop.relays._relays[self.topic]._accuracy
        assert accuracy is not None
        return accuracy.estimate

    @property
    def is_idle(self) -> bool:
        """Whether all that was relayed has arrived."""
        return self.in_flight == 0 and self.sender._outbox.is_empty

    def reload(self, rules: str, now_ns: int) -> None:
        self.rules = self._live(rules)
        self.take(RulesInput(stamp_ns=now_ns, rule_set=self.rules.rule_set, profile=self.rules.profile))

    def take(self, given: LoopInput) -> None:
        relayed = self.loop.handle(given)
        if relayed:
            loop = self.loop
            self.watch.announce_estimates(self.rules, loop.knowledge.plan, loop.relays.estimates)
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
        self.watch.announce_estimates(self.rules, plan, self.loop.relays.estimates)
        self.watch.follow(self.rules, plan)

    def _live(self, rules: str) -> LiveRules:
        rule_set = rule_set_of(rules)
        return LiveRules(rule_set=rule_set, output_topics={self.topic: self.topic}, profile=Profile())
