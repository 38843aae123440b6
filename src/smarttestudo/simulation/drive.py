# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How a differential drive moves."""

from __future__ import annotations

import math

from smarttestudo.domain.units import NS_PER_S
from smarttestudo.simulation.geometry import BodyVelocity, Pose
from smarttestudo.simulation.robot import RobotModel

_MAX_STEP_NS = 5_000_000


class DifferentialDrive:
    """The true motion of the robot: two wheels that follow a command within their acceleration.

    ``rim_m_per_s`` and ``rim_m_per_s2`` are the speeds and accelerations at the rims of the left and the
    right wheel, ``angles_rad`` how far they have turned.
    """

    __slots__ = ("_target", "angles_rad", "model", "now_ns", "pose", "rim_m_per_s", "rim_m_per_s2")

    def __init__(self, model: RobotModel, *, pose: Pose, now_ns: int) -> None:
        self.model = model
        self.pose = pose
        self.now_ns = now_ns
        self.rim_m_per_s = (0.0, 0.0)
        self.rim_m_per_s2 = (0.0, 0.0)
        self.angles_rad = (0.0, 0.0)
        self._target = (0.0, 0.0)

    @property
    def velocity(self) -> BodyVelocity:
        """How the robot moves now."""
        left, right = self.rim_m_per_s
        return BodyVelocity((left + right) / 2, (right - left) / self.model.wheel_separation_m)

    @property
    def forward_m_per_s2(self) -> float:
        """The acceleration along the robot's heading."""
        return sum(self.rim_m_per_s2) / 2

    def command(self, velocity: BodyVelocity) -> None:
        """Make for ``velocity`` from now on."""
        half_turn = velocity.angular_rad_per_s * self.model.wheel_separation_m / 2
        self._target = (velocity.linear_m_per_s - half_turn, velocity.linear_m_per_s + half_turn)

    def advance_to(self, now_ns: int) -> None:
        """Move on to ``now_ns`` in steps of at most 5 ms."""
        while self.now_ns < now_ns:
            step_ns = min(now_ns - self.now_ns, _MAX_STEP_NS)
            self._step(step_ns / NS_PER_S)
            self.now_ns += step_ns

    def _step(self, dt_s: float) -> None:
        """Second-order Runge-Kutta: the mean speeds of the step along its middle heading."""
        limit = self.model.wheel_acceleration_m_per_s2 * dt_s
        left, right = self.rim_m_per_s
        change_left = min(max(self._target[0] - left, -limit), limit)
        change_right = min(max(self._target[1] - right, -limit), limit)
        rolled_left_m = (left + change_left / 2) * dt_s
        rolled_right_m = (right + change_right / 2) * dt_s
        forward_m = (rolled_left_m + rolled_right_m) / 2
        turn_rad = (rolled_right_m - rolled_left_m) / self.model.wheel_separation_m
        pose = self.pose
        middle_rad = pose.yaw_rad + turn_rad / 2
        self.pose = Pose(
            pose.x_m + forward_m * math.cos(middle_rad),
            pose.y_m + forward_m * math.sin(middle_rad),
            pose.yaw_rad + turn_rad,
        )
        radius_m = self.model.wheel_radius_m
        self.angles_rad = (
            self.angles_rad[0] + rolled_left_m / radius_m,
            self.angles_rad[1] + rolled_right_m / radius_m,
        )
        self.rim_m_per_s = (left + change_left, right + change_right)
        self.rim_m_per_s2 = (change_left / dt_s, change_right / dt_s)
