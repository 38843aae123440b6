# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A robot of an older version beside today's tools.

``older/status-1daef1d.json`` is what ``testudo run`` of commit 1daef1d published on ``/testudo/status`` of a
ROS graph: 19 s after its start, under a budget, with two rules; one held while the other was unknown.
"""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest

from robot.status.virtual_robot import VirtualRobot
from smarttestudo.cli.top_table import Line, SortKey, Style, summary_lines, topic_lines
from smarttestudo.domain.decision import Reason
from smarttestudo.domain.names import STATUS_TOPIC
from smarttestudo.domain.record import to_json
from smarttestudo.domain.signal import Truth
from smarttestudo.domain.status import RulesOrigin, Silence, status_from_text
from smarttestudo.robot.ros.graph_robots import GraphRobots
from smarttestudo.ruler.job import answer_json
from smarttestudo.ruler.robots.view import Live, live_model, robot_summaries
from smarttestudo.ruler.robots.watch import RobotWatch

TEXT = (Path(__file__).parent / "older" / "status-1daef1d.json").read_text(encoding="utf-8")
STATUS = status_from_text(TEXT)


@pytest.fixture(scope="module")
def live() -> Live:
    """What the Ruler's page is told once the robot has spoken."""
    robot = VirtualRobot()
    watch = RobotWatch(GraphRobots(robot, robot.steady_s), robot.steady_s)
    robot.say(STATUS_TOPIC, TEXT)
    [seen] = watch.poll()
    [summary] = robot_summaries(watch.seen.values(), robot.steady_s())
    assert (summary.node, summary.is_heard, summary.topics) == ("/smarttestudo", True, 5)
    assert (summary.rules.origin, summary.rules.paths) == (RulesOrigin.FILES, ("warehouse.adirf",))
    return live_model(seen)


def test_nothing_that_it_said_is_lost() -> None:
    assert to_json(STATUS) == json.loads(TEXT)


def test_its_words_mean_what_they_meant() -> None:
    odom, estop = STATUS.topics["/odom"], STATUS.topics["/estop"]
    assert (odom.target_hz, odom.reason, odom.rule) == (4, Reason.BLOCK, "Far from the dock")
    assert (odom.counts.received - odom.counts.relayed, odom.frames) == (odom.counts.dropped, None)
    assert (estop.target_hz, estop.reason, estop.silence) == (math.inf, Reason.UNKNOWN, Silence.NO_PUBLISHER)
    assert STATUS.topics["/cmd_vel"].silence is Silence.OFF
    assert [block.state for block in STATUS.blocks] == [Truth.TRUE, Truth.UNKNOWN]
    assert not STATUS.is_fallback


def test_the_page_shows_its_rates_rules_and_checks(live: Live) -> None:
    shown = json.loads(answer_json(live))
    status, topics = shown["status"], shown["status"]["topics"]
    targets_hz = [topics[topic]["target_hz"] for topic in ("/odom", "/estop", "/cmd_vel")]
    assert targets_hz == [4, None, 0]
    assert topics["/imu"]["actual_hz"] == pytest.approx(5, rel=0.01)
    assert topics["/imu"]["silent"] == "no subscriber"
    assert (topics["/odom"]["rule"], topics["/odom"]["line"]) == ("Far from the dock", 8)
    assert (status["budget_kb_per_s"], status["rules"]["origin"]) == (20, "files")
    assert [(block["line"], block["state"]) for block in status["blocks"]] == [(8, "true"), (15, "unknown")]
    checks = [(line, *read) for block in status["blocks"] for line, _, *read in block["checks"]]
    assert checks == [
        (9, "true", 5.25),
        (9, "true", pytest.approx(60, rel=0.01)),
        (16, "unknown", None),
    ]


def test_top_shows_its_rates_and_why() -> None:
    heading, link, absent, unknown = summary_lines(STATUS)
    assert absent == Line("no publisher: /estop, /tf", Style.WARN)
    assert unknown == Line("rules in doubt: 1 of 2 conditions, as a value is not known", Style.WARN)
    assert heading.text.startswith("/smarttestudo   warehouse.adirf   up 0:00:19")
    assert (link.style, link.text.endswith("of 20.0 (22 %)")) == (Style.PLAIN, True)
    lines = {line.text.split()[0]: line for line in topic_lines(STATUS, SortKey.TOPIC)[3:]}
    assert lines["/odom"].text.split()[1:4] == ["30.00", "4.00", "4.00"]
    assert lines["/odom"].text.endswith("Far from the dock")
    assert "Full" in lines["/estop"].text
    assert "no publisher" in lines["/estop"].text
    assert lines["/cmd_vel"].style is lines["/imu"].style is Style.QUIET
