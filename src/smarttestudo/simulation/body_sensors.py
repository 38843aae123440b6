# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The sensors of the robot's own motion.

Noise is Gaussian; the IMU's is that of ``turtlebot3_waffle_pi/model.sdf`` of ``turtlebot3_gazebo``.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from smarttestudo.simulation.geometry import FrameTransform, Quaternion, Vector
from smarttestudo.simulation.messages import (
    Published,
    Topic,
    estimated_pose,
    estimated_twist,
    imu,
    joint_states,
    odometry,
    transforms,
)
from smarttestudo.simulation.robot import BASE_FRAME, ODOM_FRAME, DifferentialDrive, wheel_frames

GRAVITY_M_PER_S2 = 9.80665


@dataclass(frozen=True)
class Odometer:
    """Odometry in the map's coordinates without drift, as Gazebo gives it; only the speeds are noisy."""

    noise: np.random.Generator
    rate_hz = 25.5
    twist_deviations = (0.002, 0.0, 0.0, 0.0, 0.0, 0.005)

    def sample(self, drive: DifferentialDrive) -> Published:
        linear_noise, angular_noise = self.noise.standard_normal(2).tolist()
        true = drive.velocity
        linear = true.linear_m_per_s + self.twist_deviations[0] * linear_noise
        angular = true.angular_rad_per_s + self.twist_deviations[5] * angular_noise
        twist = estimated_twist(Vector(linear, 0.0, 0.0), Vector(0.0, 0.0, angular), self.twist_deviations)
        pose = estimated_pose(*_floor_pose(drive), (0.0,) * 6)
        return [(Topic.ODOM, odometry(drive.now_ns, BASE_FRAME, pose, twist))]


@dataclass(frozen=True)
class InertialUnit:
    """Gyroscope, accelerometer and the heading made from them."""

    noise: np.random.Generator
    rate_hz = 195.0
    yaw_noise_rad = 0.002
    angular_noise_rad_per_s = 2e-4
    linear_noise_m_per_s2 = 1.7e-2

    def sample(self, drive: DifferentialDrive) -> Published:
        """Specific force: forward acceleration, centripetal acceleration v·ω to the left, gravity up."""
        noise = self.noise.standard_normal(7).tolist()
        velocity = drive.velocity
        turning, force = self.angular_noise_rad_per_s, self.linear_noise_m_per_s2
        orientation = Quaternion.from_yaw(drive.pose.yaw_rad + self.yaw_noise_rad * noise[0])
        angular = Vector(
            turning * noise[1], turning * noise[2], velocity.angular_rad_per_s + turning * noise[3]
        )
        linear = Vector(
            drive.forward_m_per_s2 + force * noise[4],
            velocity.linear_m_per_s * velocity.angular_rad_per_s + force * noise[5],
            GRAVITY_M_PER_S2 + force * noise[6],
        )
        deviations = ((0.0, 0.0, self.yaw_noise_rad), turning, force)
        return [(Topic.IMU, imu(drive.now_ns, orientation, angular, linear, deviations))]


class WheelEncoders:
    """The angles and speeds of the wheels."""

    rate_hz = 5.0

    def sample(self, drive: DifferentialDrive) -> Published:
        speeds = [rim / drive.model.wheel_radius_m for rim in drive.rim_m_per_s]
        return [(Topic.JOINT_STATES, joint_states(drive.now_ns, drive.angles_rad, speeds))]


class OdometryFrame:
    """Where the robot is in the odometry frame, as the drive of Gazebo publishes it beside its odometry."""

    rate_hz = Odometer.rate_hz

    def sample(self, drive: DifferentialDrive) -> Published:
        base = FrameTransform(ODOM_FRAME, BASE_FRAME, *_floor_pose(drive))
        return [(Topic.TF, transforms(drive.now_ns, [base]))]


class WheelFrames:
    """Both wheels, as robot_state_publisher makes them of each message with the wheels' angles."""

    rate_hz = WheelEncoders.rate_hz

    def sample(self, drive: DifferentialDrive) -> Published:
        return [(Topic.TF, transforms(drive.now_ns, wheel_frames(drive.model, drive.angles_rad)))]


def _floor_pose(drive: DifferentialDrive) -> tuple[Vector, Quaternion]:
    return Vector(drive.pose.x_m, drive.pose.y_m, 0.0), Quaternion.from_yaw(drive.pose.yaw_rad)
