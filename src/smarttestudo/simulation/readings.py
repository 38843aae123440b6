# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the simulated robot's devices read."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from smarttestudo.simulation.geometry import BodyVelocity, FrameTransform, Pose, Vector
from smarttestudo.simulation.robot import DifferentialDrive


class Device(Protocol):
    """Something that looks at the robot ``rate_hz`` times a second and publishes what it saw."""

    @property
    def rate_hz(self) -> float:
        """How often it is sampled."""

    def sample(self, drive: DifferentialDrive) -> Sequence[tuple[Topic, Reading]]:
        """What it publishes now; called once each period, in time order."""


Pixels = NDArray[np.uint8]


class Topic(Enum):
    """The robot's topics."""

    CMD_VEL = "/cmd_vel"
    ODOM = "/odom"
    CAMERA_INFO = "/camera/camera_info"
    COMPRESSED_IMAGE = "/camera/image_raw/compressed"
    IMAGE = "/camera/image_raw"
    IMU = "/imu"
    JOINT_STATES = "/joint_states"
    SCAN = "/scan"
    TF = "/tf"
    TF_STATIC = "/tf_static"


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
    """Heading, angular velocity (rad/s) and specific force (m/s², gravity included) of the robot's body."""

    stamp_ns: int
    yaw_rad: float
    angular_velocity: Vector
    linear_acceleration: Vector
    yaw_noise_rad: float
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


Reading = Command | Odometry | CameraInfo | Image | CompressedImage | Imu | JointStates | Scan | Transforms


@dataclass(frozen=True, slots=True, kw_only=True)
class TimedReading:
    """A reading as it arrives on its topic at ``time_ns``."""

    time_ns: int
    topic: Topic
    reading: Reading
