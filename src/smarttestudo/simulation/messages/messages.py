# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The simulated robot's readings as the messages of a ROS 2 Humble robot."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping

from rosbags.serde import SerdeError
from rosbags.typesys import Stores, get_typestore
from rosbags.typesys.store import Typestore

from smarttestudo.bags.qos import stored_qos
from smarttestudo.domain.recording import Channel
from smarttestudo.domain.robot import Payload, Qos
from smarttestudo.simulation.geometry import BodyVelocity
from smarttestudo.simulation.messages import motion, sensing, state
from smarttestudo.simulation.messages.sensing import JpegEncoder
from smarttestudo.simulation.readings import (
    PATROL_TOPICS,
    BatteryLevelReading,
    CameraInfo,
    Command,
    CompressedImage,
    Image,
    Imu,
    JointStates,
    Localization,
    Odometry,
    RangeReading,
    Reading,
    Scan,
    SpatialOdometry,
    Topic,
    Transforms,
)

_TYPE_NAMES: Mapping[Topic, str] = {
    Topic.AMCL_POSE: "geometry_msgs/msg/PoseWithCovarianceStamped",
    Topic.BATTERY_STATE: "sensor_msgs/msg/BatteryState",
    Topic.CMD_VEL: "geometry_msgs/msg/Twist",
    Topic.ODOM: "nav_msgs/msg/Odometry",
    Topic.CAMERA_INFO: "sensor_msgs/msg/CameraInfo",
    Topic.COMPRESSED_IMAGE: "sensor_msgs/msg/CompressedImage",
    Topic.IMAGE: "sensor_msgs/msg/Image",
    Topic.IMU: "sensor_msgs/msg/Imu",
    Topic.JOINT_STATES: "sensor_msgs/msg/JointState",
    Topic.RANGE: "sensor_msgs/msg/Range",
    Topic.SCAN: "sensor_msgs/msg/LaserScan",
    Topic.TF: "tf2_msgs/msg/TFMessage",
    Topic.TF_STATIC: "tf2_msgs/msg/TFMessage",
}
_TURTLEBOT3_QOS = Qos(reliable=True, transient_local=False, depth=10)
_LATCHED_QOS = Qos(reliable=True, transient_local=True, depth=1)


def qos_of(topic: Topic) -> Qos:
    """QoS that the robot offers on ``topic``."""
    return _LATCHED_QOS if topic is Topic.TF_STATIC else _TURTLEBOT3_QOS


class RobotMessages:
    """Turns readings into channels and CDR payloads.

    ``jpeg_bytes`` is the size that compressed images are to come close to; ``None`` leaves it to a usual
    JPEG quality. ``channels`` has one channel for each of ``topics``.
    """

    def __init__(
        self,
        *,
        jpeg_bytes: int | None = None,
        topics: Iterable[Topic] = PATROL_TOPICS,
        has_range_variance: bool = False,
    ) -> None:
        """``has_range_variance`` says that this ROS 2 is later than Humble, whose Range has no variance."""
        self._types = get_typestore(Stores.ROS2_HUMBLE)
        self._range_types = get_typestore(Stores.ROS2_JAZZY) if has_range_variance else self._types
        self._jpeg = JpegEncoder(jpeg_bytes)
        self._builders: Mapping[type[Reading], Callable[..., object]] = {
            Command: motion.command,
            Odometry: motion.odometry,
            SpatialOdometry: motion.spatial_odometry,
            Localization: motion.localization,
            CameraInfo: sensing.camera_info,
            CompressedImage: self._compressed_image,
            Image: sensing.image,
            Imu: motion.imu,
            JointStates: motion.joint_states,
            Scan: sensing.scan,
            Transforms: motion.transforms,
            BatteryLevelReading: state.battery_state,
            RangeReading: state.jazzy_range if has_range_variance else state.humble_range,
        }
        self.channels: Mapping[Topic, Channel] = {topic: self._channel(topic) for topic in topics}

    def payload(self, topic: Topic, reading: Reading) -> bytes:
        """The CDR of the message that carries ``reading`` on ``topic``."""
        message = self._builders[type(reading)](reading)
        return bytes(self._types_of(topic).serialize_cdr(message, _TYPE_NAMES[topic]))

    def velocity(self, payload: Payload) -> BodyVelocity:
        """The velocity that a message on /cmd_vel asks for. Raises ``ValueError`` for one that is damaged."""
        try:
            message = self._types.deserialize_cdr(payload[:], _TYPE_NAMES[Topic.CMD_VEL])
        except SerdeError as error:
            raise ValueError("it is no Twist") from error
        return motion.velocity(message)

    def _types_of(self, topic: Topic) -> Typestore:
        return self._range_types if topic is Topic.RANGE else self._types

    def _compressed_image(self, reading: CompressedImage) -> object:
        return sensing.compressed_image(reading, self._jpeg)

    def _channel(self, topic: Topic) -> Channel:
        type_name = _TYPE_NAMES[topic]
        types = self._types_of(topic)
        definition, _ = types.generate_msgdef(type_name, ros_version=2)
        return Channel(
            topic=topic.value,
            type_name=type_name,
            definition=definition,
            digest=types.hash_rihs01(type_name),
            qos=(stored_qos(qos_of(topic)),),
            serialization_format="cdr",
            transient_local=qos_of(topic).transient_local,
        )
