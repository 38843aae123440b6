# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The sensors of the quadrotor: visual odometry in three dimensions, and the distance to the ground."""

from __future__ import annotations

import numpy as np

from smarttestudo.simulation.geometry import FrameTransform, Pose, Quaternion, Vector
from smarttestudo.simulation.physics.body import PhysicalBody
from smarttestudo.simulation.physics.odometry import DriftWalk
from smarttestudo.simulation.physics.sensors import Published, elapsed_s
from smarttestudo.simulation.readings import (
    EstimatedPose,
    RangeReading,
    SpatialOdometry,
    Topic,
    Transforms,
)
from smarttestudo.simulation.robot import (
    BASE_LINK,
    CAMERA_FRAME,
    IMU_FRAME,
    ODOM_FRAME,
    OPTICAL_FRAME,
    RANGE_FRAME,
    optical_rotation,
)

RANGE_MOUNT_M = 0.04
"""Of the range finder below the middle."""
_LEVEL = Quaternion(0.0, 0.0, 0.0, 1.0)
_DOWN = Quaternion.from_roll_pitch_yaw(0.0, np.pi / 2, 0.0)
_POSE_DEVIATIONS = (0.1, 0.1, 0.1, 0.01, 0.01, 0.05)


def quadrotor_frames(camera_x_m: float) -> tuple[FrameTransform, ...]:
    """The frames that never move against the quadrotor."""
    return (
        FrameTransform(BASE_LINK, IMU_FRAME, Vector(0.0, 0.0, 0.0), _LEVEL),
        FrameTransform(BASE_LINK, RANGE_FRAME, Vector(0.0, 0.0, -RANGE_MOUNT_M), _DOWN),
        FrameTransform(BASE_LINK, CAMERA_FRAME, Vector(camera_x_m, 0.0, 0.0), _LEVEL),
        FrameTransform(CAMERA_FRAME, OPTICAL_FRAME, Vector(0.0, 0.0, 0.0), optical_rotation()),
    )


class VisualOdometer:
    """Odometry in three dimensions, which strays like a random walk."""

    rate_hz = 30.0
    linear_noise_m_per_s = 0.02
    angular_noise_rad_per_s = 0.005

    def __init__(self, drift: DriftWalk, noise: np.random.Generator) -> None:
        self._drift = drift
        self._noise = noise
        self._sampled_ns: int | None = None
        self.pose = Pose(0.0, 0.0, 0.0)

    def sample(self, body: PhysicalBody) -> Published:
        """Where the robot takes itself to be."""
        self._drift.update(elapsed_s(self._sampled_ns, body.now_ns, self.rate_hz))
        self._sampled_ns = body.now_ns
        x, y, z, yaw = self._drift.offset.tolist()
        true, engine = body.engine.position, body.engine
        place = Vector(true.x + x, true.y + y, true.z + z)
        turned = Quaternion.from_yaw(yaw).then(engine.orientation)
        self.pose = Pose(place.x, place.y, turned.yaw_rad)
        velocity, turning = engine.velocity, engine.angular_velocity
        ahead, left, up = engine.rotation.T @ (velocity.x, velocity.y, velocity.z)
        noise = self._noise.standard_normal(6).tolist()
        slow, turn = self.linear_noise_m_per_s, self.angular_noise_rad_per_s
        reading = SpatialOdometry(
            stamp_ns=body.now_ns,
            child_frame=BASE_LINK,
            pose=EstimatedPose(position=place, orientation=turned, deviations=_POSE_DEVIATIONS),
            linear=Vector(
                float(ahead) + slow * noise[0], float(left) + slow * noise[1], float(up) + slow * noise[2]
            ),
            angular=Vector(
                turning.x + turn * noise[3], turning.y + turn * noise[4], turning.z + turn * noise[5]
            ),
            twist_deviations=(slow, slow, slow, turn, turn, turn),
        )
        frame = FrameTransform(ODOM_FRAME, BASE_LINK, place, turned)
        return [
            (Topic.ODOM, reading),
            (Topic.TF, Transforms(stamp_ns=body.now_ns, frames=(frame,))),
        ]


class RangeFinder:
    """An infrared range finder that looks down."""

    rate_hz = 20.0
    range_min_m = 0.03
    range_max_m = 8.0
    noise_m = 0.01
    field_of_view_rad = 0.47

    def __init__(self, noise: np.random.Generator) -> None:
        self._noise = noise

    def sample(self, body: PhysicalBody) -> Published:
        """The distance along the middle of the beam."""
        engine = body.engine
        down = -engine.rotation[:, 2]
        place = engine.position
        x, y, z = (down * RANGE_MOUNT_M).tolist()
        origin = Vector(place.x + x, place.y + y, place.z + z)
        (true_m,) = engine.cast(origin, down.reshape(1, 3), self.range_max_m).tolist()
        measured_m = true_m + self.noise_m * float(self._noise.standard_normal())
        if measured_m < self.range_min_m:
            measured_m = -np.inf
        reading = RangeReading(
            stamp_ns=body.now_ns,
            range_m=measured_m if measured_m <= self.range_max_m else np.inf,
            range_min_m=self.range_min_m,
            range_max_m=self.range_max_m,
            field_of_view_rad=self.field_of_view_rad,
        )
        return [(Topic.RANGE, reading)]
