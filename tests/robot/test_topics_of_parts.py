# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Topics that are heard because of a part of a run, for as long as that asks for them."""

from __future__ import annotations

from incidents.incident_runs import rules_of
from robot.small_graph import SmallGraph
from smarttestudo.domain.robot import GraphChange, PollGraph
from smarttestudo.language.parser import parse
from smarttestudo.language.rule_set import compile_rules
from smarttestudo.robot.decisions import LiveDecisions
from smarttestudo.robot.input_recorder import InputRecorder
from smarttestudo.robot.live_rules import LiveRules
from smarttestudo.robot.live_run import LiveRun
from smarttestudo.robot.option import Settings
from smarttestudo.robot.part import Part


class PollingGraph(SmallGraph):
    """One that is looked at whenever the run waits."""

    def poll_graph(self, poll: PollGraph) -> None:
        self._poll = poll

    def wait(self, wake_ns: int | None, longest_s: float) -> None:
        self._poll(GraphChange.REPORTED)


class Listening(Part):
    """Hears a topic until it was woken three times; ``seen`` is what was subscribed to at each time."""

    topics = frozenset({"/scan"})

    def __init__(self, graph: SmallGraph) -> None:
        self.graph = graph
        self.seen: list[set[str]] = []

    def on_wake(self, now_ns: int) -> None:
        self.seen.append(self.graph.subscribed())
        if len(self.seen) == 3:
            self.topics = frozenset()


def test_a_topic_is_no_longer_subscribed_to_once_no_part_asks_for_it() -> None:
    graph = PollingGraph()
    graph.joins("/scan", b"driver")
    part = Listening(graph)
    rules = LiveRules(rule_set=rules_of("SetFrequency /odom 10"), output_topics={"/odom": "/testudo/odom"})
    run = LiveRun(
        graph, InputRecorder(graph, Settings(), None), rules, LiveDecisions(graph, []), parts=[part]
    )
    run.drive(lambda: len(part.seen) >= 5)
    assert part.seen == [{"/scan"}] * 3 + [set()] * 2


def test_the_machine_and_the_link_are_no_topics() -> None:
    graph = PollingGraph()
    graph.joins("/scan", b"driver")
    text = (
        "begin SetFrequency /scan 5 If (CheckValue @machine cpu > 90 AND CheckValue @link age > 3) "
        'Then Record "busy" Before 1 s After 1 s EndIf end'
    )
    parsed = parse(text, "rules.adirf")
    assert not parsed.findings
    rule_set = compile_rules([parsed.file], lambda name: f"/robot{name}")
    assert {signal.topic for signal in rule_set.signals} == {"@machine", "@link"}
    assert rule_set.relayed == ("/robot/scan",)
    assert rule_set.recorded == {"/robot/scan"}
    rules = LiveRules(rule_set=rule_set, output_topics={"/robot/scan": "/testudo/scan"})
    run = LiveRun(graph, InputRecorder(graph, Settings(), None), rules, LiveDecisions(graph, []))
    assert run.topics.keys() == {"/robot/scan"}
