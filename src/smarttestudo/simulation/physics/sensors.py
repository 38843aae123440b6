# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The sensors that robots with physics share. Noise is Gaussian, and that of ``turtlebot3_gazebo``."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from smarttestudo.domain.units import NS_PER_S
from smarttestudo.simulation import messages
from smarttestudo.simulation.camera import grained
from smarttestudo.simulation.geometry import FrameTransform, Pose, Quaternion, Vector
from smarttestudo.simulation.messages import Pixels, Published, RobotTopic
from smarttestudo.simulation.physics.body import PhysicalBody
from smarttestudo.simulation.robot import MAP_FRAME, ODOM_FRAME
from smarttestudo.simulation.sensors import InertialUnit


@dataclass(frozen=True)
class InertialSensor:
    """Gyroscope and accelerometer, as means since the last sample, and the rotation made from them."""

    noise: np.random.Generator
    rate_hz = InertialUnit.rate_hz

    def sample(self, body: PhysicalBody) -> Published:
        """Reading of what the robot feels: at rest, gravity up."""
        noise = self.noise.standard_normal(9).tolist()
        angular, force = body.mean_inertial()
        turned = InertialUnit.yaw_noise_rad
        roll, pitch, yaw = (turned * deviation for deviation in noise[:3])
        turning_noise, force_noise = InertialUnit.angular_noise_rad_per_s, InertialUnit.linear_noise_m_per_s2
        message = messages.imu(
            body.now_ns,
            body.engine.orientation.then(Quaternion.from_roll_pitch_yaw(roll, pitch, yaw)),
            _noisy(angular, turning_noise, noise[3:6]),
            _noisy(force, force_noise, noise[6:]),
            ((turned, turned, turned), turning_noise, force_noise),
        )
        return [(RobotTopic.IMU, message)]


class BatteryGauge:
    """The battery once a second."""

    rate_hz = 1.0

    def sample(self, body: PhysicalBody) -> Published:
        battery = body.battery
        message = messages.battery_state(
            body.now_ns,
            voltage_v=battery.voltage_v,
            current_a=battery.current_a,
            share=battery.share,
            capacity_ah=battery.type.capacity_ah,
        )
        return [(RobotTopic.BATTERY_STATE, message)]


class DriftingOdometer(Protocol):
    """A device that knows where the robot takes itself to be."""

    pose: Pose


@dataclass(frozen=True)
class Localizer:
    """The pose on the map, as AMCL has it: near the truth, twice a second; it corrects the odometry frame."""

    odometer: DriftingOdometer
    noise: np.random.Generator
    rate_hz = 2.0
    position_noise_m = 0.03
    yaw_noise_rad = 0.01

    def sample(self, body: PhysicalBody) -> Published:
        """The pose, and the frame of the odometry on the map."""
        x_noise, y_noise, yaw_noise = self.noise.standard_normal(3).tolist()
        true, odometry = body.pose, self.odometer.pose
        found = Pose(
            true.x_m + self.position_noise_m * x_noise,
            true.y_m + self.position_noise_m * y_noise,
            true.yaw_rad + self.yaw_noise_rad * yaw_noise,
        )
        turn_rad = found.yaw_rad - odometry.yaw_rad
        cos, sin = math.cos(turn_rad), math.sin(turn_rad)
        shift = Vector(
            found.x_m - cos * odometry.x_m + sin * odometry.y_m,
            found.y_m - sin * odometry.x_m - cos * odometry.y_m,
            0.0,
        )
        noise = (self.position_noise_m, self.position_noise_m, 0.0, 0.0, 0.0, self.yaw_noise_rad)
        pose = messages.estimated_pose(
            Vector(found.x_m, found.y_m, 0.0), Quaternion.from_yaw(found.yaw_rad), noise
        )
        frame = FrameTransform(MAP_FRAME, ODOM_FRAME, shift, Quaternion.from_yaw(turn_rad))
        return [
            (RobotTopic.AMCL_POSE, messages.localization(body.now_ns, pose)),
            (RobotTopic.TF, messages.transforms(body.now_ns, [frame])),
        ]


def camera_view(noise: np.random.Generator) -> Callable[[PhysicalBody], Pixels]:
    """Function that draws the robot's view, with the grain of a sensor."""
    return lambda body: grained(body.engine.picture(), noise)


def elapsed_s(before_ns: int | None, now_ns: int, rate_hz: float) -> float:
    """The time since the last sample; before there was one, a period."""
    return 1 / rate_hz if before_ns is None else (now_ns - before_ns) / NS_PER_S


def _noisy(value: Vector, deviation: float, noise: Sequence[float]) -> Vector:
    return Vector(
        value.x + deviation * noise[0], value.y + deviation * noise[1], value.z + deviation * noise[2]
    )
