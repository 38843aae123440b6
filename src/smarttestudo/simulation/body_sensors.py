# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The sensors of the robot's own motion.

Noise is Gaussian; the IMU's is that of ``turtlebot3_waffle_pi/model.sdf`` of ``turtlebot3_gazebo``.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from smarttestudo.simulation.geometry import BodyVelocity, FrameTransform, Quaternion, Vector
from smarttestudo.simulation.readings import Imu, JointStates, Odometry, Reading, Topic, Transforms
from smarttestudo.simulation.robot import (
    BASE_FRAME,
    ODOM_FRAME,
    DifferentialDrive,
    wheel_frames,
)

GRAVITY_M_PER_S2 = 9.80665


class Odometer:
    """Odometry in the map's coordinates without drift, as Gazebo gives it; only the speeds are noisy."""

    rate_hz = 25.5
    linear_noise_m_per_s = 0.002
    angular_noise_rad_per_s = 0.005

    def __init__(self, noise: np.random.Generator) -> None:
        self._noise = noise

    def sample(self, drive: DifferentialDrive) -> Sequence[tuple[Topic, Reading]]:
        """The pose and the speeds now."""
        linear_noise, angular_noise = self._noise.standard_normal(2).tolist()
        true = drive.velocity
        measured = BodyVelocity(
            true.linear_m_per_s + self.linear_noise_m_per_s * linear_noise,
            true.angular_rad_per_s + self.angular_noise_rad_per_s * angular_noise,
        )
        reading = Odometry(
            stamp_ns=drive.now_ns,
            pose=drive.pose,
            velocity=measured,
            linear_noise_m_per_s=self.linear_noise_m_per_s,
            angular_noise_rad_per_s=self.angular_noise_rad_per_s,
        )
        return [(Topic.ODOM, reading)]


class InertialUnit:
    """Gyroscope, accelerometer and the heading made from them."""

    rate_hz = 195.0
    yaw_noise_rad = 0.002
    angular_noise_rad_per_s = 2e-4
    linear_noise_m_per_s2 = 1.7e-2

    def __init__(self, noise: np.random.Generator) -> None:
        self._noise = noise

    def sample(self, drive: DifferentialDrive) -> Sequence[tuple[Topic, Reading]]:
        """Specific force: forward acceleration, centripetal acceleration v·ω to the left, gravity up."""
        noise = self._noise.standard_normal(7).tolist()
        velocity = drive.velocity
        angular, linear = self.angular_noise_rad_per_s, self.linear_noise_m_per_s2
        reading = Imu(
            stamp_ns=drive.now_ns,
            orientation=Quaternion.from_yaw(drive.pose.yaw_rad + self.yaw_noise_rad * noise[0]),
            angular_velocity=Vector(
                angular * noise[1], angular * noise[2], velocity.angular_rad_per_s + angular * noise[3]
            ),
            linear_acceleration=Vector(
                drive.forward_m_per_s2 + linear * noise[4],
                velocity.linear_m_per_s * velocity.angular_rad_per_s + linear * noise[5],
                GRAVITY_M_PER_S2 + linear * noise[6],
            ),
            orientation_noise_rad=(0.0, 0.0, self.yaw_noise_rad),
            angular_noise_rad_per_s=angular,
            linear_noise_m_per_s2=linear,
        )
        return [(Topic.IMU, reading)]


class WheelEncoders:
    """The angles and speeds of the wheels."""

    rate_hz = 5.0

    def sample(self, drive: DifferentialDrive) -> Sequence[tuple[Topic, Reading]]:
        """Both wheels now."""
        left, right = drive.rim_m_per_s
        radius_m = drive.model.wheel_radius_m
        reading = JointStates(
            stamp_ns=drive.now_ns,
            positions_rad=drive.angles_rad,
            velocities_rad_per_s=(left / radius_m, right / radius_m),
        )
        return [(Topic.JOINT_STATES, reading)]


class OdometryFrame:
    """Where the robot is in the odometry frame, as the drive of Gazebo publishes it beside its odometry."""

    rate_hz = Odometer.rate_hz

    def sample(self, drive: DifferentialDrive) -> Sequence[tuple[Topic, Reading]]:
        """The one transform now."""
        pose = drive.pose
        base = FrameTransform(
            ODOM_FRAME, BASE_FRAME, Vector(pose.x_m, pose.y_m, 0.0), Quaternion.from_yaw(pose.yaw_rad)
        )
        return [(Topic.TF, Transforms(stamp_ns=drive.now_ns, frames=(base,)))]


class WheelFrames:
    """Both wheels, as robot_state_publisher makes them of each message with the wheels' angles."""

    rate_hz = WheelEncoders.rate_hz

    def sample(self, drive: DifferentialDrive) -> Sequence[tuple[Topic, Reading]]:
        """Both transforms now."""
        wheels = wheel_frames(drive.model, drive.angles_rad)
        return [(Topic.TF, Transforms(stamp_ns=drive.now_ns, frames=wheels))]
