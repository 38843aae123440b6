# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A source, as rclpy's executor receives it."""

from __future__ import annotations

from typing import Any

from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.serialization import serialize_message

from smarttestudo.domain.robot import Qos, Receive
from smarttestudo.robot.ros.message_types import message_type
from smarttestudo.robot.ros.qos import qos_profile
from smarttestudo.robot.ros.ros_errors import ros_errors


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

    def pause(self) -> None:
        """Do nothing: rclpy's executor wakes for every message."""

    def arm(self) -> None:
        """Go on, since it never rests."""

    def take_pending(self) -> bool:
        """Whether anything was kept, which it never is."""
        return False

    def resume(self) -> None:
        """Go on, since it never rests."""

    def close(self) -> None:
        """Receive nothing more. Raises ``RosError``."""
        with ros_errors(self._topic):
            self._node.destroy_subscription(self._handle)
