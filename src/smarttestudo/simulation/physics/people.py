# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""People who walk to and fro beside the robot's patrol, and stop for a robot in their way."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from smarttestudo.domain.floor_plan import Point
from smarttestudo.simulation.geometry import Pose

_STOP_M = 1.0
_CLEAR_M = 0.55
_AT_ONCE_M = 0.1


@dataclass(frozen=True, slots=True, kw_only=True)
class Walk:
    """A straight way from ``start`` to ``end`` and back, without end."""

    start: Point
    end: Point
    speed_m_per_s: float


WALKS = (
    Walk(start=Point(11.9, 11.0), end=Point(11.9, -2.0), speed_m_per_s=0.9),
    Walk(start=Point(4.5, 4.6), end=Point(-4.5, 4.6), speed_m_per_s=1.1),
    Walk(start=Point(-8.0, 15.6), end=Point(7.8, 15.6), speed_m_per_s=1.0),
)
"""In the hall, in the corridor and behind the scaffolds."""


class WalkingPerson:
    """One person on a walk."""

    __slots__ = ("_length_m", "_travelled_m", "_walk")

    def __init__(self, walk: Walk) -> None:
        self._walk = walk
        self._length_m = walk.start.distance_m(walk.end)
        self._travelled_m = 0.0

    @property
    def pose(self) -> Pose:
        """Where the person is, facing ahead."""
        walk = self._walk
        lap_m = self._travelled_m % (2 * self._length_m)
        share = 1 - abs(lap_m / self._length_m - 1)
        heading = math.atan2(walk.end.y_m - walk.start.y_m, walk.end.x_m - walk.start.x_m)
        return Pose(
            walk.start.x_m + share * (walk.end.x_m - walk.start.x_m),
            walk.start.y_m + share * (walk.end.y_m - walk.start.y_m),
            heading if lap_m < self._length_m else heading + math.pi,
        )

    def walk(self, dt_s: float, robot: Point) -> None:
        """Go on for ``dt_s``, unless the robot stands in the way."""
        pose = self.pose
        ahead_m = (robot.x_m - pose.x_m) * math.cos(pose.yaw_rad)
        ahead_m += (robot.y_m - pose.y_m) * math.sin(pose.yaw_rad)
        aside_m = (robot.y_m - pose.y_m) * math.cos(pose.yaw_rad)
        aside_m -= (robot.x_m - pose.x_m) * math.sin(pose.yaw_rad)
        if not (-_AT_ONCE_M < ahead_m < _STOP_M and abs(aside_m) < _CLEAR_M):
            self._travelled_m += self._walk.speed_m_per_s * dt_s


def people(walks: Sequence[Walk] = WALKS) -> list[WalkingPerson]:
    """Everybody, at the start of their walks."""
    return [WalkingPerson(walk) for walk in walks]
