# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The sensors of the robot's own motion, rays through the warehouse, and the laser scanner made of them.

Noise is Gaussian; the IMU's is that of ``turtlebot3_waffle_pi/model.sdf`` of ``turtlebot3_gazebo``.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic

import numpy as np
from numpy.typing import NDArray

from smarttestudo.domain.floor_plan import FloorPlan, Point
from smarttestudo.simulation import messages
from smarttestudo.simulation.geometry import FrameTransform, Quaternion, Vector
from smarttestudo.simulation.messages import Published, RobotTopic
from smarttestudo.simulation.robot import BASE_FRAME, ODOM_FRAME, BodyT, DifferentialDrive, wheel_frames

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
        twist = messages.estimated_twist(
            Vector(linear, 0.0, 0.0), Vector(0.0, 0.0, angular), self.twist_deviations
        )
        pose = messages.estimated_pose(*_floor_pose(drive), (0.0,) * 6)
        return [(RobotTopic.ODOM, messages.odometry(drive.now_ns, BASE_FRAME, pose, twist))]


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
        return [(RobotTopic.IMU, messages.imu(drive.now_ns, orientation, angular, linear, deviations))]


class WheelEncoders:
    """The angles and speeds of the wheels."""

    rate_hz = 5.0

    def sample(self, drive: DifferentialDrive) -> Published:
        speeds = [rim / drive.model.wheel_radius_m for rim in drive.rim_m_per_s]
        return [(RobotTopic.JOINT_STATES, messages.joint_states(drive.now_ns, drive.angles_rad, speeds))]


class OdometryFrame:
    """Where the robot is in the odometry frame, as the drive of Gazebo publishes it beside its odometry."""

    rate_hz = Odometer.rate_hz

    def sample(self, drive: DifferentialDrive) -> Published:
        base = FrameTransform(ODOM_FRAME, BASE_FRAME, *_floor_pose(drive))
        return [(RobotTopic.TF, messages.transforms(drive.now_ns, [base]))]


class WheelFrames:
    """Both wheels, as robot_state_publisher makes them of each message with the wheels' angles."""

    rate_hz = WheelEncoders.rate_hz

    def sample(self, drive: DifferentialDrive) -> Published:
        return [
            (RobotTopic.TF, messages.transforms(drive.now_ns, wheel_frames(drive.model, drive.angles_rad)))
        ]


def _floor_pose(drive: DifferentialDrive) -> tuple[Vector, Quaternion]:
    return Vector(drive.pose.x_m, drive.pose.y_m, 0.0), Quaternion.from_yaw(drive.pose.yaw_rad)


Floats = NDArray[np.float64]
Indices = NDArray[np.intp]


@dataclass(frozen=True, slots=True, kw_only=True)
class Hits:
    """Per ray: the distance in metres (infinite where nothing is met) and the obstacle's index (else -1)."""

    distances_m: Floats
    obstacles: Indices


class RayCaster:
    """Casts rays against the sides of every obstacle of a floor plan."""

    def __init__(self, plan: FloorPlan) -> None:
        self.plan = plan
        corners = np.array(
            [[(c.x_m, c.y_m) for c in obstacle.footprint.corners] for obstacle in plan.obstacles]
        )
        self._starts_m = corners.reshape(-1, 2)
        self._sides_m = (np.roll(corners, -1, axis=1) - corners).reshape(-1, 2)
        self._obstacles = np.repeat(np.arange(len(plan.obstacles)), 4)

    def cast(self, origin: Point, bearings_rad: Floats, *, range_m: float) -> Hits:
        """The first hit of each ray from ``origin``, up to ``range_m`` away.

        With ray o + t·d and side a + u·e: t = (a−o)×e / d×e and u = (a−o)×d / d×e, a hit where t ≥ 0 and
        0 ≤ u ≤ 1. Rays along a side miss it; they hit the sides at its ends.
        """
        near = self._within(origin, range_m)
        side = self._sides_m[near]
        offset = self._starts_m[near] - (origin.x_m, origin.y_m)
        ray_x, ray_y = np.cos(bearings_rad)[:, None], np.sin(bearings_rad)[:, None]
        with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
            scale = 1.0 / (ray_x * side[:, 1] - ray_y * side[:, 0])
            distance = (offset[:, 0] * side[:, 1] - offset[:, 1] * side[:, 0]) * scale
            share = (offset[:, 0] * ray_y - offset[:, 1] * ray_x) * scale
            hit = (distance >= 0) & (distance <= range_m) & (share >= 0) & (share <= 1)
        # One more column stands for meeting nothing, so that argmin always has an answer.
        distances = np.full((len(bearings_rad), len(side) + 1), np.inf)
        distances[:, :-1][hit] = distance[hit]
        nearest = distances.argmin(axis=1)
        found = np.append(self._obstacles[near], -1)[nearest]
        first = distances[np.arange(len(nearest)), nearest]
        return Hits(distances_m=first, obstacles=np.where(np.isinf(first), -1, found))

    def _within(self, origin: Point, range_m: float) -> NDArray[np.bool_]:
        """Which sides come within ``range_m`` of ``origin``."""
        to_origin = (origin.x_m, origin.y_m) - self._starts_m
        lengths_squared = (self._sides_m**2).sum(axis=1)
        share = np.clip((to_origin * self._sides_m).sum(axis=1) / lengths_squared, 0.0, 1.0)
        gap = to_origin - share[:, None] * self._sides_m
        near: NDArray[np.bool_] = (gap**2).sum(axis=1) <= range_m**2
        return near


@dataclass(frozen=True)
class Lidar(Generic[BodyT]):
    """The LDS-01: 360 rays, 0.12 to 3.5 m, five turns a second.

    ``cast`` says how far each ray truly goes, up to ``reach_m``. A turn is a snapshot, as in Gazebo. Out of
    range reads as REP 117 has it: infinite beyond, minus infinite below. The noise is that of
    ``turtlebot3_gazebo``.
    """

    cast: Callable[[BodyT], Floats]
    noise: np.random.Generator
    rate_hz = 5.0
    range_min_m = 0.12
    range_max_m = 3.5
    noise_m = 0.01
    # Noise may bring a hit just beyond the range back into it.
    reach_m = range_max_m + 4 * noise_m
    bearings_rad = np.linspace(0.0, 2 * np.pi, 360, endpoint=False)

    def sample(self, body: BodyT) -> Published:
        """One turn from where the robot is now."""
        distances_m = self.cast(body)
        ranges_m = distances_m + self.noise.normal(0.0, self.noise_m, len(distances_m))
        ranges_m[ranges_m > self.range_max_m] = np.inf
        ranges_m[ranges_m < self.range_min_m] = -np.inf
        message = messages.scan(
            body.now_ns,
            ranges_m.astype(np.float32),
            least_m=self.range_min_m,
            most_m=self.range_max_m,
            turn_s=1 / self.rate_hz,
        )
        return [(RobotTopic.SCAN, message)]


def level_cast(caster: RayCaster) -> Callable[[DifferentialDrive], Floats]:
    """Function that casts the rays of a LiDAR that is never tilted."""

    def cast(drive: DifferentialDrive) -> Floats:
        origin = drive.pose.ahead(drive.model.scan_x_m)
        bearings_rad = Lidar.bearings_rad + drive.pose.yaw_rad
        return caster.cast(origin, bearings_rad, range_m=Lidar.reach_m).distances_m

    return cast
