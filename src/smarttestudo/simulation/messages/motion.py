# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""ROS messages of the robot's own motion."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rosbags.typesys.stores.ros2_humble import builtin_interfaces__msg__Time as TimeMessage
from rosbags.typesys.stores.ros2_humble import geometry_msgs__msg__Point as PointMessage
from rosbags.typesys.stores.ros2_humble import geometry_msgs__msg__Pose as PoseMessage
from rosbags.typesys.stores.ros2_humble import (
    geometry_msgs__msg__PoseWithCovariance as PoseWithCovarianceMessage,
)
from rosbags.typesys.stores.ros2_humble import (
    geometry_msgs__msg__PoseWithCovarianceStamped as LocalizedMessage,
)
from rosbags.typesys.stores.ros2_humble import geometry_msgs__msg__Quaternion as QuaternionMessage
from rosbags.typesys.stores.ros2_humble import geometry_msgs__msg__Transform as TransformMessage
from rosbags.typesys.stores.ros2_humble import geometry_msgs__msg__TransformStamped as TransformStampedMessage
from rosbags.typesys.stores.ros2_humble import geometry_msgs__msg__Twist as TwistMessage
from rosbags.typesys.stores.ros2_humble import (
    geometry_msgs__msg__TwistWithCovariance as TwistWithCovarianceMessage,
)
from rosbags.typesys.stores.ros2_humble import geometry_msgs__msg__Vector3 as VectorMessage
from rosbags.typesys.stores.ros2_humble import nav_msgs__msg__Odometry as OdometryMessage
from rosbags.typesys.stores.ros2_humble import sensor_msgs__msg__Imu as ImuMessage
from rosbags.typesys.stores.ros2_humble import sensor_msgs__msg__JointState as JointStateMessage
from rosbags.typesys.stores.ros2_humble import std_msgs__msg__Header as HeaderMessage
from rosbags.typesys.stores.ros2_humble import tf2_msgs__msg__TFMessage as TransformsMessage

from smarttestudo.domain.units import NS_PER_S
from smarttestudo.simulation.geometry import BodyVelocity, Quaternion, Vector
from smarttestudo.simulation.readings import (
    Command,
    EstimatedPose,
    Imu,
    JointStates,
    Localization,
    Odometry,
    SpatialOdometry,
    Transforms,
)
from smarttestudo.simulation.robot import (
    BASE_FRAME,
    BASE_LINK,
    IMU_FRAME,
    MAP_FRAME,
    ODOM_FRAME,
    WHEEL_JOINTS,
)

# A robot has few sensors, each with the same noise in all of its messages.
_MATRICES_KEPT = 16


def header(stamp_ns: int, frame_id: str) -> HeaderMessage:
    """A header with the time of measurement."""
    sec, nanosec = divmod(stamp_ns, NS_PER_S)
    return HeaderMessage(stamp=TimeMessage(sec=sec, nanosec=nanosec), frame_id=frame_id)


def vector(value: Vector) -> VectorMessage:
    """A Vector3."""
    return VectorMessage(x=value.x, y=value.y, z=value.z)


def quaternion(value: Quaternion) -> QuaternionMessage:
    """A Quaternion."""
    return QuaternionMessage(x=value.x, y=value.y, z=value.z, w=value.w)


def command(reading: Command) -> TwistMessage:
    """A geometry_msgs/msg/Twist."""
    return _twist(reading.velocity)


def velocity(message: Any) -> BodyVelocity:
    """Velocity that a geometry_msgs/msg/Twist asks of a robot; ``ValueError`` for numbers that are none."""
    linear, angular = message.linear, message.angular
    numbers = (linear.x, angular.z, linear.y, linear.z)
    if not all(map(math.isfinite, numbers)):
        raise ValueError("its numbers are not all finite")
    return BodyVelocity(*numbers)


def odometry(reading: Odometry) -> OdometryMessage:
    """A nav_msgs/msg/Odometry; the pose is exact, so its covariance is zero."""
    pose = PoseMessage(
        position=PointMessage(x=reading.pose.x_m, y=reading.pose.y_m, z=0.0),
        orientation=quaternion(Quaternion.from_yaw(reading.pose.yaw_rad)),
    )
    noise = (reading.linear_noise_m_per_s, 0.0, 0.0, 0.0, 0.0, reading.angular_noise_rad_per_s)
    return OdometryMessage(
        header=header(reading.stamp_ns, ODOM_FRAME),
        child_frame_id=BASE_FRAME,
        pose=PoseWithCovarianceMessage(pose=pose, covariance=_covariance(*(0.0,) * 6)),
        twist=TwistWithCovarianceMessage(twist=_twist(reading.velocity), covariance=_covariance(*noise)),
    )


def spatial_odometry(reading: SpatialOdometry) -> OdometryMessage:
    """A nav_msgs/msg/Odometry of a pose that drifts."""
    twist = TwistMessage(linear=vector(reading.linear), angular=vector(reading.angular))
    return OdometryMessage(
        header=header(reading.stamp_ns, ODOM_FRAME),
        child_frame_id=reading.child_frame,
        pose=_pose(reading.pose),
        twist=TwistWithCovarianceMessage(twist=twist, covariance=_covariance(*reading.twist_deviations)),
    )


def localization(reading: Localization) -> LocalizedMessage:
    """A geometry_msgs/msg/PoseWithCovarianceStamped on the map."""
    return LocalizedMessage(header=header(reading.stamp_ns, MAP_FRAME), pose=_pose(reading.pose))


def imu(reading: Imu) -> ImuMessage:
    """A sensor_msgs/msg/Imu."""
    return ImuMessage(
        header=header(reading.stamp_ns, IMU_FRAME),
        orientation=quaternion(reading.orientation),
        orientation_covariance=_covariance(*reading.orientation_noise_rad),
        angular_velocity=vector(reading.angular_velocity),
        angular_velocity_covariance=_covariance(*(reading.angular_noise_rad_per_s,) * 3),
        linear_acceleration=vector(reading.linear_acceleration),
        linear_acceleration_covariance=_covariance(*(reading.linear_noise_m_per_s2,) * 3),
    )


def joint_states(reading: JointStates) -> JointStateMessage:
    """A sensor_msgs/msg/JointState without efforts, which the wheels do not measure."""
    return JointStateMessage(
        header=header(reading.stamp_ns, BASE_LINK),
        name=list(WHEEL_JOINTS),
        position=np.array(reading.positions_rad),
        velocity=np.array(reading.velocities_rad_per_s),
        effort=np.zeros(0),
    )


def transforms(reading: Transforms) -> TransformsMessage:
    """A tf2_msgs/msg/TFMessage of all frames."""
    return TransformsMessage(
        transforms=[
            TransformStampedMessage(
                header=header(reading.stamp_ns, frame.parent),
                child_frame_id=frame.child,
                transform=TransformMessage(
                    translation=vector(frame.translation), rotation=quaternion(frame.rotation)
                ),
            )
            for frame in reading.frames
        ]
    )


def _pose(pose: EstimatedPose) -> PoseWithCovarianceMessage:
    place = PointMessage(x=pose.position.x, y=pose.position.y, z=pose.position.z)
    return PoseWithCovarianceMessage(
        pose=PoseMessage(position=place, orientation=quaternion(pose.orientation)),
        covariance=_covariance(*pose.deviations),
    )


def _twist(velocity: BodyVelocity) -> TwistMessage:
    return TwistMessage(
        linear=vector(Vector(velocity.linear_m_per_s, velocity.lateral_m_per_s, velocity.climb_m_per_s)),
        angular=vector(Vector(0.0, 0.0, velocity.angular_rad_per_s)),
    )


@lru_cache(maxsize=_MATRICES_KEPT)
def _covariance(*deviations: float) -> NDArray[np.float64]:
    """The diagonal covariance matrix, row by row, of independent standard deviations; not to be changed."""
    matrix = np.zeros(len(deviations) ** 2)
    matrix[:: len(deviations) + 1] = np.square(deviations)
    matrix.flags.writeable = False
    return matrix
