# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Replays of rules for topics of a kind."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from bags.bag_factory import (
    IMAGE,
    START_NS,
    BagContent,
    BagMessage,
    cdr,
    message_of,
    small_mission,
    write_bag,
)
from replays.replay_runs import replay_bag, replay_content
from smarttestudo import api
from smarttestudo.accuracy.recorded_loss import LossQuestion, measure_loss
from smarttestudo.rules.rule_sets import load_rules

CAMERAS = ("/camera/front", "/camera/late", "/camera/_raw")
PATTERN = """
  SetFrequency /** 2
  SetFrequency /camera/* Full
  If (CheckValue /odom pose_y > 2) Then SetFrequency /camera/* 1 SetFrequency /camera/front 4 EndIf
"""
NAMES = """
  SetFrequency /gripper 2 SetFrequency /image 2 SetFrequency /map_name 2
  SetFrequency /odom 2 SetFrequency /scan 2
  SetFrequency /camera/front Full SetFrequency /camera/late Full
  If (CheckValue /odom pose_y > 2) Then SetFrequency /camera/late 1 SetFrequency /camera/front 4 EndIf
"""


def mission_with_cameras() -> BagContent:
    """A mission with three cameras at 10 Hz, of which one begins after two of its four seconds."""
    mission = small_mission()
    image = cdr(IMAGE.type_name, message_of(IMAGE.type_name))
    messages = [
        BagMessage(topic, START_NS + number * 100_000_000 + 7, image)
        for topic in CAMERAS
        for number in range(20 if topic == "/camera/late" else 0, 40)
    ]
    ordered = sorted((*mission.messages, *messages), key=lambda message: message.stamp_ns)
    return BagContent((*mission.topics, *(replace(IMAGE, name=topic) for topic in CAMERAS)), tuple(ordered))


def test_a_replay_by_patterns_is_that_by_the_names_and_relays_a_topic_from_its_first_message(
    tmp_path: Path,
) -> None:
    runs = []
    for name, rules in (("pattern", PATTERN), ("names", NAMES)):
        folder = tmp_path / name
        folder.mkdir()
        runs.append(replay_content(mission_with_cameras(), rules, folder))
    pattern, names = runs
    assert pattern.messages == names.messages
    assert pattern.on("/camera/late")[0].stamp_ns == START_NS + 2_000_000_007
    assert not pattern.on("/camera/_raw")
    assert {one.topic: one.planned.rate for one in pattern.decisions} == {
        one.topic: one.planned.rate for one in names.decisions
    }


def test_rules_are_read_once_for_recordings_with_other_topics(tmp_path: Path) -> None:
    path = tmp_path / "rules.adirf"
    path.write_text("begin SetFrequency /camera/* 5 SetFrequency /odom 1 end")
    rules = api.read_rules(path)
    small = write_bag(tmp_path / "small", small_mission())
    cameras = write_bag(tmp_path / "cameras", mission_with_cameras())
    assert set(api.replay(small, rules, tmp_path / "a").topics) == {"/odom"}
    assert set(api.replay(cameras, rules, tmp_path / "b").topics) == {
        "/odom",
        "/camera/front",
        "/camera/late",
    }


def test_what_a_pattern_bounds_is_measured(tmp_path: Path) -> None:
    bag = write_bag(tmp_path / "bag", small_mission())
    (tmp_path / "run").mkdir()
    run = replay_bag(
        bag, "SetFrequency /odom 2 KeepWithin /od** position 0.1".replace("/od**", "/*"), tmp_path / "run"
    )
    path = tmp_path / "run" / "rules.adirf"
    question = LossQuestion(rule_set=load_rules([path]).rule_set)
    named = tmp_path / "named.adirf"
    named.write_text("begin SetFrequency /odom 2 KeepWithin /odom position 0.1 end")
    by_name = LossQuestion(rule_set=load_rules([named]).rule_set)
    found, expected = (measure_loss(bag, run.output, one) for one in (question, by_name))
    assert [row for row in found.rows() if row["topic"] == "/odom"] == [
        row for row in expected.rows() if row["topic"] == "/odom"
    ]


@pytest.mark.parametrize("type_name", ["", "BatteryState."])
def test_a_constant_is_that_of_the_type_in_the_recording(tmp_path: Path, type_name: str) -> None:
    of_type = "sensor_msgs/msg/BatteryState"
    battery = replace(IMAGE, name="/robot/power", type_name=of_type)
    messages = [
        BagMessage(
            battery.name,
            START_NS + number * 100_000_000 + 3,
            cdr(of_type, message_of(of_type, power_supply_status=int(number >= 20))),
        )
        for number in range(40)
    ]
    mission = small_mission()
    ordered = sorted((*mission.messages, *messages), key=lambda message: message.stamp_ns)
    content = BagContent((*mission.topics, battery), tuple(ordered))
    constant = f"{type_name}POWER_SUPPLY_STATUS_CHARGING"
    rules = f"SetFrequency /odom 2 If (CheckValue /robot/power power_supply_status = {constant}) "
    run = replay_content(content, f"{rules} Then SetFrequency /odom 10 EndIf", tmp_path)
    (raised,) = [one for one in run.decisions if one.planned.rate.hz == 10 and one.t_s > 1]
    assert raised.t_s == pytest.approx(2.0, abs=0.05)
