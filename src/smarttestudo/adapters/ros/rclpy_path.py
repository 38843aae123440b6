# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The data path that needs nothing but rclpy's public interface."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from rclpy.serialization import deserialize_message

from smarttestudo.adapters.ros.message_types import message_type
from smarttestudo.adapters.ros.qos import qos_profile
from smarttestudo.domain.errors import RosError
from smarttestudo.domain.payload import Payload
from smarttestudo.domain.robot import Inlet, Outlet, Qos, Receive


class RclpyPath:
    """Raw subscriptions and publishers of a node."""

    tells_publishers = False
    can_rest = False

    def __init__(self, node: Any) -> None:
        self._node = node

    def knows(self, type_name: str) -> bool:
        """Whether the message type is installed."""
        try:
            message_type(type_name, type_name)
        except RosError:
            return False
        return True

    def subscribe(
        self,
        topic: str,
        type_name: str,
        qos: Qos,
        receive: Receive,
        *,
        priority: int = 0,  # noqa: ARG002 - rclpy's executor serves all alike
    ) -> Inlet:
        """Have ``receive`` called with each message; ``priority`` is not heeded. Raises ``RosError``."""

        def received(payload: bytes) -> None:
            receive(payload, None)

        with ros_errors(topic):
            handle = self._node.create_subscription(
                message_type(type_name, topic), topic, received, qos_profile(qos), raw=True
            )
        return _Inlet(self._node, handle)

    def advertise(self, topic: str, type_name: str, qos: Qos) -> Outlet:
        """Publish on ``topic``. Raises ``RosError``."""
        with ros_errors(topic):
            handle = self._node.create_publisher(message_type(type_name, topic), topic, qos_profile(qos))
        return _Outlet(self._node, handle, topic)

    def decode(self, topic: str, type_name: str, payload: Payload) -> object:
        """The message of a payload that came on ``topic``. Raises ``RosError``."""
        with ros_errors(topic):
            message: object = deserialize_message(payload[:], message_type(type_name, topic))
        return message


class _Inlet:
    sent = None
    dropped = 0

    def __init__(self, node: Any, handle: Any) -> None:
        self._node = node
        self._handle = handle

    def rest(self) -> None:
        return

    def work(self) -> None:
        return

    def take_newest(self) -> bool:
        return False

    def close(self) -> None:
        self._node.destroy_subscription(self._handle)


class _Outlet:
    def __init__(self, node: Any, handle: Any, topic: str) -> None:
        self._node = node
        self._handle = handle
        self._topic = topic

    def publish(self, payload: Payload) -> None:
        with ros_errors(self._topic):
            self._handle.publish(payload[:])

    def close(self) -> None:
        self._node.destroy_publisher(self._handle)


@contextmanager
def ros_errors(place: str | None = None) -> Iterator[None]:
    """Make a ``RosError`` of what rclpy raises in the block."""
    try:
        yield
    except RuntimeError as error:
        # All errors of rcl and the middleware are RuntimeErrors; only their first line is for people.
        cause = (str(error).splitlines() or [type(error).__name__])[0]
        raise RosError(cause, place=place) from error
