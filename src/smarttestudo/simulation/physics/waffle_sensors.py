# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The sensors of the Waffle: encoders, odometry made from them, and the LiDAR."""

from __future__ import annotations

import numpy as np

from smarttestudo.simulation.body_sensors import Odometer, WheelEncoders
from smarttestudo.simulation.geometry import FrameTransform, Quaternion, Vector
from smarttestudo.simulation.lidar import RAYS, Lidar, measured_turn
from smarttestudo.simulation.physics.body import PhysicalBody
from smarttestudo.simulation.physics.odometry import WheelOdometry
from smarttestudo.simulation.physics.sensors import Published, elapsed_s
from smarttestudo.simulation.physics.waffle import SCAN_HEIGHT_M
from smarttestudo.simulation.readings import (
    EstimatedPose,
    JointStates,
    SpatialOdometry,
    Topic,
    Transforms,
)
from smarttestudo.simulation.robot import BASE_FRAME, ODOM_FRAME, DriveModel, wheel_frames

_POSE_DEVIATIONS = (0.1, 0.1, 0.0, 0.0, 0.0, 0.1)


class WheelOdometer:
    """Odometry from the wheels, and the frame that goes with it; both drift."""

    rate_hz = Odometer.rate_hz

    def __init__(self, odometry: WheelOdometry) -> None:
        self._odometry = odometry
        self._sampled_ns: int | None = None

    def sample(self, body: PhysicalBody) -> Published:
        """Where the robot takes itself to be."""
        dt_s = elapsed_s(self._sampled_ns, body.now_ns, self.rate_hz)
        self._sampled_ns = body.now_ns
        odometry = self._odometry
        odometry.update(body.engine.joint_angles, dt_s)
        place = Vector(odometry.pose.x_m, odometry.pose.y_m, 0.0)
        heading = Quaternion.from_yaw(odometry.pose.yaw_rad)
        linear, angular = Odometer.linear_noise_m_per_s, Odometer.angular_noise_rad_per_s
        reading = SpatialOdometry(
            stamp_ns=body.now_ns,
            child_frame=BASE_FRAME,
            pose=EstimatedPose(position=place, orientation=heading, deviations=_POSE_DEVIATIONS),
            linear=Vector(odometry.velocity.linear_m_per_s, 0.0, 0.0),
            angular=Vector(0.0, 0.0, odometry.velocity.angular_rad_per_s),
            twist_deviations=(linear, 0.0, 0.0, 0.0, 0.0, angular),
        )
        frame = FrameTransform(ODOM_FRAME, BASE_FRAME, place, heading)
        return [
            (Topic.ODOM, reading),
            (Topic.TF, Transforms(stamp_ns=body.now_ns, frames=(frame,))),
        ]


class WheelSensors:
    """The angles and speeds of the wheels, and the frames that robot_state_publisher makes of them."""

    rate_hz = WheelEncoders.rate_hz

    def __init__(self, model: DriveModel) -> None:
        self._model = model

    def sample(self, body: PhysicalBody) -> Published:
        """Both wheels now."""
        left, right = body.engine.joint_angles
        left_speed, right_speed = body.engine.joint_speeds
        reading = JointStates(
            stamp_ns=body.now_ns,
            positions_rad=(left, right),
            velocities_rad_per_s=(left_speed, right_speed),
        )
        frames = wheel_frames(self._model, (left, right))
        return [
            (Topic.JOINT_STATES, reading),
            (Topic.TF, Transforms(stamp_ns=body.now_ns, frames=frames)),
        ]


class TiltingLidar:
    """The LDS-01 on a robot that may tilt: its rays may meet the floor, a person, or a cover."""

    rate_hz = Lidar.rate_hz

    def __init__(self, model: DriveModel, noise: np.random.Generator) -> None:
        bearings_rad = np.linspace(0.0, 2 * np.pi, RAYS, endpoint=False)
        self._directions = np.stack([np.cos(bearings_rad), np.sin(bearings_rad), np.zeros(RAYS)], axis=1)
        self._mount = np.array((model.scan_x_m, 0.0, SCAN_HEIGHT_M))
        self._noise = noise

    def sample(self, body: PhysicalBody) -> Published:
        """One turn from where the robot is now."""
        engine = body.engine
        rotation, position = engine.rotation, engine.position
        x, y, z = (rotation @ self._mount).tolist()
        origin = Vector(position.x + x, position.y + y, position.z + z)
        reach_m = Lidar.range_max_m + 4 * Lidar.noise_m
        distances_m = engine.cast(origin, self._directions @ rotation.T, reach_m)
        return [(Topic.SCAN, measured_turn(distances_m, body.now_ns, self._noise))]
