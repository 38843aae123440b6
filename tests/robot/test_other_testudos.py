# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Other SmartTestudo nodes on the robot's graph, known and not known yet."""

from __future__ import annotations

import pytest

from robot.small_graph import SmallGraph
from robot.test_live_topics import DRIVER, OTHER, Live, lines_with
from smarttestudo.domain.names import STATUS_TOPIC
from smarttestudo.domain.robot import UNKNOWN_NODE, receiving_node
from smarttestudo.robot.fallback import FallbackTopics
from smarttestudo.robot.output_topics import OutputTopic

RECEIVES = f"/{receiving_node(7)}"


def test_what_another_smarttestudo_sends_on_a_topic_of_the_robot_is_not_relayed() -> None:
    graph = SmallGraph()
    live = Live(graph, "/imu")
    graph.listens("/testudo/imu")
    graph.joins("/imu", DRIVER)
    graph.joins("/imu", OTHER, node="/second_testudo")
    graph.joins(STATUS_TOPIC, b"d", node="/second_testudo")
    live.looks()
    graph.sends("/imu", OTHER, b"relayed before")
    graph.sends("/imu", DRIVER, b"measured")
    assert graph.published == [("/testudo/imu", b"measured")]


def test_nobody_is_warned_of_endpoints_whose_node_is_not_discovered_yet() -> None:
    graph, unknown = SmallGraph(), f"_NODE_NAMESPACE_UNKNOWN_{UNKNOWN_NODE}"
    live = Live(graph, "/imu")
    graph.listens("/testudo/imu")
    graph.joins("/imu", DRIVER, node=unknown)
    graph.joins(STATUS_TOPIC, OTHER, node=unknown)
    live.looks(1)
    assert lines_with(graph, "SmartTestudo") == []
    for topic, gid, node in (("/imu", DRIVER, "/driver"), (STATUS_TOPIC, OTHER, "/other_testudo")):
        graph.leaves(topic, gid)
        graph.joins(topic, gid, node=node)
    live.looks()
    graph.sends("/imu", DRIVER, b"measured")
    assert graph.published == [("/testudo/imu", b"measured")]
    assert lines_with(graph, "SmartTestudo") == []


class FedGraph(SmallGraph):
    """An operator's end publishes here what this robot sends."""

    fed_nodes = frozenset({RECEIVES})


@pytest.mark.parametrize("identifies_publishers", [True, False])
def test_what_an_operators_end_publishes_here_of_this_robot_is_not_relayed_again(
    identifies_publishers: bool,
) -> None:
    graph = FedGraph(identifies_publishers=identifies_publishers)
    live = Live(graph, "/imu", "/op/imu")
    for topic in ("/testudo/imu", "/testudo/op/imu"):
        graph.listens(topic)
    graph.joins("/imu", DRIVER)
    graph.joins("/op/imu", OTHER, node=RECEIVES)
    live.looks()
    graph.sends("/imu", DRIVER, b"measured")
    assert graph.published == [("/testudo/imu", b"measured")]
    assert graph.subscribed() == {"/imu"}
    assert lines_with(graph, "/op/imu: only SmartTestudo nodes publish it")


def test_it_is_no_topic_to_relay_without_rules_either() -> None:
    graph = FedGraph()
    graph.joins("/imu", DRIVER)
    graph.joins("/op/imu", OTHER, node=RECEIVES)
    fallback = FallbackTopics(graph, output_topic=OutputTopic(), topic_prefix="")
    assert fallback.poll()
    assert fallback.rules().output_topics == {"/imu": "/testudo/imu"}


def test_it_is_given_up_again_if_its_node_was_discovered_late() -> None:
    graph, unknown = FedGraph(), f"_NODE_NAMESPACE_UNKNOWN_{UNKNOWN_NODE}"
    graph.joins("/imu", DRIVER, node=unknown)
    graph.joins("/op/imu", OTHER, node=unknown)
    fallback = FallbackTopics(graph, output_topic=OutputTopic(), topic_prefix="")
    assert fallback.poll()
    for topic, gid, node in (("/imu", DRIVER, "/driver"), ("/op/imu", OTHER, RECEIVES)):
        graph.leaves(topic, gid)
        graph.joins(topic, gid, node=node)
    assert fallback.poll()
    assert fallback.rules().output_topics == {"/imu": "/testudo/imu"}
    assert not fallback.poll()


def test_where_publishers_are_told_apart_only_the_robots_own_messages_are_relayed() -> None:
    graph = FedGraph()
    live = Live(graph, "/imu")
    graph.listens("/testudo/imu")
    graph.joins("/imu", DRIVER)
    graph.joins("/imu", OTHER, node=RECEIVES)
    live.looks()
    graph.sends("/imu", OTHER, b"relayed before")
    graph.sends("/imu", DRIVER, b"measured")
    assert graph.published == [("/testudo/imu", b"measured")]


def test_where_they_are_not_told_apart_the_topic_waits_until_that_one_is_gone() -> None:
    graph = FedGraph(identifies_publishers=False)
    live = Live(graph, "/imu")
    graph.listens("/testudo/imu")
    graph.joins("/imu", DRIVER)
    graph.joins("/imu", OTHER, node=RECEIVES)
    for _ in range(2):
        live.looks()
        graph.operators.clear()
        live.looks()
        graph.listens("/testudo/imu")
    assert (graph.subscribed(), live.known["/imu"].link().problem is None) == (set(), False)
    assert len(lines_with(graph, "/imu: error: what is sent of it is published here again")) == 1
    graph.leaves("/imu", OTHER)
    live.looks()
    graph.sends("/imu", DRIVER, b"measured")
    assert graph.published == [("/testudo/imu", b"measured")]


@pytest.mark.parametrize("topic", ["/diagnostics", "/rosout", "/parameter_events"])
def test_that_a_run_publishes_what_each_does_is_nothing_to_warn_of(topic: str) -> None:
    graph = SmallGraph()
    live = Live(graph, topic)
    graph.listens(f"/testudo{topic}")
    graph.joins(topic, OTHER, node=graph.name)
    live.looks()
    graph.joins(topic, DRIVER)
    live.looks()
    graph.sends(topic, OTHER, b"its own")
    graph.sends(topic, DRIVER, b"of another node")
    assert graph.published == [(f"/testudo{topic}", b"of another node")]
    assert lines_with(graph, "SmartTestudo") == []
