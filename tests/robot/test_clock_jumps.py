# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A robot's clock that is set while a run goes on: no rule holds for that, and no rate is wrong after it."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from incidents.incident_runs import AMPLE_BYTES, KeepingSink, rules_of
from robot.small_graph import SmallGraph
from robot.test_copied_topics import MemoryRelays
from smarttestudo.domain.decision import Decision, Reason, about_rates
from smarttestudo.domain.robot import Endpoint, GraphChange, Instant, Payload, PollGraph, Subscription
from smarttestudo.domain.status import RuntimeStatus
from smarttestudo.domain.units import NS_PER_MS, NS_PER_S
from smarttestudo.incidents.recorder import IncidentRecorder
from smarttestudo.loop.step import Trigger
from smarttestudo.robot.clock_jumps import LEAST_NS, ClockJumps
from smarttestudo.robot.decisions import LiveDecisions
from smarttestudo.robot.input_recorder import InputRecorder
from smarttestudo.robot.live_rules import LiveRules
from smarttestudo.robot.live_run import LiveRun
from smarttestudo.robot.option import Settings
from smarttestudo.robot.part import Part
from smarttestudo.robot.source import LiveSource

YEARS_NS = 50 * 365 * 86_400 * NS_PER_S
RULES = "SetFrequency /scan 5 If (CheckValue /arm age > 60) Then SetFrequency /scan Full EndIf"


class SetClock(SmallGraph):
    """A robot that publishes 20 times a second, and whose clock is set by ``jump_ns`` after 15 s."""

    def __init__(self, jump_ns: int, *, is_time_simulated: bool = False) -> None:
        super().__init__()
        self.jump_ns, self.is_time_simulated = jump_ns, is_time_simulated
        self.time_ns = 2 * YEARS_NS
        self.passed_ns = 0
        self.acts: list[Callable[[], float | None]] = []
        self.warnings: list[str] = []
        self.joins("/scan", b"driver")
        self.joins("/arm", b"silent")
        self.listens("/testudo/scan")

    def now_ns(self) -> int:
        return self.time_ns + self.passed_ns + (self.jump_ns if self.passed_ns >= 15 * NS_PER_S else 0)

    def steady_ns(self) -> int:
        return self.passed_ns

    def warning(self, message: str) -> None:
        self.warnings.append(message)

    def poll_graph(self, poll: PollGraph) -> None:
        self.acts.append(lambda: poll(GraphChange.REPORTED))

    def every(self, period_s: float, act: Callable[[], float | None]) -> None:
        self.acts.append(act)

    def wait(self, wake_ns: int | None, longest_s: float) -> None:
        self.passed_ns += 50 * NS_PER_MS
        self.sends("/scan", b"driver", b"scan")
        if self.passed_ns % NS_PER_S == 0:
            for act in self.acts:
                act()


class Watching(Part):
    def __init__(self) -> None:
        self.statuses: list[RuntimeStatus] = []
        self.decisions: list[Decision] = []

    def on_status(self, status: RuntimeStatus) -> None:
        self.statuses.append(status)


def driven(graph: SetClock, *, seconds: int = 30) -> Watching:
    part = Watching()
    rules = LiveRules(rule_set=rules_of(RULES), output_topics={"/scan": "/testudo/scan"})
    decisions = LiveDecisions(graph, [lambda some: part.decisions.extend(about_rates(some))])
    run = LiveRun(graph, InputRecorder(graph, Settings(), None), rules, decisions, parts=[part])
    run.drive(lambda: graph.passed_ns >= seconds * NS_PER_S)
    return part


@pytest.mark.parametrize(
    ("jump_ns", "said"),
    [
        (YEARS_NS, "the clock jumped ahead by 1576800000.0 s: rules and rates leave that out"),
        (3 * NS_PER_S, "the clock jumped ahead by 3.0 s: rules and rates leave that out"),
        (-YEARS_NS, "the clock was set back by 1576800000.0 s: rules and rates go on from there"),
    ],
)
def test_a_clock_that_is_set_changes_no_rate_and_is_said(jump_ns: int, said: str) -> None:
    graph = SetClock(jump_ns)
    part = driven(graph)
    assert [one.planned.reason for one in part.decisions] == [Reason.DEFAULT]
    shown = [one.topics["/scan"] for one in part.statuses][12:]
    sources_hz = [one.source_hz for one in shown if one.source_hz is not None]
    assert len(sources_hz) >= len(shown) - 2
    assert sources_hz == pytest.approx([20] * len(sources_hz), rel=0.06)
    # The topic is found after half a second; a grid that begins anew lets a message or two more pass.
    assert len(graph.published) == pytest.approx(5 * 29.5, abs=3)
    assert shown[-1].actual_hz == pytest.approx(5, rel=0.06)
    assert graph.warnings == [said]


def test_simulated_time_goes_as_fast_as_it_likes() -> None:
    graph = SetClock(3600 * NS_PER_S, is_time_simulated=True)
    part = driven(graph)
    assert [one.planned.reason for one in part.decisions] == [Reason.DEFAULT, Reason.BLOCK]
    assert graph.warnings == []


@pytest.mark.parametrize(("jump_ns", "is_far"), [(LEAST_NS, False), (LEAST_NS + 1, True)])
@pytest.mark.parametrize("sign", [1, -1])
def test_little_more_or_less_than_what_passed_is_no_jump(jump_ns: int, sign: int, *, is_far: bool) -> None:
    graph = SetClock(0)
    jumps = ClockJumps(graph)
    graph.passed_ns += NS_PER_S
    graph.time_ns += sign * jump_ns
    assert jumps.follow(jumps.read()) == (sign * jump_ns if is_far else 0)
    assert len(graph.warnings) == is_far
    graph.passed_ns += NS_PER_S
    assert jumps.follow(jumps.read()) == 0


class SlowGraph(SetClock):
    """A graph that takes 0.8 s to look at, as where 500 topics appear at once; a clock takes 1 µs."""

    def now_ns(self) -> int:
        self.passed_ns += 1000
        return super().now_ns()

    def publishers(self, topic: str) -> Sequence[Endpoint]:
        self.passed_ns += 800 * NS_PER_MS
        return super().publishers(topic)

    def wait(self, wake_ns: int | None, longest_s: float) -> None:
        self.passed_ns += 600 * NS_PER_MS
        for act in self.acts:
            act()


def test_a_poll_that_takes_long_sets_no_clock_back() -> None:
    graph = SlowGraph(0)
    driven(graph, seconds=5)
    assert graph.warnings == []


class Recording(Part):
    """Records what rules say, as incidents do, but keeps it."""

    receives_topics_only = True
    topics = frozenset({"/scan", "/go"})

    def __init__(self, graph: JumpingClock) -> None:
        self.graph = graph
        self.sink = KeepingSink()
        self.begun_ns: list[list[int]] = []

    def follow(self, rules: LiveRules, now_ns: int) -> None:
        self.recorder = IncidentRecorder(rules.rule_set, self.sink, AMPLE_BYTES, now_ns)

    def on_trigger(self, trigger: Trigger) -> None:
        known = [len(one.stamps_ns) for one in self.sink.kept]
        self.recorder.begin(trigger)
        if len(self.sink.kept) > len(known):
            self.begun_ns.append([])
        moments = [len(one.stamps_ns) for one in self.sink.kept]
        (place,) = (place for place, count in enumerate(moments) if count != [*known, 0][place])
        self.begun_ns[place].append(self.graph.passed_ns)

    def on_source(self, topic: str, source: LiveSource, now_ns: int) -> None:
        self.recorder.on_subscribed(topic, now_ns, transient_local=False)

    def on_message(
        self,
        topic: str,
        payload: Payload,
        publisher: Hashable,
        now_ns: int,
        subscription: Subscription | None,
    ) -> None:
        self.recorder.on_message(topic, now_ns, payload[:], publisher)

    @property
    def wake_ns(self) -> int | None:
        return self.recorder.next_wake_ns

    def on_wake(self, now_ns: int) -> None:
        self.recorder.advance(now_ns)

    def on_clock_jump(self, ahead_ns: int) -> None:
        self.recorder.time.leave_out(ahead_ns)


class JumpingClock(SetClock):
    """One whose clock is set at random moments, also while messages wait in copies that compiled relays made.

    ``/scan`` comes each 10 ms, ``/go`` seldom; a payload is when it was sent, by a clock that never jumps.
    """

    def __init__(self, seed: int, *, is_time_simulated: bool) -> None:
        super().__init__(0, is_time_simulated=is_time_simulated)
        self.chance = Random(seed)
        self.set_ns = 0
        self.small_ns = 0
        self.compiled = None if is_time_simulated else MemoryRelays()  # type: ignore[assignment]
        self.joins("/go", b"operator")

    def now_ns(self) -> int:
        return self.time_ns + self.passed_ns + self.set_ns

    def poll_graph(self, poll: PollGraph) -> None:
        self.every(1, lambda: poll(GraphChange.REPORTED))

    def wait(self, wake_ns: int | None, longest_s: float) -> None:
        for _ in range(self.chance.randint(1, 20)):
            self.passed_ns += 10 * NS_PER_MS
            payload = self.passed_ns.to_bytes(8, "little")
            relays = self.compiled
            at = Instant(self.now_ns(), self.steady_ns())
            if relays is None or not relays.takes("/scan", payload, b"driver", at):
                self.sends("/scan", b"driver", payload)
            if self.chance.random() < 0.005:
                self.sends("/go", b"operator", b"")
            if self.chance.random() < 0.01:
                self._jump()
            if self.passed_ns % NS_PER_S == 0:
                for act in self.acts:
                    act()

    def _jump(self) -> None:
        by_ns = round(NS_PER_S * 10 ** self.chance.uniform(-2, 9))
        # Simulated time begins anew or rests; it may be as fast as it likes.
        if self.is_time_simulated or self.chance.random() < 0.5:
            by_ns = -min(by_ns, self.now_ns() - 1)
        self.set_ns += by_ns
        if abs(by_ns) <= LEAST_NS:
            self.small_ns += abs(by_ns)


RECORDING = (
    'If (CheckValue /go age < 0.2) Then Record "go" /scan Before 1 s After 2 s SetFrequency /scan Full EndIf'
)


@settings(max_examples=40)
@given(st.integers(0, 2**32), st.booleans())
def test_an_incident_has_its_whole_window_however_the_clock_jumps(seed: int, is_time_simulated: bool) -> None:
    graph = JumpingClock(seed, is_time_simulated=is_time_simulated)
    part = Recording(graph)
    rules = LiveRules(rule_set=rules_of(RECORDING), output_topics={"/scan": "/testudo/scan"})
    run = LiveRun(
        graph, InputRecorder(graph, Settings(), None), rules, LiveDecisions(graph, []), parts=[part]
    )
    run.drive(lambda: graph.passed_ns >= 40 * NS_PER_S)
    for kept, begun_ns in zip(part.sink.kept, part.begun_ns, strict=True):
        if kept.missing is None:
            continue
        came_ns = {int.from_bytes(one.payload, "little") for one in kept.messages}
        small_ns = graph.small_ns
        from_ns, to_ns = begun_ns[0] - NS_PER_S + small_ns, begun_ns[-1] + 2 * NS_PER_S - small_ns
        expected_ns = {
            at_ns for at_ns in range(0, to_ns, 10 * NS_PER_MS) if at_ns >= max(from_ns, 10 * NS_PER_S)
        }
        assert kept.missing or expected_ns <= came_ns
