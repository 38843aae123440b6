# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import pytest

from checks.rule_findings import codes_of, covered, findings_of
from smarttestudo.checks import CheckContext
from smarttestudo.domain.profile import Profile, TopicProfile

RULES = "begin SetFrequency /odom 5 SetFrequency /scan 5 If {} Then Record {} Before {} After 5 s EndIf end"
SPEED = "CheckValue /odom speed > 1"


def rules(condition: str = SPEED, *, record: str = '"fast"', before: str = "30 s") -> str:
    return RULES.format(condition, record, before)


@pytest.mark.parametrize(
    "condition",
    ["(CheckValue /odom pose_x > -13 OR CheckValue /odom pose_x < 6)", "CheckValue /odom speed >= 0"],
)
def test_a_block_that_always_holds_records_once_and_never_again(condition: str) -> None:
    messages = [one.message for one in findings_of(rules(condition))]
    assert "this condition holds for all values, so that its Record begins once and never again" in messages


@pytest.mark.parametrize(
    "condition",
    ["(CheckValue /odom pose_x < -13 AND CheckValue /odom pose_x > 6)", "CheckValue /odom speed < 0"],
)
def test_an_else_that_always_applies_records_once_and_never_again(condition: str) -> None:
    text = rules(condition).replace("Then Record", "Then SetFrequency /odom 10 Else Record")
    messages = [one.message for one in findings_of(text) if one.code == "condition-never-holds"]
    assert len(messages) == 1
    assert "so that the Record of its Else begins once and never again" in messages[0]


def test_a_window_that_memory_cannot_hold_says_what_would_fit() -> None:
    topics = {
        "/odom": TopicProfile(message_kb=1.0, source_hz=30.0),
        "/scan": TopicProfile(message_kb=1000.0, source_hz=10.0),
    }
    context = CheckContext(profile=Profile(topics=topics))
    (finding,) = findings_of(rules(), context=context)
    assert finding.code == "record-too-large"
    assert "takes 301 MB of the 256 MB" in finding.message
    assert "Before 25 s would fit" in finding.hint
    assert covered(rules(), finding.span) == "30 s"
    assert codes_of(rules(before="25 s"), context=context) == []
    assert codes_of(rules(record='"fast" /odom'), context=context) == []


def test_a_recorded_topic_that_a_bag_lacks_is_named_once() -> None:
    types = {"/odom": "nav_msgs/msg/Odometry", "/scan": "sensor_msgs/msg/LaserScan"}
    profile = Profile(topics={topic: TopicProfile() for topic in types})
    context = CheckContext(profile=profile, bag_topics=types)
    (finding,) = findings_of(rules(record='"fast" /odom /odometry'), context=context)
    assert (finding.code, finding.message) == ("absent-from-bag", "the recording has no /odometry")
