# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Names of topics as ROS has them."""

from __future__ import annotations

from typing import Any

from smarttestudo.robot.ros.ros_errors import ros_errors


def full_name(node: Any, topic: str) -> str:
    """The full name of ``topic`` in the namespace of ``node``, remapped. Raises ``RosError``."""
    with ros_errors(topic):
        name: str = node.resolve_topic_name(topic)
    return name
