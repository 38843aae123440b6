# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A publisher that takes serialized messages as they are, past rclpy."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from typing import Any

from rclpy.callback_groups import ReentrantCallbackGroup

from smarttestudo.domain.robot import Payload, Qos
from smarttestudo.robot.ros.message_types import message_type
from smarttestudo.robot.ros.qos import qos_profile
from smarttestudo.robot.ros.rcl.bindings import RCL_RET_OK, RclLibrary, RclPayload
from smarttestudo.robot.ros.ros_errors import ros_errors


class TimedCallbackGroup(ReentrantCallbackGroup):  # type: ignore[misc]
    """Entities that rclpy's executor leaves alone unless ``is_time``."""

    def __init__(self, is_time: Callable[[], bool]) -> None:
        super().__init__()
        self._is_time = is_time

    def can_execute(self, entity: Any) -> bool:  # noqa: ARG002 - of any entity
        """Whether it is time."""
        return self._is_time()


class RclPublisher:
    """A publisher of rclpy, on any node, that librcl gives serialized messages; ``pointer`` is librcl's.

    ``events`` is the group of what rclpy warns of; without one, its executor waits for that all the time.
    """

    def __init__(
        self,
        node: Any,
        library: RclLibrary,
        topic: str,
        type_name: str,
        qos: Qos,
        *,
        events: TimedCallbackGroup | None = None,
    ) -> None:
        self._node = node
        self._library = library
        self.topic = topic
        with ros_errors(topic):
            self._handle = node.create_publisher(
                message_type(type_name, topic), topic, qos_profile(qos), callback_group=events
            )
        self.pointer: int = self._handle.handle.pointer
        self.is_reliable = qos.reliable
        self._foreign = library.new_message()
        self._end_relay: Callable[[], None] | None = None

    def serve(self, end_relay: Callable[[], None] | None) -> None:
        """Let a relay publish by it; ``end_relay`` is called before it is closed, ``None`` for no relay."""
        self._end_relay = end_relay

    def publish(self, payload: Payload) -> None:
        if isinstance(payload, RclPayload):
            self._publish(payload.address)
            return
        data = payload[:]
        foreign = self._foreign
        foreign.buffer = ctypes.cast(ctypes.c_char_p(data), ctypes.c_void_p)
        foreign.length = foreign.capacity = len(data)
        self._publish(ctypes.addressof(foreign))

    def close(self) -> None:
        """Send nothing more. Raises ``RosError``."""
        if self._end_relay is not None:
            self._end_relay()
        with ros_errors(self.topic):
            self._node.destroy_publisher(self._handle)

    def _publish(self, address: int) -> None:
        code = self._library.publish(self.pointer, address, None)
        if code != RCL_RET_OK:
            raise self._library.error(code, self.topic)
