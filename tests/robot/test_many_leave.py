# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Many topics of one run within a budget, whose operators or publishers come or go at once."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from incidents.incident_runs import rules_of
from robot.small_graph import SmallGraph
from smarttestudo.domain.robot import GraphChange, PollGraph
from smarttestudo.domain.units import NS_PER_MS, NS_PER_S
from smarttestudo.robot.decisions import LiveDecisions
from smarttestudo.robot.input_recorder import InputRecorder
from smarttestudo.robot.live_rules import LiveRules
from smarttestudo.robot.live_run import LiveRun
from smarttestudo.robot.option import Settings
from smarttestudo.robot.run_options import BUDGET

TOPICS = [f"/camera{number}" for number in range(40)]
PERIOD_NS = 100 * NS_PER_MS
PAYLOAD = bytes(1000)


class CamerasGraph(SmallGraph):
    """Each wait is a tenth of a second, in which each source says something, and the graph is polled."""

    def poll_graph(self, poll: PollGraph) -> None:
        self._poll = poll

    def now_ns(self) -> int:
        return self.time_ns

    def wait(self, wake_ns: int | None, longest_s: float) -> None:
        self.time_ns += PERIOD_NS
        self._poll(GraphChange.REPORTED)
        for topic in TOPICS:
            if self.sources[topic]:
                self.sends(topic, topic.encode(), PAYLOAD)


def operators_leave(graph: CamerasGraph) -> None:
    graph.operators.clear()


def a_node_leaves(graph: CamerasGraph) -> None:
    for topic in TOPICS:
        graph.leaves(topic, topic.encode())


@pytest.mark.parametrize("leave", [operators_leave, a_node_leaves])
def test_each_of_many_topics_that_are_left_at_once_is_decided_once(
    leave: Callable[[CamerasGraph], None],
) -> None:
    graph = CamerasGraph()
    for topic in TOPICS:
        graph.joins(topic, topic.encode())
        graph.listens(f"/testudo{topic}")
    text = " ".join(f"SetFrequency {topic} Full" for topic in TOPICS)
    rules = LiveRules(rule_set=rules_of(text), output_topics={topic: f"/testudo{topic}" for topic in TOPICS})
    inputs = InputRecorder(graph, Settings([BUDGET], {BUDGET.key: 200.0}), None)
    run = LiveRun(graph, inputs, rules, LiveDecisions(graph, []))

    run.drive(lambda: graph.time_ns > 3 * NS_PER_S)
    cut = {topic: planned.rate.hz for topic, planned in run.loop.knowledge.plan.items()}
    assert sum(cut.values()) == pytest.approx(200, rel=0.05), "1 KB each"
    leave(graph)
    graph.lines.clear()
    run.drive(lambda: graph.time_ns > 4 * NS_PER_S)
    decided = [line.partition(":")[0] for line in graph.lines if "→" in line]
    assert sorted(decided) == sorted(TOPICS)
