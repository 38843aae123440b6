# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Topics with ``uint8[]``, where their messages cannot be taken serialized.

In Lyrical such types are buffer-aware: a publisher all of whose subscribers are so writes to channels of
their own, which what takes serialized messages does not read (ros2/rmw_fastrtps#881).
"""

from __future__ import annotations

import time
from collections.abc import Callable, Hashable
from contextlib import ExitStack
from typing import Any

from rclpy.serialization import deserialize_message

from smarttestudo.domain.errors import RosError
from smarttestudo.domain.robot import Payload, Qos, Receive, Subscription
from smarttestudo.robot.ros.message_types import has_byte_sequence, is_installed, message_type
from smarttestudo.robot.ros.qos import qos_profile
from smarttestudo.robot.ros.rclpy_path import RclpySubscription
from smarttestudo.robot.ros.ros_errors import ros_errors

TOPIC = "~/_self_test_bytes"
"""Hidden and private; it exists for some milliseconds."""
# Of the packages that a robot can be expected to have, only these have such a type.
TYPE_NAMES = ("std_msgs/msg/UInt8MultiArray", "sensor_msgs/msg/CompressedImage")
TIMEOUT_S = 2.0
_ROUND_S = 0.05
# Not latched, since in some versions nothing latched arrives by those channels (ros2/rmw_fastrtps#898).
_QOS = Qos(reliable=True, transient_local=False, depth=1)


class ByteTopics:
    """Subscribes to topics that must be decoded, and logs once what that costs."""

    def __init__(self, node: Any, *, come_serialized: bool) -> None:
        self._node = node
        self._come_serialized = come_serialized
        self._is_said = False

    def must_be_decoded(self, type_name: str) -> bool:
        """Whether nothing would come of messages of that type, were they not decoded."""
        return not self._come_serialized and has_byte_sequence(type_name)

    def subscribe(self, topic: str, type_name: str, qos: Qos, receive: Receive) -> Subscription:
        """Have ``receive`` called with each message, serialized again. Raises ``RosError``."""
        subscription = RclpySubscription(self._node, topic, type_name, qos, receive, is_decoded=True)
        if not self._is_said:
            self._is_said = True
            self._node.get_logger().warning(
                f"{topic}: this ROS 2 does not deliver messages with uint8[] serialized, so topics of such "
                "types are decoded and serialized again: at a higher cost, their publishers not told apart, "
                "their losses not counted"
            )
        return subscription


def come_serialized(node: Any, spin_once: Callable[[float], None], *, timeout_s: float = TIMEOUT_S) -> bool:
    """Whether a message with ``uint8[]`` that is published as any other can be taken serialized.

    Not where none of the types to try it with is installed, or it cannot be tried.
    """
    type_name = next(filter(is_installed, TYPE_NAMES), None)
    if type_name is None:
        return False
    kind = message_type(type_name, TOPIC)
    sent = kind(data=[1, 2, 3])
    came: list[bytes] = []

    def receive(payload: Payload, _publisher: Hashable) -> None:
        came.append(payload[:])

    try:
        with ExitStack() as opened, ros_errors(TOPIC):
            subscription = RclpySubscription(node, TOPIC, type_name, _QOS, receive, is_decoded=False)
            opened.callback(subscription.close)
            publisher = node.create_publisher(kind, TOPIC, qos_profile(_QOS))
            opened.callback(node.destroy_publisher, publisher)
            end_s = time.monotonic() + timeout_s
            while not came and time.monotonic() < end_s:
                publisher.publish(sent)
                spin_once(_ROUND_S)
            return bool(came) and deserialize_message(came[0], kind) == sent
    except RosError:
        return False
