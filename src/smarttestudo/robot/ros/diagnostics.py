# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Diagnostics as diagnostic_msgs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from smarttestudo.domain.robot import Diagnostic
from smarttestudo.robot.ros.message_types import message_type
from smarttestudo.robot.ros.ros_errors import ros_errors

DEPTH = 10


def diagnostics_publisher(node: Any, topic: str, clock: Any) -> Callable[[Sequence[Diagnostic]], None]:
    """Sender of a DiagnosticArray, stamped by ``clock``, on ``topic``; both may raise ``RosError``."""
    array_type = message_type("diagnostic_msgs/msg/DiagnosticArray", topic)
    status_type = message_type("diagnostic_msgs/msg/DiagnosticStatus", topic)
    value_type = message_type("diagnostic_msgs/msg/KeyValue", topic)
    with ros_errors(topic):
        publisher = node.create_publisher(array_type, topic, DEPTH)

    def publish(diagnostics: Sequence[Diagnostic]) -> None:
        message = array_type()
        message.header.stamp = clock.now().to_msg()
        message.status = [
            status_type(
                level=bytes([one.level]),
                name=one.name,
                message=one.message,
                hardware_id=one.hardware_id,
                values=[value_type(key=key, value=value) for key, value in one.values.items()],
            )
            for one in diagnostics
        ]
        with ros_errors(topic):
            publisher.publish(message)

    return publish
