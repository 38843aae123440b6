# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Short missions for tests."""

from __future__ import annotations

import math
from itertools import takewhile
from typing import Any

from smarttestudo.domain.units import NS_PER_S
from smarttestudo.simulation.camera import FrameSize
from smarttestudo.simulation.geometry import Pose
from smarttestudo.simulation.messages import RobotTopic, TimedMessage
from smarttestudo.simulation.mission import drive_mission
from smarttestudo.simulation.warehouse import patrol

START_NS = 1_750_000_000 * NS_PER_S


def driven(seconds: float, *, seed: int = 1, frames: FrameSize = FrameSize.SMALL) -> list[TimedMessage]:
    mission = drive_mission(patrol(), seed=seed, start_ns=START_NS, frames=frames)
    end_ns = START_NS + round(seconds * NS_PER_S)
    return list(takewhile(lambda timed: timed.time_ns < end_ns, mission))


def of_topic(timed: list[TimedMessage], topic: RobotTopic) -> list[Any]:
    return [one.message for one in timed if one.topic is topic]


def stamp_ns(message: Any) -> int:
    """When it was measured; of several transforms, the first one."""
    header = message.transforms[0].header if hasattr(message, "transforms") else message.header
    return int(header.stamp.sec * NS_PER_S + header.stamp.nanosec)


def poses(timed: list[TimedMessage]) -> dict[int, Pose]:
    """Where the odometry has the robot, by the time of measurement, with a heading that is not wrapped."""
    found: dict[int, Pose] = {}
    yaw_rad = 0.0
    for message in of_topic(timed, RobotTopic.ODOM):
        pose = message.pose.pose
        heading_rad = 2 * math.atan2(pose.orientation.z, pose.orientation.w)
        yaw_rad += math.remainder(heading_rad - yaw_rad, math.tau)
        found[stamp_ns(message)] = Pose(pose.position.x, pose.position.y, yaw_rad)
    return found
