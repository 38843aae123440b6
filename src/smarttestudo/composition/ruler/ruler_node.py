# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The Ruler's node on the ROS graph."""

from __future__ import annotations

import os
from contextlib import AbstractContextManager

from smarttestudo.adapters.ros import open_robot
from smarttestudo.domain.robot import DataPathKind, Robot


def ruler_node() -> AbstractContextManager[Robot]:
    """A node that publishes nothing of its own; entering it raises ``TestudoError`` where ROS is missing.

    It takes a few messages a second, so it goes without librcl's path and its self-test.
    """
    return open_robot(name=f"testudo_ruler_{os.getpid()}", data_path=DataPathKind.RCLPY)
