# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo run --incidents``: what a running robot's rules record, from before it mattered."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from adapters.rosbag.bag_factory import BagMessage
from adapters.rosbag.bag_reading import read_bag, read_with_mcap, read_with_rosbags
from ros.ros_processes import Process, SmallRobot

ODOM = {"type": "nav_msgs/msg/Odometry", "hz": 20, "reliable": True}
COUNT = {"type": "std_msgs/msg/String", "hz": 100, "reliable": True}
FRAMES = {"type": "std_msgs/msg/String", "texts": ["one"]}
RULES = """\
begin
  SetFrequency /odom 5
  Rule "Far" If CheckValue /odom pose_x > 4 Then
    Record "near miss" /odom /count Before 2 s After 500 ms
  EndIf
end
"""


def record_of(folder: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((folder / "incident.json").read_text())
    return found


def numbers(messages: list[BagMessage]) -> list[int]:
    """What the texts of /count say, which are numbers without a gap."""
    return [int(one.payload[8:-1]) for one in messages if one.topic == "/count"]


def start(robot: SmallRobot, folder: Path, rules: str = RULES, *options: str) -> tuple[Process, Process]:
    source = robot.source(odom=ODOM, count=COUNT, tf_static=FRAMES)
    runtime = robot.runtime(rules, "--incidents", str(folder), *options)
    runtime.line_with("/count: std_msgs/msg/String")
    return source, runtime


def test_an_incident_of_a_running_robot_is_whole(robot: SmallRobot) -> None:
    folder = robot.folder / "incidents"
    source, runtime = start(robot, folder)
    heard = robot.operator(span_s=2.5, count={"type": "std_msgs/msg/String", "topic": "/count"})
    heard.line_with("heard 1")
    source.say("move odom")
    name = runtime.line_with("incident ").split("incident ")[1].strip()
    path = folder / name
    messages = read_bag(path).messages
    found = numbers(messages)
    assert found == list(range(found[0], found[-1] + 1))
    record = record_of(path)
    assert record["missing"] == []
    assert [one["topic"] for one in record["latched"]] == ["/tf_static"]
    assert read_with_rosbags(path) == messages
    assert sum(len(read_with_mcap(one)) for one in path.glob("*.mcap")) == len(messages)
    assert record["from_ns"] <= min(one.stamp_ns for one in messages)
    assert max(one.stamp_ns for one in messages) <= record["to_ns"]
