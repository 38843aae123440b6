# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Whatever telling fails of is said once, and costs nothing but what was to be told."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import replace
from typing import cast

from loop.loop_driver import rule_set_of
from robot.status.statuses import STATUS
from robot.status.virtual_robot import VirtualRobot
from smarttestudo.domain.decision import AnyDecision, Decision, PlannedRate, Reason
from smarttestudo.domain.names import DECISIONS_TOPIC, STATUS_TOPIC
from smarttestudo.domain.rate import Rate
from smarttestudo.domain.status import TopicStatus
from smarttestudo.loop.inputs import MessageInput, RecordedInput
from smarttestudo.robot.decisions import LiveDecisions
from smarttestudo.robot.input_recorder import InputRecorder
from smarttestudo.robot.live_rules import LiveRules
from smarttestudo.robot.option import Settings
from smarttestudo.robot.status_topics import StatusPublisher

NO_RETURN = Decision(
    t_s=0.5,
    stamp_ns=500_000_000,
    topic="/scan",
    from_rate=Rate(10.0),
    planned=PlannedRate(rate=Rate(4.0), reason=Reason.BLOCK, rule="Far", line=3),
    values={"/scan ranges[0]": math.inf},
)


def broken(_: object) -> None:
    raise ZeroDivisionError("the disk\nis odd")


def test_a_decision_made_by_an_infinite_range_goes_out_with_null() -> None:
    robot = VirtualRobot()
    LiveDecisions(robot, []).report([NO_RETURN])
    ((topic, text),) = robot.texts
    assert topic == DECISIONS_TOPIC
    assert json.loads(text)["values"] == {"/scan ranges[0]": None}


def test_who_fails_to_take_decisions_is_given_no_more_and_all_others_are() -> None:
    robot = VirtualRobot()
    kept: list[AnyDecision] = []

    def keep(decisions: Sequence[AnyDecision]) -> None:
        kept.extend(decisions)

    decisions = LiveDecisions(robot, [broken, keep])
    decisions.report([NO_RETURN])
    decisions.report([NO_RETURN])
    assert len(kept) == len(robot.texts) == 2
    said = [line for line in robot.log_lines if "error" in line]
    assert said == [
        "error: unexpected ZeroDivisionError: the disk is odd; no further decisions are written there"
    ]


def test_a_status_that_cannot_be_told_is_said_once() -> None:
    robot = VirtualRobot(listeners=1)
    announcer = StatusPublisher(robot)
    odd = replace(STATUS, topics={"/odom": cast("TopicStatus", None)})
    announcer.announce(odd)
    announcer.announce(odd)
    assert all("nothing more is published there" in line for line in robot.log_lines)
    assert len(robot.log_lines) == 2, "one for the text, one for the diagnostics"


def test_a_status_with_an_infinite_number_goes_out_with_null() -> None:
    robot = VirtualRobot()
    StatusPublisher(robot).announce(replace(STATUS, cpu_percent=math.inf))
    ((topic, text),) = robot.texts
    assert (topic, json.loads(text)["cpu_percent"]) == (STATUS_TOPIC, None)


def test_inputs_that_cannot_be_recorded_are_said_once_and_the_loop_goes_on() -> None:
    robot = VirtualRobot()
    noted: list[RecordedInput] = []

    def note(given: RecordedInput) -> None:
        noted.append(given)
        broken(given)

    rules = LiveRules(rule_set=rule_set_of("begin SetFrequency /scan 10 end"), output_topics={})
    recorder = InputRecorder(robot, Settings(), note)
    loop = recorder.loop(rules, 0)
    for at_ns in (0, 100_000_000):
        given = MessageInput(at_ns, "/scan", b"", 100)
        recorder.record(given, rules)
        assert len(loop.handle(given)) == 1
    assert len(noted) == len(robot.log_lines) == 1
    assert robot.log_lines[0].endswith("no further inputs are recorded")
