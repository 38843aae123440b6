# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""One ROS domain for each test run."""

from __future__ import annotations

import importlib.util
import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from ros.ros_processes import SmallRobot


@pytest.fixture
def robot(tmp_path: Path) -> Iterator[SmallRobot]:
    if importlib.util.find_spec("rclpy") is None:
        pytest.skip("ROS 2 (rclpy) is not installed")
    # Domains up to 101 have ports below those that Linux gives to others.
    small_robot = SmallRobot(1 + os.getpid() % 101, tmp_path)
    yield small_robot
    small_robot.end()
