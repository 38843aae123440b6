# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How a status leaves one process and comes to another."""

from __future__ import annotations

import json
from argparse import Namespace
from dataclasses import replace

import pytest

from robot.memory_link import MemoryLink
from robot.status.statuses import STATUS
from robot.status.virtual_robot import Source, VirtualRobot
from smarttestudo.cli.top import print_once
from smarttestudo.domain.names import STATUS_TOPIC
from smarttestudo.domain.record import to_json
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.robot.ros.graph_robots import GraphRobots
from smarttestudo.robot.status_topics import StatusPublisher

TEXT = json.dumps(to_json(STATUS))
DIAGNOSTICS = "diagnostic_msgs/msg/DiagnosticArray"


def test_a_status_goes_out_as_text_and_as_diagnostics() -> None:
    robot = VirtualRobot(listeners=1)
    StatusPublisher(robot).announce(STATUS)
    ((topic, text),) = robot.texts
    assert (topic, json.loads(text)) == (STATUS_TOPIC, json.loads(TEXT))
    ((node, *_),) = robot.diagnostics
    assert node.name == "smarttestudo"


def test_a_link_gets_the_status_beside_the_graph() -> None:
    robot, link = VirtualRobot(), MemoryLink()
    StatusPublisher(robot, link).announce(STATUS)
    assert (link.told, len(robot.texts)) == ([to_json(STATUS)], 1)


def test_while_nobody_listens_to_diagnostics_none_are_made_and_the_latched_status_still_goes_out() -> None:
    robot = VirtualRobot(listeners=0)
    StatusPublisher(robot).announce(STATUS)
    assert (robot.diagnostics, len(robot.texts)) == ([], 1)


def test_without_diagnostic_msgs_that_is_said_once_and_the_text_still_goes_out() -> None:
    robot = VirtualRobot(missing_types=frozenset({DIAGNOSTICS}))
    announcer = StatusPublisher(robot)
    announcer.announce(STATUS)
    announcer.announce(STATUS)
    assert robot.log_lines == [f"/diagnostics: error: the message type {DIAGNOSTICS} is not installed"]
    assert len(robot.texts) == 2


def test_several_smarttestudos_are_told_apart() -> None:
    both = ("/tb3_0/smarttestudo", "/tb3_1/smarttestudo")
    robot = VirtualRobot(sources={STATUS_TOPIC: Source(nodes=both)})
    watch = GraphRobots(robot, robot.steady_s)
    assert not watch.has_heard_all
    for node in both:
        robot.say(STATUS_TOPIC, json.dumps(to_json(replace(STATUS, node=node))))
        assert watch.has_heard_all == (node == both[-1])
    assert [heard.status.node for heard in watch.heard.values()] == list(both)


def test_what_could_not_be_read_is_said_beside_the_json_of_top(capsys: pytest.CaptureFixture[str]) -> None:
    robot = VirtualRobot(sources={STATUS_TOPIC: Source()})
    robots = GraphRobots(robot, robot.steady_s)
    robot.say(STATUS_TOPIC, TEXT)
    print_once(robots, Namespace(json=True))
    assert capsys.readouterr().err == ""
    robot.say(STATUS_TOPIC, "{}")
    print_once(robots, Namespace(json=True))
    told = capsys.readouterr()
    assert json.loads(told.out)["nodes"].keys() == {"/smarttestudo"}
    assert told.err == "testudo: statuses of another version that could not be read: 1\n"


def test_nodes_of_one_name_are_told_apart_by_the_robots_names() -> None:
    node = "/testudo_receive_7"
    robot = VirtualRobot(sources={STATUS_TOPIC: Source(nodes=(node, node))})
    robots = GraphRobots(robot, robot.steady_s)
    for name in ("ada", "bob"):
        robot.say(STATUS_TOPIC, json.dumps(to_json(replace(STATUS, robot=name))))
        assert robots.has_heard_all == (name == "bob")
    assert robots.heard.keys() == {"ada:/smarttestudo", "bob:/smarttestudo"}


def test_a_robot_behind_a_link_is_not_taken_for_a_node_of_its_name_on_the_graph() -> None:
    robot = VirtualRobot(sources={STATUS_TOPIC: Source(nodes=("/testudo_receive_7",))})
    robots = GraphRobots(robot, robot.steady_s)
    answers: list[object] = []
    robots.set("ada:/smarttestudo", {"rules_text": ""}, answers.append)
    robots.get("ada:/smarttestudo", ["rules_hash"], answers.append)
    assert [str(answer) for answer in answers] == [
        "ada:/smarttestudo: error: it is heard here, but its node is not on this ROS graph; "
        "use --connect with the endpoint where `testudo receive` listens"
    ] * 2


def says(robot: VirtualRobot, run: str, *, node: str = "/smarttestudo", name: str = "") -> None:
    robot.say(STATUS_TOPIC, json.dumps(to_json(replace(STATUS, run=run, node=node, robot=name))))


def test_runs_of_one_name_are_all_shown_and_rules_go_to_none_by_chance() -> None:
    robot = VirtualRobot(sources={STATUS_TOPIC: Source(nodes=("/smarttestudo", "/smarttestudo", "/other"))})
    robots = GraphRobots(robot, robot.steady_s)
    says(robot, "c0ffee00", node="/other")
    for second in range(5):
        for run in ("1a2b3c4d", "5e6f7a8b"):
            robot.elapsed_ns += NS_PER_S // 2
            says(robot, run)
        assert second == 0 or robots.has_heard_all
    both = ["#1a2b:/smarttestudo", "#5e6f:/smarttestudo"]
    assert sorted(robots.heard) == [*both, "/other"]
    assert [robots.heard[one].status.robot_id for one in both] == both
    answers: list[object] = []
    for robot_id in (*both, "/smarttestudo"):
        robots.set(robot_id, {"rules_text": ""}, answers.append)
        robots.get(robot_id, ["rules_hash"], answers.append)
    assert [str(answer).partition(": error: ")[2] for answer in answers] == [
        "2 nodes that are heard here are called /smarttestudo, and any of them may answer; start each with a "
        "name of its own, as with --ros-args -r __node:=smarttestudo_2, or use --connect where a robot is "
        "heard over a link"
    ] * 6
    robots.forget(both[0])
    assert sorted(robots.heard) == ["/other", "/smarttestudo"]


def test_a_robot_of_another_name_whose_node_is_called_alike_gets_no_rules_by_chance() -> None:
    robot = VirtualRobot(sources={STATUS_TOPIC: Source(nodes=("/smarttestudo", "/testudo_receive_7"))})
    robots = GraphRobots(robot, robot.steady_s)
    for name in ("ada", "bob"):
        says(robot, name, name=name)
    answers: list[object] = []
    robots.set("bob:/smarttestudo", {"rules_text": ""}, answers.append)
    assert "any of them may answer" in str(answers[0])


def test_a_run_that_was_started_anew_takes_the_place_of_the_one_before() -> None:
    robot = VirtualRobot(sources={STATUS_TOPIC: Source(nodes=("/smarttestudo",))})
    robots = GraphRobots(robot, robot.steady_s)
    for run in ("1a2b3c4d", "5e6f7a8b", "9c0d1e2f"):
        for _ in range(3):
            robot.elapsed_ns += NS_PER_S // 2
            says(robot, run)
            assert [heard.status.run for heard in robots.heard.values()] == [run]
            assert robots.heard.keys() == {"/smarttestudo"}


def test_what_is_no_status_is_counted_and_the_rest_is_heard() -> None:
    robot = VirtualRobot()
    watch = GraphRobots(robot, robot.steady_s)
    for text in ('{"version": 9}', "hello", TEXT):
        robot.say(STATUS_TOPIC, text)
    assert watch.unreadable == 2
    assert watch.heard["/smarttestudo"].status == STATUS
