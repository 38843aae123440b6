# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Steering of a robot with physics: by whoever published /cmd_vel just now, or its own navigator."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from smarttestudo.domain.units import NS_PER_S
from smarttestudo.simulation.geometry import BodyVelocity
from smarttestudo.simulation.physics.body import PhysicalBody
from smarttestudo.simulation.physics.quadrotor import CRUISE_HEIGHT_M
from smarttestudo.simulation.readings import Command, Reading, Topic
from smarttestudo.simulation.route import Navigator

HEARD_FOR_NS = 2 * NS_PER_S
"""How long after a command of somebody else the robot's own navigator goes on."""
_CLIMB_PER_M = 1.0
_MOST_CLIMB_M_PER_S = 0.6

Steer = Callable[[PhysicalBody], BodyVelocity]


class SharedNavigator:
    """Steers the robot and publishes what it asks, unless somebody else does."""

    rate_hz = Navigator.rate_hz

    def __init__(self, steer: Steer) -> None:
        self._steer = steer
        self._others_until_ns = 0

    def hear(self, velocity: BodyVelocity, body: PhysicalBody) -> None:
        """Obey the command of another publisher for now."""
        self._others_until_ns = body.now_ns + HEARD_FOR_NS
        body.command(velocity)

    def sample(self, body: PhysicalBody) -> Sequence[tuple[Topic, Reading]]:
        """Command the robot anew."""
        if body.now_ns < self._others_until_ns:
            return []
        velocity = self._steer(body)
        body.command(velocity)
        return [(Topic.CMD_VEL, Command(velocity=velocity))]


def at_height(steer: Steer) -> Steer:
    """``steer`` for one that flies: it climbs before it goes on, and keeps its height."""

    def command(body: PhysicalBody) -> BodyVelocity:
        missing_m = CRUISE_HEIGHT_M - body.engine.position.z
        climb = min(max(_CLIMB_PER_M * missing_m, -_MOST_CLIMB_M_PER_S), _MOST_CLIMB_M_PER_S)
        if missing_m > CRUISE_HEIGHT_M / 3:
            return BodyVelocity(0.0, 0.0, climb_m_per_s=climb)
        level = steer(body)
        return BodyVelocity(level.linear_m_per_s, level.angular_rad_per_s, climb_m_per_s=climb)

    return command
