# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The simulated robot's readings as the messages of a ROS 2 Humble robot."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from rosbags.typesys import Stores, get_typestore

from smarttestudo.adapters.rosbag.qos import stored_qos
from smarttestudo.adapters.simulated_robot import motion, sensing
from smarttestudo.adapters.simulated_robot.sensing import JpegEncoder
from smarttestudo.domain.recording import Channel
from smarttestudo.domain.robot import Qos
from smarttestudo.simulation.readings import CompressedImage, Reading, Topic

_TYPE_NAMES: Mapping[Topic, str] = {
    Topic.CMD_VEL: "geometry_msgs/msg/Twist",
    Topic.ODOM: "nav_msgs/msg/Odometry",
    Topic.CAMERA_INFO: "sensor_msgs/msg/CameraInfo",
    Topic.COMPRESSED_IMAGE: "sensor_msgs/msg/CompressedImage",
    Topic.IMAGE: "sensor_msgs/msg/Image",
    Topic.IMU: "sensor_msgs/msg/Imu",
    Topic.JOINT_STATES: "sensor_msgs/msg/JointState",
    Topic.SCAN: "sensor_msgs/msg/LaserScan",
    Topic.TF: "tf2_msgs/msg/TFMessage",
    Topic.TF_STATIC: "tf2_msgs/msg/TFMessage",
}
_TURTLEBOT3_QOS = Qos(reliable=True, transient_local=False, depth=10)
_LATCHED_QOS = Qos(reliable=True, transient_local=True, depth=1)


def qos_of(topic: Topic) -> Qos:
    """What the robot offers on ``topic``."""
    return _LATCHED_QOS if topic is Topic.TF_STATIC else _TURTLEBOT3_QOS


class RobotMessages:
    """Turns readings into channels and CDR payloads.

    ``jpeg_bytes`` is the size that compressed images are to come close to; ``None`` leaves it to a usual
    JPEG quality. ``channels`` has one channel for each topic.
    """

    def __init__(self, *, jpeg_bytes: int | None = None) -> None:
        self._types = get_typestore(Stores.ROS2_HUMBLE)
        self._jpeg = JpegEncoder(jpeg_bytes)
        self._builders: Mapping[Topic, Callable[..., object]] = {
            Topic.CMD_VEL: motion.command,
            Topic.ODOM: motion.odometry,
            Topic.CAMERA_INFO: sensing.camera_info,
            Topic.COMPRESSED_IMAGE: self._compressed_image,
            Topic.IMAGE: sensing.image,
            Topic.IMU: motion.imu,
            Topic.JOINT_STATES: motion.joint_states,
            Topic.SCAN: sensing.scan,
            Topic.TF: motion.transforms,
            Topic.TF_STATIC: motion.transforms,
        }
        self.channels: Mapping[Topic, Channel] = {topic: self._channel(topic) for topic in Topic}

    def payload(self, topic: Topic, reading: Reading) -> bytes:
        """The CDR of the message that carries ``reading`` on ``topic``."""
        message = self._builders[topic](reading)
        return bytes(self._types.serialize_cdr(message, _TYPE_NAMES[topic]))

    def _compressed_image(self, reading: CompressedImage) -> object:
        return sensing.compressed_image(reading, self._jpeg)

    def _channel(self, topic: Topic) -> Channel:
        type_name = _TYPE_NAMES[topic]
        definition, _ = self._types.generate_msgdef(type_name, ros_version=2)
        return Channel(
            topic=topic.value,
            type_name=type_name,
            definition=definition,
            digest=self._types.hash_rihs01(type_name),
            qos=(stored_qos(qos_of(topic)),),
            serialization_format="cdr",
            transient_local=qos_of(topic).transient_local,
        )
