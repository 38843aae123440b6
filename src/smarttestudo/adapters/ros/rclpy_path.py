# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The data path that needs nothing but rclpy's public interface."""

from __future__ import annotations

from typing import Any

from smarttestudo.adapters.ros.message_types import decoded, is_installed, message_type
from smarttestudo.adapters.ros.qos import qos_profile
from smarttestudo.adapters.ros.ros_errors import ros_errors
from smarttestudo.domain.payload import Payload
from smarttestudo.domain.robot import Inlet, Outlet, Qos, Receive


class RclpyPath:
    """Raw subscriptions of a node, and publishers of the node ``operators``."""

    tells_publishers = False
    can_rest = False

    def __init__(self, node: Any, executor: Any, operators: Any, why: str) -> None:
        self.description = f"rclpy, {why}"
        self._node = node
        self._operators = operators
        self._executor = executor

    def knows(self, type_name: str) -> bool:
        """Whether the message type is installed."""
        return is_installed(type_name)

    def subscribe(
        self,
        topic: str,
        type_name: str,
        qos: Qos,
        receive: Receive,
        *,
        priority: float = 1.0,  # noqa: ARG002 - rclpy's executor serves all alike
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
            handle = self._operators.create_publisher(message_type(type_name, topic), topic, qos_profile(qos))
        return _Outlet(self._operators, handle, topic)

    def decode(self, topic: str, type_name: str, payload: Payload) -> object:
        """The message of a payload that came on ``topic``. Raises ``RosError``."""
        return decoded(topic, type_name, payload)

    def wait(self, timeout_s: float) -> None:
        """Deliver what comes next; return after it or after ``timeout_s``."""
        self._executor.spin_once(timeout_sec=timeout_s)

    def close(self) -> None:
        """Deliver nothing more."""


class _Inlet:
    sent = None
    dropped = 0

    def __init__(self, node: Any, handle: Any) -> None:
        self._node = node
        self._handle = handle

    def rest(self) -> None:
        return

    def rouse(self) -> None:
        return

    def take_kept(self) -> bool:
        return False

    def work(self) -> None:
        return

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
