# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The data path that needs nothing but rclpy's public interface, and topics that no other can take."""

from __future__ import annotations

import time
from collections.abc import Callable, Hashable
from contextlib import ExitStack
from typing import Any

from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.serialization import deserialize_message, serialize_message

from smarttestudo.domain.errors import RosError
from smarttestudo.domain.robot import Payload, Publisher, Qos, Receive, Subscription
from smarttestudo.domain.texts import SayOnce
from smarttestudo.robot.ros.message_types import decoded, has_byte_sequence, is_installed, message_type
from smarttestudo.robot.ros.qos import qos_profile
from smarttestudo.robot.ros.ros_errors import ros_errors

_TEST_TOPIC = "~/_self_test_bytes"
"""Hidden and private; it exists for some milliseconds."""
# Of the packages that a robot can be expected to have, only these have such a type.
_TEST_TYPES = ("std_msgs/msg/UInt8MultiArray", "sensor_msgs/msg/CompressedImage")
_TEST_TIMEOUT_S = 2.0
_TEST_ROUND_S = 0.05
# Not latched, since in some versions nothing latched arrives by those channels (ros2/rmw_fastrtps#898).
_TEST_QOS = Qos(reliable=True, transient_local=False, depth=1)


class SameTimeout(float):
    """A timeout that equals all others: for another one, rclpy's executor forgets what else is ready."""

    def __eq__(self, other: object) -> bool:
        return isinstance(other, float)

    __hash__ = float.__hash__


class RclpyPath:
    """Raw subscriptions of a node, none of which pauses, and publishers of the node ``operators``."""

    identifies_publishers = False
    can_pause = False
    keeps_newest = False
    reports_graph = False
    compiled = None

    def __init__(self, node: Any, executor: Any, operators: Any, byte_topics: ByteTopics, why: str) -> None:
        self.description = f"rclpy, {why}"
        self._node = node
        self._operators = operators
        self._executor = executor
        self._byte_topics = byte_topics
        self._warn_once = SayOnce(lambda line: node.get_logger().warning(line))

    def knows(self, type_name: str) -> bool:
        return is_installed(type_name)

    def subscribe(
        self,
        topic: str,
        type_name: str,
        qos: Qos,
        receive: Receive,
        *,
        priority: float = 1.0,  # noqa: ARG002 - rclpy's executor serves all alike
    ) -> Subscription:
        """Have ``receive`` called with each message; ``priority`` is not heeded. Raises ``RosError``."""
        if self._byte_topics.must_be_decoded(type_name):
            return self._byte_topics.subscribe(topic, type_name, qos, receive)
        return RclpySubscription(self._node, topic, type_name, qos, receive, is_decoded=False)

    def advertise(self, topic: str, type_name: str, qos: Qos) -> Publisher:
        return RclpyPublisher(self._operators, topic, type_name, qos)

    def decode(self, topic: str, type_name: str, payload: Payload) -> object:
        return decoded(topic, type_name, payload)

    def wait(self, timeout_s: float) -> None:
        """Deliver what comes next; return after it or after ``timeout_s``."""
        try:
            self._executor.spin_once(timeout_sec=SameTimeout(timeout_s))
        except RuntimeError as error:
            # What rcl cannot take costs its topic, which alone is in its callback group.
            self._warn_once(f"a message cannot be taken: {(str(error).splitlines() or [''])[0]}")


class RclpySubscription:
    """A subscription of rclpy, taken as bytes or, where ``is_decoded``, as messages that become bytes again.

    Raises ``RosError`` where it cannot be opened.
    """

    sent = None
    dropped = 0

    def __init__(
        self, node: Any, topic: str, type_name: str, qos: Qos, receive: Receive, *, is_decoded: bool
    ) -> None:
        def received(message: Any) -> None:
            receive(serialize_message(message) if is_decoded else message, None)

        self._node = node
        self._topic = topic
        with ros_errors(topic):
            self._handle = node.create_subscription(
                message_type(type_name, topic),
                topic,
                received,
                qos_profile(qos),
                callback_group=ReentrantCallbackGroup(),
                raw=not is_decoded,
            )

    def close(self) -> None:
        """Receive nothing more. Raises ``RosError``."""
        with ros_errors(self._topic):
            self._node.destroy_subscription(self._handle)


class RclpyPublisher:
    """A publisher of ``node`` for serialized messages. Raises ``RosError``."""

    def __init__(self, node: Any, topic: str, type_name: str, qos: Qos) -> None:
        self._node = node
        self._topic = topic
        with ros_errors(topic):
            self._handle = node.create_publisher(message_type(type_name, topic), topic, qos_profile(qos))

    def publish(self, payload: Payload) -> None:
        with ros_errors(self._topic):
            self._handle.publish(payload[:])

    def close(self) -> None:
        """Send nothing more. Raises ``RosError``."""
        with ros_errors(self._topic):
            self._node.destroy_publisher(self._handle)


class ByteTopics:
    """Subscribes to topics with ``uint8[]`` that must be decoded, and logs once what that costs.

    In Lyrical such types are buffer-aware: a publisher all of whose subscribers are so writes to channels of
    their own, which what takes serialized messages does not read (ros2/rmw_fastrtps#881).
    """

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


def come_serialized(
    node: Any, spin_once: Callable[[float], None], *, timeout_s: float = _TEST_TIMEOUT_S
) -> bool:
    """Whether a message with ``uint8[]`` that is published as any other can be taken serialized.

    Not where none of the types to try it with is installed, or it cannot be tried.
    """
    type_name = next(filter(is_installed, _TEST_TYPES), None)
    if type_name is None:
        return False
    kind = message_type(type_name, _TEST_TOPIC)
    sent = kind(data=[1, 2, 3])
    received: list[bytes] = []

    def receive(payload: Payload, _publisher: Hashable) -> None:
        received.append(payload[:])

    try:
        with ExitStack() as opened, ros_errors(_TEST_TOPIC):
            subscription = RclpySubscription(
                node, _TEST_TOPIC, type_name, _TEST_QOS, receive, is_decoded=False
            )
            opened.callback(subscription.close)
            publisher = node.create_publisher(kind, _TEST_TOPIC, qos_profile(_TEST_QOS))
            opened.callback(node.destroy_publisher, publisher)
            end_s = time.monotonic() + timeout_s
            while not received and time.monotonic() < end_s:
                publisher.publish(sent)
                spin_once(_TEST_ROUND_S)
            return bool(received) and deserialize_message(received[0], kind) == sent
    except RosError:
        return False
