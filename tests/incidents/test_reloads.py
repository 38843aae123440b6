# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Incidents of a robot whose rules are exchanged while it runs."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from incidents.folder_runs import record_of
from incidents.incident_runs import recorder_for, rules_of, trigger
from robot.status.virtual_robot import SECOND, VirtualRobot
from smarttestudo.domain.incident import MissingReason
from smarttestudo.domain.robot import Qos
from smarttestudo.incidents.live_incidents import LiveIncidents
from smarttestudo.incidents.missing import unsubscribed
from smarttestudo.incidents.part_kinds import (
    INCIDENT_MEMORY,
    INCIDENT_RING,
    INCIDENT_RING_MAX,
    INCIDENTS,
    INCIDENTS_MAX,
)
from smarttestudo.language.rule_set import RuleSet
from smarttestudo.robot.live_rules import LiveRules
from smarttestudo.robot.option import Settings
from smarttestudo.robot.part import PartContext
from smarttestudo.robot.source import LiveSource

OPTIONS = (INCIDENTS, INCIDENT_MEMORY, INCIDENT_RING, INCIDENT_RING_MAX, INCIDENTS_MAX)
TEXT = "std_msgs/msg/String"


def rules(record: str, defaults: str = "SetFrequency /map Full SetFrequency /scan 5") -> RuleSet:
    return rules_of(
        f"SetFrequency /odom 10 {defaults}\n"
        f"If CheckValue /odom speed > 1 Then SetFrequency /odom 20 {record} EndIf"
    )


class Robot(VirtualRobot):
    def definition(self, type_name: str) -> str:
        return "string data"


class Run:
    """A live run's part for incidents, at ten messages a second of each topic that the run hears."""

    def __init__(self, folder: Path, rule_set: RuleSet) -> None:
        self.folder = folder
        self.robot = Robot(sources={})
        settings = Settings(OPTIONS, {option.key: option.default for option in OPTIONS})
        context = PartContext(robot=self.robot, settings=settings, resolve=lambda topic: topic)
        self.part = LiveIncidents(context, folder)
        self.follow(rule_set)

    def follow(self, rule_set: RuleSet) -> None:
        self.rule_set = rule_set
        self.part.follow(LiveRules(rule_set=rule_set, output_topics={}), self.robot.now_ns())

    def hear(self, topic: str, type_name: str = TEXT, *, transient_local: bool = False) -> None:
        qos = Qos(reliable=True, transient_local=transient_local, depth=5)
        self.part.on_source(
            topic, LiveSource(type_name=type_name, publishers=1, qos=qos), self.robot.now_ns()
        )

    def send(self, topic: str, payload: bytes = b"text") -> None:
        self.part.on_message(topic, payload, None, self.robot.now_ns(), None)

    def pass_time(self, tenths: int, *topics: str) -> None:
        for _ in range(tenths):
            self.robot.elapsed_ns += SECOND // 10
            for topic in topics:
                self.send(topic)
            self.part.on_wake(self.robot.now_ns())

    def trigger(self) -> None:
        self.part.on_trigger(trigger(self.rule_set, self.robot.now_ns()))

    def record(self) -> dict[str, Any]:
        """The record of the only incident, which is over."""
        (folder,) = self.folder.glob("[!.]*")
        return record_of(folder)


def test_a_window_keeps_its_topics_though_other_rules_no_longer_record_them(tmp_path: Path) -> None:
    run = Run(tmp_path, rules('Record "far" /odom /scan Before 1 s After 5 s'))
    run.hear("/map", transient_local=True)
    with run.part.running():
        for topic in ("/odom", "/scan"):
            run.hear(topic)
        run.pass_time(20, "/odom", "/scan")
        run.trigger()
        run.pass_time(10, "/odom", "/scan")
        run.follow(rules('Record "far" /odom Before 1 s After 5 s', defaults=""))
        assert run.part.topics == {"/odom", "/scan", "/map", "/tf_static"}
        run.pass_time(39, "/odom", "/scan")
        run.send("/map")
        run.pass_time(30, "/odom", "/scan")
        assert run.part.topics == {"/odom", "/tf_static"}
    record = run.record()
    assert {topic: one["messages"] for topic, one in record["topics"].items()} == {
        "/odom": 61,
        "/scan": 61,
        "/map": 1,
    }
    assert record["missing"] == []


def test_what_is_lost_of_a_topic_that_only_an_open_window_keeps_is_missing() -> None:
    before = rules('Record "far" /odom /scan Before 1 s After 5 s')
    recorder, sink = recorder_for(before)
    recorder.begin(trigger(before, 10 * SECOND))
    recorder.change_rules(rules(""))
    assert recorder.keeps("/scan")
    recorder.lose("/scan", 3, 11 * SECOND, 12 * SECOND)
    recorder.advance(20 * SECOND)
    (one,) = sink.kept
    assert one.missing is not None
    assert [(lost.topic, lost.reason, lost.messages) for lost in one.missing] == [
        ("/scan", MissingReason.LOST, 3)
    ]
    assert not recorder.keeps("/scan")


@pytest.mark.parametrize("topic", ["/tf_static", "/map"])
def test_what_was_latched_before_rules_recorded_anything_is_in_their_incidents(topic: str) -> None:
    recorder, sink = recorder_for(rules(""), topics=())
    recorder.on_subscribed(topic, 1 * SECOND, transient_local=True)
    recorder.on_message(topic, 1 * SECOND, b"latched")
    recording = rules('Record "far" /odom Before 1 s After 5 s')
    recorder.change_rules(recording)
    recorder.on_subscribed(topic, 50 * SECOND, transient_local=True)
    recorder.begin(trigger(recording, 60 * SECOND))
    (one,) = sink.kept
    assert [(message.topic, message.payload) for message in one.latched] == [(topic, b"latched")]


def test_what_was_latched_while_rules_did_not_name_its_topic_is_unknown() -> None:
    recording = rules('Record "far" /odom Before 10 s After 5 s')
    recorder, sink = recorder_for(recording)
    recorder.on_subscribed("/map", 1 * SECOND, transient_local=True)
    recorder.on_message("/map", 1 * SECOND, b"old map")
    recorder.change_rules(rules('Record "far" /odom Before 10 s After 5 s', defaults=""))
    assert not recorder.keeps("/map")
    recorder.change_rules(recording)
    recorder.on_subscribed("/map", 57 * SECOND, transient_local=True)
    recorder.on_message("/map", 57 * SECOND, b"new map")
    recorder.begin(trigger(recording, 60 * SECOND))
    recorder.advance(70 * SECOND)
    (one,) = sink.kept
    assert one.latched == []
    assert [message.payload for message in one.messages] == [b"new map"]
    assert one.missing == (unsubscribed("/map", 50 * SECOND, 57 * SECOND),)
