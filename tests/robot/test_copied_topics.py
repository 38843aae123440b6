# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A part is told the same of topics that are relayed without Python as of others, at the same times."""

from __future__ import annotations

import random
from collections import deque
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from types import SimpleNamespace

from hypothesis import example, given, settings
from hypothesis import strategies as st

from incidents.incident_runs import rules_of
from pacing.scenarios import seeds
from robot.small_graph import MemorySubscription, SmallGraph
from smarttestudo.domain.compiled_relay import (
    CompiledRelay,
    Copying,
    MessageCopy,
    RelayCounts,
    RelayState,
)
from smarttestudo.domain.robot import GraphChange, Instant, Payload, PollGraph, Publisher, Subscription
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.loop.relay import Relayed
from smarttestudo.loop.step import Trigger
from smarttestudo.robot.decisions import LiveDecisions
from smarttestudo.robot.input_recorder import InputRecorder
from smarttestudo.robot.live_rules import LiveRules
from smarttestudo.robot.live_run import LiveRun
from smarttestudo.robot.option import Settings
from smarttestudo.robot.part import Part
from smarttestudo.robot.source import LiveSource

TOPICS = ("/imu", "/odom", "/scan", "/arm")
GIDS = {topic: topic.encode() for topic in TOPICS}
RECORDS = 'If CheckValue /arm data > 1 Then Record "raised" /scan Before 1 s After 1 s EndIf'
RELAYED = (("/imu", "/odom", "/scan"), ("/imu", "/odom"), ("/scan",))


class MemoryRelay:
    """One that lets everything pass at Full, and nothing else."""

    def __init__(
        self,
        relays: MemoryRelays,
        subscription: MemorySubscription,
        publisher: Publisher | None,
        copying: Copying,
        ended: Callable[[RelayState], None],
    ) -> None:
        self.relays, self.topic, self.publisher = relays, subscription.topic, publisher
        self.copying, self.ended = copying, ended

    def begin(self, state: RelayState) -> None:
        self.state, self.period_ns = state, state.period_ns

    def takes(self, copy: MessageCopy) -> None:
        copying, waiting, steady_ns = self.copying, self.relays.waiting, copy.at.steady_ns
        if copying.received is not None:
            received = copy if copying.has_payload else replace(copy, payload=None)
            waiting.append((steady_ns, partial(copying.received, received)))
        if self.period_ns != 0:
            return
        if copying.passed is not None:
            waiting.append((steady_ns, partial(copying.passed, copy)))
        elif self.publisher is not None:
            self.publisher.publish(copy.payload or b"")

    def set_pace(self, period_ns: int) -> None:
        self.period_ns = period_ns

    def counts(self) -> RelayCounts:
        return self.state.counts

    def end(self) -> None:
        self.relays.running.pop(self.topic)
        self.relays.deliver(self.relays.latest_ns)
        self.ended(self.state)


class MemoryRelays:
    """A ``CompiledRelays`` that keeps copies until they are to be delivered."""

    can_relay = True

    def __init__(self) -> None:
        self.running: dict[str, MemoryRelay] = {}
        self.begun = 0
        self.latest_ns = 0
        self.waiting: deque[tuple[int, Callable[[], None]]] = deque()

    def takes(self, topic: str, payload: bytes, gid: bytes, at: Instant) -> bool:
        """Whether a relay took the message."""
        relay = self.running.get(topic)
        if relay is None:
            return False
        self.latest_ns = at.steady_ns
        relay.takes(MessageCopy(at=at, publisher=gid, size_bytes=len(payload), payload=payload))
        return True

    def serves(self, subscription: Subscription, publisher: Publisher | None) -> bool:
        return isinstance(subscription, MemorySubscription)

    def begin(
        self,
        subscription: Subscription,
        publisher: Publisher | None,
        state: Callable[[], RelayState],
        ended: Callable[[RelayState], None],
        copying: Copying,
    ) -> CompiledRelay | None:
        assert isinstance(subscription, MemorySubscription)
        relay = MemoryRelay(self, subscription, publisher, copying, ended)
        relay.begin(state())
        self.running[relay.topic] = relay
        self.begun += 1
        return relay

    def deliver(self, steady_ns: int) -> None:
        while self.waiting and self.waiting[0][0] <= steady_ns:
            self.waiting.popleft()[1]()


class ActingGraph(SmallGraph):
    """A graph on which something happens whenever the run waits, by chance."""

    compiled: MemoryRelays | None  # type: ignore[assignment]

    def __init__(self, seed: int, acts: int, *, is_returned: bool, jumps_back: bool = False) -> None:
        super().__init__()
        self.is_returned, self.jumps_back = is_returned, jumps_back
        self.compiled = None
        self.chance, self.acts_left = random.Random(seed), acts
        self.clock_ns, self.number = NS_PER_S, 0
        self.ahead_ns, self.has_jumped = 0, False
        self.run: LiveRun | None = None
        for topic in TOPICS:
            self.joins(topic, GIDS[topic])
            self.listens(f"/testudo{topic}")

    def now_ns(self) -> int:
        return self.clock_ns

    def steady_ns(self) -> int:
        return self.clock_ns - self.ahead_ns

    def poll_graph(self, poll: PollGraph) -> None:
        self._poll = poll

    def wait(self, wake_ns: int | None, longest_s: float) -> None:
        self.acts_left -= 1
        self.has_jumped = False
        self.clock_ns += self.chance.randrange(NS_PER_S // 20)
        for _ in range(self.chance.randint(1, 3)):
            sends = [self._send] * 3
            jump = self._jump_to_and_fro if self.jumps_back else self._jump_ahead
            acts = [*sends, self._see, self._reload, self._leave, self._set_budget, jump]
            self.chance.choice(acts)()

    def _send(self) -> None:
        for _ in range(self.chance.randint(1, 5)):
            self.clock_ns += self.chance.choice([0, 1, NS_PER_S // 100])
            topic, self.number = self.chance.choice(TOPICS), self.number + 1
            payload = b"%d" % self.number
            if not self.sources[topic]:
                continue
            at = Instant(self.clock_ns, self.steady_ns())
            if self.compiled is None or not self.compiled.takes(topic, payload, GIDS[topic], at):
                self.sends(topic, GIDS[topic], payload)

    def decode(self, topic: str, type_name: str, payload: Payload) -> object:
        return SimpleNamespace(data=int(payload[:]) % 4)

    def _see(self) -> None:
        self._poll(self.chance.choice(list(GraphChange)))
        self._check_publishers()

    def _leave(self) -> None:
        topic = self.chance.choice(TOPICS)
        if self.sources[topic]:
            self.leaves(topic, GIDS[topic])
        else:
            self.joins(topic, GIDS[topic])
        self._poll(GraphChange.REPORTED)

    def _reload(self) -> None:
        assert self.run is not None
        self.run.reload(live_rules(self.chance.choice(RELAYED)))
        self._check_publishers()

    def _set_budget(self) -> None:
        assert self.run is not None
        self.run.set_budget(self.chance.choice([1000.0, 2000.0]))

    def _jump_ahead(self) -> None:
        if self.has_jumped:
            # Two jumps between two looks at the clock are one.
            return
        self.has_jumped = True
        self._jump(self.chance.choice([NS_PER_S, 3600 * NS_PER_S]))

    def _jump_to_and_fro(self) -> None:
        self._jump(self.chance.choice([NS_PER_S, 3600 * NS_PER_S, -NS_PER_S, -60 * NS_PER_S]))

    def _jump(self, by_ns: int) -> None:
        self.clock_ns += by_ns
        self.ahead_ns += by_ns

    def _check_publishers(self) -> None:
        """What is relayed is published by what is open, and what is not relayed by nothing."""
        assert self.run is not None
        for topic, relay in {} if self.compiled is None else self.compiled.running.items():
            is_relayed = topic in self.run.rules.output_topics
            assert (relay.publisher in self.advertised) is (is_relayed and not self.is_returned)
            assert (relay.copying.passed is not None) is (is_relayed and self.is_returned)


class Recording(Part):
    """Hears some of the topics, others from time to time; ``told`` is all that it was told."""

    receives_topics_only = True

    def __init__(self, seed: int) -> None:
        self.chance = random.Random(seed)
        self.topics = frozenset(TOPICS[:2])
        self.told: list[tuple[str, str, bytes, int]] = []

    def follow(self, rules: LiveRules, now_ns: int) -> None:
        self.topics = frozenset(topic for topic in TOPICS if self.chance.random() < 0.7)
        self.told.append(("follow", "", b"", now_ns))

    def on_source(self, topic: str, source: LiveSource, now_ns: int) -> None:
        self.told.append(("source", topic, b"", now_ns))

    def on_message(
        self,
        topic: str,
        payload: Payload,
        publisher: Hashable,
        now_ns: int,
        subscription: Subscription | None,
    ) -> None:
        if topic in self.topics:
            assert publisher == GIDS[topic]
            self.told.append(("message", topic, payload[:], now_ns))

    def on_clock_jump(self, ahead_ns: int) -> None:
        self.told.append(("jump", "", b"%d" % ahead_ns, self.told[-1][-1]))

    def on_wake(self, now_ns: int) -> None:
        self.told.append(("wake", "", b"", now_ns))

    def on_trigger(self, trigger: Trigger) -> None:
        self.told.append(("trigger", trigger.block.name or "", b"", trigger.stamp_ns))


def live_rules(relayed: Sequence[str]) -> LiveRules:
    rates = (f"SetFrequency {topic} {'Full' if topic == '/imu' else 0}" for topic in relayed)
    text = "\n".join((*rates, RECORDS))
    return LiveRules(rule_set=rules_of(text), output_topics={topic: f"/testudo{topic}" for topic in relayed})


class Publishing(Part):
    """Wants to know of all that is published; ``told`` is that."""

    def __init__(self) -> None:
        self.told: list[tuple[str, bytes]] = []

    def before_publish(self, relayed: Relayed) -> None:
        self.told.append((relayed.topic, relayed.payload[:]))
        assert relayed.publisher == GIDS[relayed.topic]


@dataclass(frozen=True, kw_only=True)
class Told:
    """What the parts of a run were told, and what was published."""

    recorded: list[tuple[str, str, bytes, int]]
    passed: list[tuple[str, bytes]]
    published: list[tuple[str, bytes]]


def told_by(
    seed: int, acts: int, relays: MemoryRelays | None, *, is_returned: bool, jumps_back: bool = False
) -> Told:
    graph = ActingGraph(seed, acts, is_returned=is_returned, jumps_back=jumps_back)
    part = Recording(seed)
    publishing = Publishing()
    graph.compiled = relays
    inputs = InputRecorder(graph, Settings(), None)
    run = LiveRun(
        graph,
        inputs,
        live_rules(RELAYED[0]),
        LiveDecisions(graph, []),
        parts=[part, publishing][: 1 + is_returned],
    )
    graph.run = run
    run.drive(lambda: graph.acts_left <= 0)
    return Told(recorded=part.told, passed=publishing.told, published=graph.published)


@settings(max_examples=150)
@given(seeds, st.integers(10, 120), st.booleans())
@example(5, 80, True)  # what passes between two inputs begins no recording again
def test_parts_are_told_all_that_they_would_be_told_of_topics_in_python_and_in_that_order(
    seed: int, acts: int, is_returned: bool
) -> None:
    told = told_by(seed, acts, MemoryRelays(), is_returned=is_returned)
    assert told == told_by(seed, acts, None, is_returned=is_returned)
    times_ns = [one[-1] for one in told.recorded]
    assert times_ns == sorted(times_ns)


@settings(max_examples=100)
@given(seeds, st.integers(10, 120), st.booleans())
def test_that_holds_however_the_clock_is_set_to_and_fro(seed: int, acts: int, is_returned: bool) -> None:
    told = told_by(seed, acts, MemoryRelays(), is_returned=is_returned, jumps_back=True)
    assert told == told_by(seed, acts, None, is_returned=is_returned, jumps_back=True)


def test_such_topics_are_relayed_without_python_indeed() -> None:
    relays = MemoryRelays()
    for is_returned in (True, False):
        told = told_by(1, 100, relays, is_returned=is_returned)
        assert told.published
    assert relays.begun > 20
