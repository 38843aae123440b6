# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The TurtleBot3 Waffle: masses and sizes of its description, the motors of its wheels, and its sensors."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from smarttestudo.simulation import messages
from smarttestudo.simulation.geometry import (
    BodyVelocity,
    FrameTransform,
    Lens,
    Pose,
    Quaternion,
    Vector,
    clamped,
)
from smarttestudo.simulation.messages import Published, RobotTopic
from smarttestudo.simulation.physics.body import BatteryType, Machine, PhysicalBody
from smarttestudo.simulation.physics.engine import HIDDEN_GROUP, LIDAR_COVER, Engine
from smarttestudo.simulation.physics.sensors import Localizer, elapsed_s
from smarttestudo.simulation.physics.world import STEP_S, camera, heading, numbers
from smarttestudo.simulation.robot import (
    BASE_FRAME,
    ODOM_FRAME,
    DriveModel,
    fixed_frames,
    rolled,
    wheel_frames,
)
from smarttestudo.simulation.schedule import Device
from smarttestudo.simulation.sensors import Floats, Lidar, Odometer, WheelEncoders
from smarttestudo.simulation.steering import Steer

_POSE_DEVIATIONS = (0.1, 0.1, 0.0, 0.0, 0.0, 0.1)
TICKS_PER_TURN = 4096
RADIUS_ERROR = 0.0004
SEPARATION_ERROR = 0.002
"""Standard deviations of what the robot believes of its wheels, as shares."""


class WheelOdometer:
    """Dead reckoning from the ticks of two encoders, by wheels that are not quite as they are believed to be.

    Slipping wheels turn without moving the robot, and this cannot see it. The frame goes with the odometry.
    """

    rate_hz = Odometer.rate_hz

    def __init__(self, model: DriveModel, start: Pose, noise: np.random.Generator) -> None:
        left, right, separation = noise.standard_normal(3).tolist()
        self._left_m = model.wheel_radius_m * (1 + RADIUS_ERROR * left)
        self._right_m = model.wheel_radius_m * (1 + RADIUS_ERROR * right)
        self._separation_m = model.wheel_separation_m * (1 + SEPARATION_ERROR * separation)
        self._last: tuple[int, int] | None = None
        self._sampled_ns: int | None = None
        self.pose = start

    def sample(self, body: PhysicalBody) -> Published:
        dt_s = elapsed_s(self._sampled_ns, body.now_ns, self.rate_hz)
        self._sampled_ns = body.now_ns
        left, right = (math.floor(angle / math.tau * TICKS_PER_TURN) for angle in body.engine.joint_angles)
        before, self._last = self._last or (left, right), (left, right)
        left_m = (left - before[0]) / TICKS_PER_TURN * math.tau * self._left_m
        right_m = (right - before[1]) / TICKS_PER_TURN * math.tau * self._right_m
        self.pose = rolled(self.pose, left_m, right_m, self._separation_m)
        place, heading = Vector(self.pose.x_m, self.pose.y_m, 0.0), Quaternion.from_yaw(self.pose.yaw_rad)
        twist = messages.estimated_twist(
            Vector((left_m + right_m) / 2 / dt_s, 0.0, 0.0),
            Vector(0.0, 0.0, (right_m - left_m) / self._separation_m / dt_s),
            Odometer.twist_deviations,
        )
        estimate = messages.estimated_pose(place, heading, _POSE_DEVIATIONS)
        frame = FrameTransform(ODOM_FRAME, BASE_FRAME, place, heading)
        return [
            (RobotTopic.ODOM, messages.odometry(body.now_ns, BASE_FRAME, estimate, twist)),
            (RobotTopic.TF, messages.transforms(body.now_ns, [frame])),
        ]


@dataclass(frozen=True)
class WheelSensors:
    """The angles and speeds of the wheels, and the frames that robot_state_publisher makes of them."""

    model: DriveModel
    rate_hz = WheelEncoders.rate_hz

    def sample(self, body: PhysicalBody) -> Published:
        left, right = body.engine.joint_angles
        return [
            (
                RobotTopic.JOINT_STATES,
                messages.joint_states(body.now_ns, (left, right), body.engine.joint_speeds),
            ),
            (RobotTopic.TF, messages.transforms(body.now_ns, wheel_frames(self.model, (left, right)))),
        ]


def tilting_cast(model: DriveModel) -> Callable[[PhysicalBody], Floats]:
    """Function that casts the rays of a LiDAR that tilts: they may meet the floor, a person, or a cover."""
    bearings_rad = Lidar.bearings_rad
    directions = np.stack([np.cos(bearings_rad), np.sin(bearings_rad), np.zeros(len(bearings_rad))], axis=1)
    mount = np.array((model.scan_x_m, 0.0, SCAN_HEIGHT_M))

    def cast(body: PhysicalBody) -> Floats:
        rotation, position = body.engine.rotation, body.engine.position
        x, y, z = (rotation @ mount).tolist()
        origin = Vector(position.x + x, position.y + y, position.z + z)
        return body.engine.cast(origin, directions @ rotation.T, Lidar.reach_m)

    return cast


SCAN_HEIGHT_M = 0.132
"""Of the LiDAR above the floor."""
_WHEEL_WIDTH_M = 0.018
_WHEEL_KG = 0.0285
_TRUNK_KG = 1.373
_LIDAR_KG = 0.114
_MOTOR_GAIN = 0.4
_MOTOR_TORQUE_N_M = 1.0
_IDLE_W = 7.5
_EFFICIENCY = 0.4
_DARK = "0.15 0.15 0.17 1"


class Waffle(Machine):
    """Two driven wheels and two balls that slide; the wheels follow a command within their acceleration."""

    model = DriveModel()
    most = BodyVelocity(model.max_linear_m_per_s, model.max_angular_rad_per_s)
    actuator_count = 2
    battery = BatteryType(nominal_v=11.1, capacity_ah=1.8)
    own_topics = (RobotTopic.SCAN, RobotTopic.JOINT_STATES)
    fixed_frames = fixed_frames(model)

    def __init__(self, start: Pose) -> None:
        self._start = start
        self._target_m_per_s = (0.0, 0.0)
        self._rim_m_per_s = (0.0, 0.0)

    def body(self, lens: Lens) -> str:
        """The robot; its origin is on the floor between the wheels."""
        model, start = self.model, self._start
        left, right = (self._wheel(name, side) for name, side in (("left", 1), ("right", -1)))
        ball = 'type="sphere" size="0.005" mass="0.005" friction="0.02 0 0" priority="1"'
        return f"""
        <body name="robot" pos="{numbers(start.x_m, start.y_m, 0.001)}" quat="{heading(start)}">
          <freejoint name="robot"/>
          <geom name="trunk" type="box" pos="-0.064 0 0.063" size="0.133 0.133 0.047" rgba="{_DARK}"
                mass="{_TRUNK_KG}"/>
          <geom name="lidar" type="cylinder" pos="{numbers(model.scan_x_m, 0, SCAN_HEIGHT_M - 0.004)}"
                size="0.055 0.016" rgba="{_DARK}" mass="{_LIDAR_KG}"/>
          <geom name="left_ball" pos="-0.177 0.064 0.005" {ball}/>
          <geom name="right_ball" pos="-0.177 -0.064 0.005" {ball}/>
          <site name="imu" pos="0 0 0.078"/>
          {camera(model.camera_x_m, model.camera_height_m, lens)}
          <body name="{LIDAR_COVER}" pos="{numbers(model.scan_x_m, 0, SCAN_HEIGHT_M)}">
            <geom name="{LIDAR_COVER}" type="cylinder" size="0.08 0.04" group="{HIDDEN_GROUP}" contype="0"
                  conaffinity="0" mass="0.001" rgba="0.6 0.45 0.3 1"/>
          </body>
          {left}{right}
        </body>"""

    def _wheel(self, name: str, side: int) -> str:
        radius_m, y_m = self.model.wheel_radius_m, side * self.model.wheel_separation_m / 2
        return f"""
          <body name="{name}_wheel" pos="{numbers(0, y_m, radius_m)}">
            <joint name="{name}" type="hinge" axis="0 1 0" damping="0.002" armature="0.001"/>
            <geom name="{name}_wheel" type="cylinder" size="{numbers(radius_m, _WHEEL_WIDTH_M / 2)}"
                  euler="90 0 0" mass="{_WHEEL_KG}" rgba="{_DARK}"/>
          </body>"""

    def actuators(self) -> str:
        """The motors, left first; each holds a speed in rad/s."""
        motor = f'kv="{_MOTOR_GAIN}" forcerange="-{_MOTOR_TORQUE_N_M} {_MOTOR_TORQUE_N_M}"'
        return f'<velocity joint="left" {motor}/><velocity joint="right" {motor}/>'

    def devices(self, noises: Sequence[np.random.Generator]) -> list[Device[PhysicalBody]]:
        odometer = WheelOdometer(self.model, self._start, noises[0])
        return [
            odometer,
            WheelSensors(self.model),
            Lidar(tilting_cast(self.model), noises[1]),
            Localizer(odometer, noises[2]),
        ]

    def keeping_height(self, steer: Steer[PhysicalBody]) -> Steer[PhysicalBody]:
        return steer

    def command(self, velocity: BodyVelocity) -> None:
        """Make for ``velocity``, cut to what the robot can do."""
        model = self.model
        linear = clamped(velocity.linear_m_per_s, model.max_linear_m_per_s)
        angular = clamped(velocity.angular_rad_per_s, model.max_angular_rad_per_s)
        half_turn = angular * model.wheel_separation_m / 2
        self._target_m_per_s = (linear - half_turn, linear + half_turn)

    def rest(self) -> None:
        self._target_m_per_s = (0.0, 0.0)

    def controls(self, _engine: Engine) -> Sequence[float]:
        """Controls of the motors for the next step: the speed of each wheel in rad/s."""
        limit = self.model.wheel_acceleration_m_per_s2 * STEP_S
        (left, right), (to_left, to_right) = self._rim_m_per_s, self._target_m_per_s
        self._rim_m_per_s = (left + clamped(to_left - left, limit), right + clamped(to_right - right, limit))
        return [rim / self.model.wheel_radius_m for rim in self._rim_m_per_s]

    def power_w(self, engine: Engine) -> float:
        """Power that computer, LiDAR and motors take now."""
        worked = zip(engine.actuator_forces, engine.joint_speeds, strict=True)
        return _IDLE_W + sum(abs(torque * speed) for torque, speed in worked) / _EFFICIENCY
