# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Other SmartTestudo nodes on the robot's graph, known and not known yet."""

from __future__ import annotations

from robot.small_graph import SmallGraph
from robot.test_live_topics import DRIVER, OTHER, Live, lines_with
from smarttestudo.domain.names import DECISIONS_TOPIC
from smarttestudo.robot.topics import UNKNOWN_NODE


def test_what_another_smarttestudo_sends_on_a_topic_of_the_robot_is_not_relayed() -> None:
    graph = SmallGraph()
    live = Live(graph, "/imu")
    graph.listens("/testudo/imu")
    graph.joins("/imu", DRIVER)
    graph.joins("/imu", OTHER, node="/second_testudo")
    graph.joins("/testudo/decisions", b"d", node="/second_testudo")
    live.looks()
    graph.sends("/imu", OTHER, b"relayed before")
    graph.sends("/imu", DRIVER, b"measured")
    assert graph.published == [("/testudo/imu", b"measured")]


def test_nobody_is_warned_of_endpoints_whose_node_is_not_discovered_yet() -> None:
    graph, unknown = SmallGraph(), f"_NODE_NAMESPACE_UNKNOWN_{UNKNOWN_NODE}"
    live = Live(graph, "/imu")
    graph.listens("/testudo/imu")
    graph.joins("/imu", DRIVER, node=unknown)
    graph.joins(DECISIONS_TOPIC, OTHER, node=unknown)
    live.looks(1)
    assert lines_with(graph, "SmartTestudo") == []
    for topic, gid, node in (("/imu", DRIVER, "/driver"), (DECISIONS_TOPIC, OTHER, "/other_testudo")):
        graph.leaves(topic, gid)
        graph.joins(topic, gid, node=node)
    live.looks()
    graph.sends("/imu", DRIVER, b"measured")
    assert graph.published == [("/testudo/imu", b"measured")]
    assert lines_with(graph, "SmartTestudo") == []
