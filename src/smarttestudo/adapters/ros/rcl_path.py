# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The data path through librcl: serialized messages in the middleware's own buffers."""

from __future__ import annotations

import ctypes
from functools import partial
from typing import Any

from smarttestudo.adapters.ros.message_info import InfoLayout
from smarttestudo.adapters.ros.message_types import decoded, is_installed, message_type
from smarttestudo.adapters.ros.qos import qos_profile
from smarttestudo.adapters.ros.rcl_buffers import RclPayload
from smarttestudo.adapters.ros.rcl_inlet import RclInlet
from smarttestudo.adapters.ros.rcl_library import RCL_RET_OK, RclLibrary
from smarttestudo.adapters.ros.rcl_subscription import RclSubscription
from smarttestudo.adapters.ros.rcl_taker import RclTaker
from smarttestudo.adapters.ros.rcl_wake_ups import RclWakeUps
from smarttestudo.adapters.ros.rclpy_part import RclpyPart
from smarttestudo.adapters.ros.ros_errors import ros_errors
from smarttestudo.domain.errors import RosError
from smarttestudo.domain.payload import Payload
from smarttestudo.domain.robot import Inlet, Outlet, Qos, Receive


class RclPath:
    """Subscriptions whose messages rclpy's executor never sees, and publishers that take them as they are."""

    def __init__(
        self, node: Any, executor: Any, library: RclLibrary, layout: InfoLayout, operators: Any
    ) -> None:
        self._node = node
        self._operators = operators
        self._library = library
        self._layout = layout
        self._failures: set[str] = set()
        self._wake_ups = RclWakeUps()
        self._rclpy_part = RclpyPart(node, executor, library, self._wake_ups)

    @property
    def description(self) -> str:
        """Which path this is, and what it can do."""
        publishers = "publishers told apart" if self.tells_publishers else "publishers not told apart"
        return f"librcl, {publishers}, messages {'' if self.can_rest else 'not '}numbered"

    @property
    def tells_publishers(self) -> bool:
        """Whether ``receive`` is told the publisher of each message: its GID."""
        return self._layout.gid_bytes > 0

    @property
    def can_rest(self) -> bool:
        """Whether inlets can rest, and still say how much their source sends."""
        return self._layout.is_numbered

    def knows(self, type_name: str) -> bool:
        """Whether the message type is installed."""
        return is_installed(type_name)

    def subscribe(
        self, topic: str, type_name: str, qos: Qos, receive: Receive, *, priority: float = 1.0
    ) -> Inlet:
        """Have ``receive`` called with each message. Raises ``RosError``."""
        return RclInlet(
            partial(RclSubscription, self._node, self._library, topic, type_name),
            qos,
            receive,
            taker=RclTaker(self._library, self._layout, self._failed),
            wake_ups=self._wake_ups,
            priority=priority,
        )

    def advertise(self, topic: str, type_name: str, qos: Qos) -> Outlet:
        """Publish on ``topic``. Raises ``RosError``."""
        return RclOutlet(self._operators, self._library, topic, type_name, qos)

    def decode(self, topic: str, type_name: str, payload: Payload) -> object:
        """The message of a payload that came on ``topic``. Raises ``RosError``."""
        return decoded(topic, type_name, payload)

    def wait(self, timeout_s: float) -> None:
        """Deliver what comes next; return after it or after ``timeout_s``."""
        self._wake_ups.wait(timeout_s)
        self._rclpy_part.look()

    def close(self) -> None:
        """Deliver nothing more."""
        self._rclpy_part.close()
        self._wake_ups.close()

    def _failed(self, error: RosError) -> None:
        if str(error) not in self._failures:
            self._failures.add(str(error))
            self._node.get_logger().warning(str(error))


class RclOutlet:
    """A publisher of rclpy that is given serialized messages by librcl, on any node."""

    def __init__(self, node: Any, library: RclLibrary, topic: str, type_name: str, qos: Qos) -> None:
        self._node = node
        self._library = library
        self._topic = topic
        with ros_errors(topic):
            self._handle = node.create_publisher(message_type(type_name, topic), topic, qos_profile(qos))
        self._pointer: int = self._handle.handle.pointer
        self._foreign = library.new_message()

    def publish(self, payload: Payload) -> None:
        """Send a serialized message. Raises ``RosError``."""
        if isinstance(payload, RclPayload):
            self._publish(payload.address)
            return
        data = payload[:]
        foreign = self._foreign
        foreign.buffer = ctypes.cast(ctypes.c_char_p(data), ctypes.c_void_p)
        foreign.length = foreign.capacity = len(data)
        self._publish(ctypes.addressof(foreign))

    def close(self) -> None:
        """Send nothing more."""
        self._node.destroy_publisher(self._handle)

    def _publish(self, address: int) -> None:
        code = self._library.publish(self._pointer, address, None)
        if code != RCL_RET_OK:
            raise self._library.error(code, self._topic)
