# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Short drives of robots with physics, as fast as they are computed."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

from simulation.missions import START_NS
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.simulation.geometry import Vector
from smarttestudo.simulation.messages import RobotTopic, TimedMessage
from smarttestudo.simulation.physics.drive import PhysicalRobot, RobotKind, physical_robot
from smarttestudo.simulation.warehouse import patrol


@contextmanager
def robot_of(kind: RobotKind = RobotKind.WAFFLE, **options: Any) -> Iterator[PhysicalRobot]:
    with physical_robot(kind, patrol(), **{"seed": 1, **options}) as robot:
        yield robot


def until(robot: PhysicalRobot, drive: Iterator[TimedMessage], seconds: float) -> list[TimedMessage]:
    """What arrives within the first ``seconds`` of the drive."""
    found = []
    for timed in drive:
        if timed.time_ns >= START_NS + seconds * NS_PER_S:
            break
        found.append(timed)
    assert robot.body.now_ns >= START_NS
    return found


@dataclass(slots=True)
class Driven:
    """What became of a drive."""

    off_m: list[float] = field(default_factory=list)
    touched: set[str] = field(default_factory=set)
    counts: dict[RobotTopic, int] = field(default_factory=dict)
    hardest_m_per_s2: float = 0.0

    def note(self, robot: PhysicalRobot, timed: TimedMessage) -> None:
        self.counts[timed.topic] = self.counts.get(timed.topic, 0) + 1
        message: Any = timed.message
        if timed.topic is RobotTopic.ODOM:
            self.off_m.append(distance_m(message.pose.pose.position, robot.body.engine.position))
            self.touched |= robot.body.engine.touched()
        elif timed.topic is RobotTopic.IMU:
            force = message.linear_acceleration
            self.hardest_m_per_s2 = max(self.hardest_m_per_s2, math.hypot(force.x, force.y, force.z))


def driven(robot: PhysicalRobot, seconds: float) -> Driven:
    result = Driven()
    for timed in robot.start(START_NS):
        if timed.time_ns >= START_NS + seconds * NS_PER_S:
            return result
        result.note(robot, timed)
    raise AssertionError("a drive has no end")


def rates_hz(counts: Mapping[RobotTopic, int], seconds: float) -> dict[RobotTopic, float]:
    return {topic: count / seconds for topic, count in counts.items()}


def distance_m(a: Any, b: Vector) -> float:
    return math.hypot(a.x - b.x, a.y - b.y)
