# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The robot's topics, and the ROS messages on them."""

from __future__ import annotations

import io
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image as PillowImage
from rosbags.serde import SerdeError
from rosbags.typesys import Stores, get_typestore
from rosbags.typesys.store import Typestore
from rosbags.typesys.stores import ros2_humble as ros
from rosbags.typesys.stores import ros2_jazzy

from smarttestudo.bags.metadata_text import offered_qos
from smarttestudo.bags.qos import qos_profiles
from smarttestudo.domain.recording import Channel
from smarttestudo.domain.robot import Payload, Qos
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.simulation.geometry import BodyVelocity, FrameTransform, Lens, Quaternion, Vector
from smarttestudo.simulation.robot import (
    BASE_LINK,
    IMU_FRAME,
    MAP_FRAME,
    ODOM_FRAME,
    OPTICAL_FRAME,
    RANGE_FRAME,
    SCAN_FRAME,
    WHEEL_JOINTS,
)

Pixels = NDArray[np.uint8]
SixDeviations = tuple[float, float, float, float, float, float]
"""Standard deviations along x, y and z, and about them."""


class RobotTopic(Enum):
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


CAMERA_TOPICS = (RobotTopic.CAMERA_INFO, RobotTopic.COMPRESSED_IMAGE, RobotTopic.IMAGE)
PATROL_TOPICS = tuple(
    topic
    for topic in RobotTopic
    if topic not in (RobotTopic.AMCL_POSE, RobotTopic.BATTERY_STATE, RobotTopic.RANGE)
)
"""Topics of the thesis's robot; the others belong to robots with physics."""
_TYPE_NAMES: Mapping[RobotTopic, str] = {
    RobotTopic.AMCL_POSE: "geometry_msgs/msg/PoseWithCovarianceStamped",
    RobotTopic.BATTERY_STATE: "sensor_msgs/msg/BatteryState",
    RobotTopic.CMD_VEL: "geometry_msgs/msg/Twist",
    RobotTopic.ODOM: "nav_msgs/msg/Odometry",
    RobotTopic.CAMERA_INFO: "sensor_msgs/msg/CameraInfo",
    RobotTopic.COMPRESSED_IMAGE: "sensor_msgs/msg/CompressedImage",
    RobotTopic.IMAGE: "sensor_msgs/msg/Image",
    RobotTopic.IMU: "sensor_msgs/msg/Imu",
    RobotTopic.JOINT_STATES: "sensor_msgs/msg/JointState",
    RobotTopic.RANGE: "sensor_msgs/msg/Range",
    RobotTopic.SCAN: "sensor_msgs/msg/LaserScan",
    RobotTopic.TF: "tf2_msgs/msg/TFMessage",
    RobotTopic.TF_STATIC: "tf2_msgs/msg/TFMessage",
}
_TURTLEBOT3_QOS = Qos(reliable=True, transient_local=False, depth=10)
_LATCHED_QOS = Qos(reliable=True, transient_local=True, depth=1)

Published = Sequence[tuple[RobotTopic, object]]
"""Messages that a device publishes at once."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TimedMessage:
    """A message as it arrives on its topic at ``time_ns``."""

    time_ns: int
    topic: RobotTopic
    message: object


def qos_of(topic: RobotTopic) -> Qos:
    """QoS that the robot offers on ``topic``."""
    return _LATCHED_QOS if topic is RobotTopic.TF_STATIC else _TURTLEBOT3_QOS


class RobotMessages:
    """The channels of the robot's ``topics``, and the CDR of messages on them."""

    def __init__(
        self, topics: Iterable[RobotTopic] = PATROL_TOPICS, *, has_range_variance: bool = False
    ) -> None:
        """``has_range_variance`` says that this ROS 2 is later than Humble, whose Range has no variance."""
        self._types = get_typestore(Stores.ROS2_HUMBLE)
        self._range_types = get_typestore(Stores.ROS2_JAZZY) if has_range_variance else self._types
        self.channels: Mapping[RobotTopic, Channel] = {topic: self._channel(topic) for topic in topics}

    def payload(self, topic: RobotTopic, message: object) -> bytes:
        return bytes(self._types_of(topic).serialize_cdr(message, _TYPE_NAMES[topic]))

    def velocity(self, payload: Payload) -> BodyVelocity:
        """The velocity that a message on /cmd_vel asks for. Raises ``ValueError`` for a damaged message."""
        try:
            message: Any = self._types.deserialize_cdr(payload[:], _TYPE_NAMES[RobotTopic.CMD_VEL])
        except SerdeError as error:
            raise ValueError("it is no Twist") from error
        numbers = (message.linear.x, message.angular.z, message.linear.y, message.linear.z)
        if not all(map(math.isfinite, numbers)):
            raise ValueError("its numbers are not all finite")
        return BodyVelocity(*numbers)

    def _types_of(self, topic: RobotTopic) -> Typestore:
        return self._range_types if topic is RobotTopic.RANGE else self._types

    def _channel(self, topic: RobotTopic) -> Channel:
        type_name, types = _TYPE_NAMES[topic], self._types_of(topic)
        return Channel(
            topic=topic.value,
            type_name=type_name,
            definition=types.generate_msgdef(type_name, ros_version=2)[0],
            digest=types.hash_rihs01(type_name),
            qos=qos_profiles(offered_qos(qos_of(topic))),
            serialization_format="cdr",
            transient_local=qos_of(topic).transient_local,
        )


def header(stamp_ns: int, frame_id: str) -> ros.std_msgs__msg__Header:
    sec, nanosec = divmod(stamp_ns, NS_PER_S)
    stamp = ros.builtin_interfaces__msg__Time(sec=sec, nanosec=nanosec)
    return ros.std_msgs__msg__Header(stamp=stamp, frame_id=frame_id)


def command(velocity: BodyVelocity) -> ros.geometry_msgs__msg__Twist:
    """The velocity that the navigator asks of the wheels."""
    linear = Vector(velocity.linear_m_per_s, velocity.lateral_m_per_s, velocity.climb_m_per_s)
    return _twist(linear, Vector(0.0, 0.0, velocity.angular_rad_per_s))


def estimated_pose(
    position: Vector, orientation: Quaternion, deviations: SixDeviations
) -> ros.geometry_msgs__msg__PoseWithCovariance:
    """A place in metres and a rotation."""
    place = ros.geometry_msgs__msg__Point(x=position.x, y=position.y, z=position.z)
    pose = ros.geometry_msgs__msg__Pose(position=place, orientation=_quaternion(orientation))
    return ros.geometry_msgs__msg__PoseWithCovariance(pose=pose, covariance=_covariance(*deviations))


def estimated_twist(
    linear: Vector, angular: Vector, deviations: SixDeviations
) -> ros.geometry_msgs__msg__TwistWithCovariance:
    """A motion along a robot's own axes, in m/s and rad/s."""
    return ros.geometry_msgs__msg__TwistWithCovariance(
        twist=_twist(linear, angular), covariance=_covariance(*deviations)
    )


def odometry(
    stamp_ns: int,
    child_frame: str,
    pose: ros.geometry_msgs__msg__PoseWithCovariance,
    twist: ros.geometry_msgs__msg__TwistWithCovariance,
) -> ros.nav_msgs__msg__Odometry:
    """Where a robot takes itself to be in the odometry frame, and how it moves."""
    return ros.nav_msgs__msg__Odometry(
        header=header(stamp_ns, ODOM_FRAME), child_frame_id=child_frame, pose=pose, twist=twist
    )


def localization(
    stamp_ns: int, pose: ros.geometry_msgs__msg__PoseWithCovariance
) -> ros.geometry_msgs__msg__PoseWithCovarianceStamped:
    """Where a robot takes itself to be on its map."""
    return ros.geometry_msgs__msg__PoseWithCovarianceStamped(header=header(stamp_ns, MAP_FRAME), pose=pose)


def imu(
    stamp_ns: int,
    orientation: Quaternion,
    angular_velocity: Vector,
    linear_acceleration: Vector,
    deviations: tuple[tuple[float, float, float], float, float],
) -> ros.sensor_msgs__msg__Imu:
    """Rotation, angular velocity (rad/s) and specific force (m/s², gravity included) of the robot's body.

    ``deviations`` are those of roll, pitch and yaw, of each angular velocity and of each force.
    """
    orientation_rad, angular_rad_per_s, linear_m_per_s2 = deviations
    return ros.sensor_msgs__msg__Imu(
        header=header(stamp_ns, IMU_FRAME),
        orientation=_quaternion(orientation),
        orientation_covariance=_covariance(*orientation_rad),
        angular_velocity=_vector(angular_velocity),
        angular_velocity_covariance=_covariance(*(angular_rad_per_s,) * 3),
        linear_acceleration=_vector(linear_acceleration),
        linear_acceleration_covariance=_covariance(*(linear_m_per_s2,) * 3),
    )


def joint_states(
    stamp_ns: int, positions_rad: Sequence[float], velocities_rad_per_s: Sequence[float]
) -> ros.sensor_msgs__msg__JointState:
    """Both wheels, left first, without efforts, which they do not measure."""
    return ros.sensor_msgs__msg__JointState(
        header=header(stamp_ns, BASE_LINK),
        name=list(WHEEL_JOINTS),
        position=np.array(positions_rad),
        velocity=np.array(velocities_rad_per_s),
        effort=np.zeros(0),
    )


def transforms(stamp_ns: int, frames: Iterable[FrameTransform]) -> ros.tf2_msgs__msg__TFMessage:
    return ros.tf2_msgs__msg__TFMessage(
        transforms=[
            ros.geometry_msgs__msg__TransformStamped(
                header=header(stamp_ns, frame.parent),
                child_frame_id=frame.child,
                transform=ros.geometry_msgs__msg__Transform(
                    translation=_vector(frame.translation), rotation=_quaternion(frame.rotation)
                ),
            )
            for frame in frames
        ]
    )


def scan(
    stamp_ns: int, ranges_m: NDArray[np.float32], *, least_m: float, most_m: float, turn_s: float
) -> ros.sensor_msgs__msg__LaserScan:
    """One turn of a LiDAR in one instant, anticlockwise from straight ahead, with empty intensities."""
    rays = len(ranges_m)
    return ros.sensor_msgs__msg__LaserScan(
        header=header(stamp_ns, SCAN_FRAME),
        angle_min=0.0,
        angle_max=math.tau * (rays - 1) / rays,
        angle_increment=math.tau / rays,
        time_increment=0.0,
        scan_time=turn_s,
        range_min=least_m,
        range_max=most_m,
        ranges=ranges_m,
        intensities=np.zeros(rays, np.float32),
    )


def camera_info(stamp_ns: int, lens: Lens) -> ros.sensor_msgs__msg__CameraInfo:
    """The calibration of a camera without distortion; it belongs to the image of the same stamp."""
    focal, middle_x, middle_y = lens.focal_px, lens.width / 2, lens.height / 2
    return ros.sensor_msgs__msg__CameraInfo(
        header=header(stamp_ns, OPTICAL_FRAME),
        height=lens.height,
        width=lens.width,
        distortion_model="plumb_bob",
        d=np.zeros(5),
        k=np.array([focal, 0, middle_x, 0, focal, middle_y, 0, 0, 1]),
        r=np.array([1.0, 0, 0, 0, 1, 0, 0, 0, 1]),
        p=np.array([focal, 0, middle_x, 0, 0, focal, middle_y, 0, 0, 0, 1, 0]),
        binning_x=lens.binning,
        binning_y=lens.binning,
        roi=ros.sensor_msgs__msg__RegionOfInterest(
            x_offset=0, y_offset=0, height=0, width=0, do_rectify=False
        ),
    )


def image(stamp_ns: int, pixels: Pixels) -> ros.sensor_msgs__msg__Image:
    """A view: height × width × RGB, 8 bit each."""
    height, width, channels = pixels.shape
    return ros.sensor_msgs__msg__Image(
        header=header(stamp_ns, OPTICAL_FRAME),
        height=height,
        width=width,
        encoding="rgb8",
        is_bigendian=0,
        step=width * channels,
        data=pixels.reshape(-1),
    )


def compressed_image(stamp_ns: int, jpeg: Pixels) -> ros.sensor_msgs__msg__CompressedImage:
    """A JPEG, as image_transport's compressed plugin names its format."""
    return ros.sensor_msgs__msg__CompressedImage(
        header=header(stamp_ns, OPTICAL_FRAME), format="rgb8; jpeg compressed bgr8", data=jpeg
    )


_QUALITY = 80
_QUALITIES = range(1, 96)


def jpeg_of(pixels: Pixels, most_bytes: int | None) -> Pixels:
    """The bytes of a JPEG of ``pixels`` in the largest quality that stays within ``most_bytes``.

    It is that of a rate-controlled encoder; ``None`` takes the usual quality.
    """
    picture = PillowImage.fromarray(pixels)
    if most_bytes is None:
        return _jpeg(picture, _QUALITY)
    low, high = _QUALITIES.start, _QUALITIES.stop
    # Size grows with quality.
    while high - low > 1:
        middle = (low + high) // 2
        if len(_jpeg(picture, middle)) <= most_bytes:
            low = middle
        else:
            high = middle
    return _jpeg(picture, low)


def _jpeg(picture: PillowImage.Image, quality: int) -> Pixels:
    stream = io.BytesIO()
    picture.save(stream, "JPEG", quality=quality)
    return np.frombuffer(stream.getvalue(), np.uint8)


def battery_state(
    stamp_ns: int, *, voltage_v: float, current_a: float, share: float, capacity_ah: float
) -> ros.sensor_msgs__msg__BatteryState:
    """A lithium polymer battery with ``share`` of its charge left; what is not measured is NaN."""
    unknown = np.zeros(0, np.float32)
    return ros.sensor_msgs__msg__BatteryState(
        header=header(stamp_ns, BASE_LINK),
        voltage=voltage_v,
        temperature=float("nan"),
        current=-current_a,
        charge=share * capacity_ah,
        capacity=capacity_ah,
        design_capacity=capacity_ah,
        percentage=share,
        power_supply_status=ros.sensor_msgs__msg__BatteryState.POWER_SUPPLY_STATUS_DISCHARGING,
        power_supply_health=ros.sensor_msgs__msg__BatteryState.POWER_SUPPLY_HEALTH_GOOD,
        power_supply_technology=ros.sensor_msgs__msg__BatteryState.POWER_SUPPLY_TECHNOLOGY_LIPO,
        present=True,
        cell_voltage=unknown,
        cell_temperature=unknown,
        location="",
        serial_number="",
    )


def range_of(
    stamp_ns: int, range_m: float, *, least_m: float, most_m: float, field_of_view_rad: float
) -> ros2_jazzy.sensor_msgs__msg__Range:
    """The distance that a range finder of a narrow beam measures; infinite where nothing is in range.

    Its variance, which Humble's message does not have, is unknown.
    """
    return ros2_jazzy.sensor_msgs__msg__Range(
        header=header(stamp_ns, RANGE_FRAME),
        radiation_type=ros2_jazzy.sensor_msgs__msg__Range.INFRARED,
        field_of_view=field_of_view_rad,
        min_range=least_m,
        max_range=most_m,
        range=range_m,
        variance=0.0,
    )


def _twist(linear: Vector, angular: Vector) -> ros.geometry_msgs__msg__Twist:
    return ros.geometry_msgs__msg__Twist(linear=_vector(linear), angular=_vector(angular))


def _vector(value: Vector) -> ros.geometry_msgs__msg__Vector3:
    return ros.geometry_msgs__msg__Vector3(x=value.x, y=value.y, z=value.z)


def _quaternion(value: Quaternion) -> ros.geometry_msgs__msg__Quaternion:
    return ros.geometry_msgs__msg__Quaternion(x=value.x, y=value.y, z=value.z, w=value.w)


# A robot has few sensors, each with the same noise in all of its messages.
@lru_cache(maxsize=16)
def _covariance(*deviations: float) -> NDArray[np.float64]:
    """The diagonal covariance matrix, row by row, of independent standard deviations; not to be changed."""
    matrix = np.zeros(len(deviations) ** 2)
    matrix[:: len(deviations) + 1] = np.square(deviations)
    matrix.flags.writeable = False
    return matrix
