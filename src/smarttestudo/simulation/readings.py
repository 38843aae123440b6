# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Readings of the simulated robot's devices."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from smarttestudo.simulation.geometry import BodyVelocity, FrameTransform, Pose, Quaternion, Vector

Pixels = NDArray[np.uint8]


class Topic(Enum):
    """The robot's topics."""

    AMCL_POSE = "/amcl_pose"
    BATTERY_STATE = "/battery_state"
    CMD_VEL = "/cmd_vel"
    ODOM = "/odom"
    CAMERA_INFO = "/camera/camera_info"
    COMPRESSED_IMAGE = "/camera/image_raw/compressed"
    IMAGE = "/camera/image_raw"
    IMU = "/imu"
    JOINT_STATES = "/joint_states"
    RANGE = "/range"
    SCAN = "/scan"
    TF = "/tf"
    TF_STATIC = "/tf_static"


CAMERA_TOPICS = (Topic.CAMERA_INFO, Topic.COMPRESSED_IMAGE, Topic.IMAGE)
PATROL_TOPICS = tuple(
    topic for topic in Topic if topic not in (Topic.AMCL_POSE, Topic.BATTERY_STATE, Topic.RANGE)
)
"""Those of the thesis's robot; the others belong to robots with physics."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Command:
    """The velocity that the navigator asks of the wheels."""

    velocity: BodyVelocity


@dataclass(frozen=True, slots=True, kw_only=True)
class Odometry:
    """Where the robot is in the odometry frame and how it moves, with the noise's standard deviations."""

    stamp_ns: int
    pose: Pose
    velocity: BodyVelocity
    linear_noise_m_per_s: float
    angular_noise_rad_per_s: float


@dataclass(frozen=True, slots=True, kw_only=True)
class EstimatedPose:
    """A place in metres and a rotation, with standard deviations of x, y, z, roll, pitch and yaw."""

    position: Vector
    orientation: Quaternion
    deviations: tuple[float, float, float, float, float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class SpatialOdometry:
    """Where a robot takes itself to be in the odometry frame, and how it moves along its own axes.

    ``twist_deviations`` are standard deviations of the six speeds, in m/s and rad/s.
    """

    stamp_ns: int
    child_frame: str
    pose: EstimatedPose
    linear: Vector
    angular: Vector
    twist_deviations: tuple[float, float, float, float, float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Localization:
    """Where a robot takes itself to be on its map."""

    stamp_ns: int
    pose: EstimatedPose


@dataclass(frozen=True, slots=True, kw_only=True)
class BatteryLevelReading:
    """A battery: its state in V, A and Ah, and the share of its charge that is left."""

    stamp_ns: int
    voltage_v: float
    current_a: float
    share: float
    capacity_ah: float


@dataclass(frozen=True, slots=True, kw_only=True)
class RangeReading:
    """The distance that a range finder of a narrow beam measures; infinite where nothing is in range."""

    stamp_ns: int
    range_m: float
    range_min_m: float
    range_max_m: float
    field_of_view_rad: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Lens:
    """A pinhole camera of ``width`` × ``height`` pixels, read out in blocks of ``binning`` × ``binning``.

    ``focal_px`` counts in pixels of the whole sensor.
    """

    width: int
    height: int
    focal_px: float
    binning: int

    @property
    def image_size(self) -> tuple[int, int]:
        """Width and height of the images, in pixels."""
        return self.width // self.binning, self.height // self.binning


@dataclass(frozen=True, slots=True, kw_only=True)
class CameraInfo:
    """The calibration that belongs to the image of the same stamp."""

    stamp_ns: int
    lens: Lens


@dataclass(frozen=True, slots=True, kw_only=True)
class Image:
    """A view: height × width × RGB, 8 bit each. The same array comes again until the view changes."""

    stamp_ns: int
    pixels: Pixels


@dataclass(frozen=True, slots=True, kw_only=True)
class CompressedImage(Image):
    """A view that is to be sent compressed."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Imu:
    """Rotation, angular velocity (rad/s) and specific force (m/s², gravity included) of the robot's body.

    ``orientation_noise_rad`` has the standard deviations of roll, pitch and yaw.
    """

    stamp_ns: int
    orientation: Quaternion
    angular_velocity: Vector
    linear_acceleration: Vector
    orientation_noise_rad: tuple[float, float, float]
    angular_noise_rad_per_s: float
    linear_noise_m_per_s2: float


@dataclass(frozen=True, slots=True, kw_only=True)
class JointStates:
    """The wheels, left first: angles in radians, speeds in rad/s."""

    stamp_ns: int
    positions_rad: tuple[float, float]
    velocities_rad_per_s: tuple[float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Scan:
    """One turn of the LiDAR, anticlockwise from straight ahead; infinite where nothing is in range."""

    stamp_ns: int
    ranges_m: NDArray[np.float32]
    range_min_m: float
    range_max_m: float
    turn_s: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Transforms:
    """Every frame of the robot at one time."""

    stamp_ns: int
    frames: tuple[FrameTransform, ...]


Reading = (
    Command
    | Odometry
    | SpatialOdometry
    | Localization
    | CameraInfo
    | Image
    | CompressedImage
    | Imu
    | JointStates
    | Scan
    | Transforms
    | BatteryLevelReading
    | RangeReading
)


@dataclass(frozen=True, slots=True, kw_only=True)
class TimedReading:
    """A reading as it arrives on its topic at ``time_ns``."""

    time_ns: int
    topic: Topic
    reading: Reading
