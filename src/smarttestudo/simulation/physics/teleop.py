# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Driving by keys, as turtlebot3_teleop has them."""

from __future__ import annotations

from dataclasses import replace

from smarttestudo.simulation.geometry import BodyVelocity
from smarttestudo.simulation.physics.body import PhysicalBody

LINEAR_STEP_M_PER_S = 0.05
ANGULAR_STEP_RAD_PER_S = 0.2
CLIMB_STEP_M_PER_S = 0.1
DRIVING_KEYS = "w/x: faster, slower or back; a/d: turn left, right; s or space: stop; Ctrl-C: end"
FLYING_KEYS = f"r/f: climb, sink; {DRIVING_KEYS}"


class Teleop:
    """The velocity that the keys pressed so far ask for; each press is a step."""

    def __init__(self, *, can_fly: bool, most: BodyVelocity) -> None:
        """``most`` is as fast as the robot goes."""
        self._can_fly = can_fly
        self._most = most
        self.velocity = BodyVelocity(0.0, 0.0)

    @property
    def keys(self) -> str:
        """Keys, and what each does."""
        return FLYING_KEYS if self._can_fly else DRIVING_KEYS

    def press(self, keys: str) -> None:
        """Take ``keys`` in order; unknown ones mean nothing."""
        for key in keys:
            self._press(key.lower())

    @property
    def description(self) -> str:
        """The velocity in words."""
        now = self.velocity
        climb = f", {now.climb_m_per_s:+.2f} m/s up" if self._can_fly else ""
        return f"{now.linear_m_per_s:+.2f} m/s, {now.angular_rad_per_s:+.2f} rad/s{climb}"

    def command(self, _body: PhysicalBody) -> BodyVelocity:
        """The velocity to make for now."""
        return self.velocity

    def _press(self, key: str) -> None:
        now, most = self.velocity, self._most
        match key:
            case "w" | "x":
                step = LINEAR_STEP_M_PER_S if key == "w" else -LINEAR_STEP_M_PER_S
                linear = _stepped(now.linear_m_per_s, step, most.linear_m_per_s)
                self.velocity = replace(now, linear_m_per_s=linear)
            case "a" | "d":
                step = ANGULAR_STEP_RAD_PER_S if key == "a" else -ANGULAR_STEP_RAD_PER_S
                angular = _stepped(now.angular_rad_per_s, step, most.angular_rad_per_s)
                self.velocity = replace(now, angular_rad_per_s=angular)
            case "r" | "f" if self._can_fly:
                step = CLIMB_STEP_M_PER_S if key == "r" else -CLIMB_STEP_M_PER_S
                climb = _stepped(now.climb_m_per_s, step, most.climb_m_per_s)
                self.velocity = replace(now, climb_m_per_s=climb)
            case "s" | " ":
                self.velocity = BodyVelocity(0.0, 0.0)


def _stepped(value: float, step: float, most: float) -> float:
    return round(min(max(value + step, -most), most), 6)
