# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the recordings of the live demo lack is said."""

from __future__ import annotations

from pathlib import Path

from robot.status.virtual_robot import Source, VirtualRobot
from smarttestudo.domain.recording import Channel
from smarttestudo.simulation.demo.live import lost_lines, recorded


def test_messages_that_a_recording_lost_are_counted_topic_by_topic(tmp_path: Path) -> None:
    robot = VirtualRobot(sources={"/image": Source(hz=15, one_of=3), "/scan": Source(hz=10)})
    channels = [Channel(topic=topic, type_name="sensor_msgs/msg/Imu") for topic in robot.sources]
    folder = tmp_path / "baseline"
    with recorded(robot, folder, channels, {}) as heard:
        robot.wait(None, 200)
        said = lost_lines(folder, heard)
    assert said == ["baseline: 2 000 of 3 000 messages of /image were lost on their way"]
