# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The demo with a robot, a runtime and a recorder as processes."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from ros.ros_processes import SmallRobot
from smarttestudo.bags.reader import open_recording

DRIVE_S = 600.0
LIVE_TOPICS = {
    "/cmd_vel",
    "/odom",
    "/camera/camera_info",
    "/camera/image_raw/compressed",
    "/imu",
    "/joint_states",
    "/scan",
}


@pytest.mark.parametrize("options", [(), ("--physics",)], ids=["exact", "physics"])
def test_the_live_demo_records_what_was_published_and_what_was_received(
    robot: SmallRobot, options: tuple[str, ...]
) -> None:
    out = robot.folder / "out"
    demo = robot.testudo("demo", "--live", *options, "--seconds", "4", "--out", str(out))
    demo.line_with("note: /camera/image_raw: off without --full-images")
    assert demo.exit_code(within_s=DRIVE_S) == 0, "".join(demo.output)
    counts = {name: messages_of(out / name) for name in ("baseline", "adaptive")}
    assert {topic for topic, count in counts["baseline"].items() if count} >= LIVE_TOPICS
    assert {topic for topic, count in counts["adaptive"].items() if count} >= LIVE_TOPICS
    assert counts["adaptive"]["/imu"] < counts["baseline"]["/imu"]
    decisions = [json.loads(line) for line in (out / "decisions.jsonl").read_text("utf-8").splitlines()]
    assert {decision["topic"] for decision in decisions} >= LIVE_TOPICS
    printed = "".join(demo.output)
    assert "Traceback" not in printed
    assert all(table in printed for table in ("Frequency", "Bandwidth", "All topics"))


def messages_of(bag: Path) -> dict[str, int]:
    with open_recording(bag) as recording:
        counts = dict.fromkeys((channel.topic for channel in recording.channels), 0)
        for channel, _, _ in recording.messages():
            counts[channel.topic] += 1
    return counts
