# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A robot's clock that is set while a run goes on: no rule holds for that, and no rate is wrong after it."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from incidents.incident_runs import rules_of
from robot.small_graph import SmallGraph
from smarttestudo.domain.decision import Decision, Reason
from smarttestudo.domain.robot import GraphChange, PollGraph
from smarttestudo.domain.status import RuntimeStatus
from smarttestudo.domain.units import NS_PER_MS, NS_PER_S
from smarttestudo.robot.clock_jumps import LEAST_NS, ClockJumps
from smarttestudo.robot.decisions import LiveDecisions
from smarttestudo.robot.input_recorder import InputRecorder
from smarttestudo.robot.live_rules import LiveRules
from smarttestudo.robot.live_run import LiveRun
from smarttestudo.robot.option import Settings
from smarttestudo.robot.part import Part

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
        self.acts.append(lambda: poll(GraphChange.TOLD))

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


def driven(graph: SetClock) -> Watching:
    part = Watching()
    rules = LiveRules(rule_set=rules_of(RULES), output_topics={"/scan": "/testudo/scan"})
    decisions = LiveDecisions(graph, [part.decisions.extend])
    run = LiveRun(graph, InputRecorder(graph, Settings(), None), rules, decisions, parts=[part])
    run.drive(lambda: graph.passed_ns >= 30 * NS_PER_S)
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
    # A grid that begins anew lets a message or two more pass.
    assert len(graph.published) == pytest.approx(5 * 30, abs=3)
    assert shown[-1].actual_hz == pytest.approx(5, rel=0.06)
    assert graph.warnings == [said]


def test_simulated_time_goes_as_fast_as_it_likes() -> None:
    graph = SetClock(3600 * NS_PER_S, is_time_simulated=True)
    part = driven(graph)
    assert [one.planned.reason for one in part.decisions] == [Reason.DEFAULT, Reason.BLOCK]
    assert graph.warnings == []


@pytest.mark.parametrize(("jump_ns", "is_far"), [(LEAST_NS, False), (LEAST_NS + 1, True)])
def test_half_a_second_more_than_what_passed_is_no_jump(jump_ns: int, *, is_far: bool) -> None:
    graph = SetClock(0)
    jumps = ClockJumps(graph)
    graph.passed_ns += NS_PER_S
    assert jumps.ahead_ns(graph.now_ns() + jump_ns) == (jump_ns if is_far else 0)
    assert len(graph.warnings) == is_far
