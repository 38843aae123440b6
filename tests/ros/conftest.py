# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""One ROS domain for each test run."""

from __future__ import annotations

import fcntl
import importlib.util
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from ros.ros_processes import SmallRobot

# Domains above have ports that Linux gives to others.
DOMAINS = range(1, 102)


@contextmanager
def free_domain() -> Iterator[int]:
    for number in DOMAINS:
        with (Path(tempfile.gettempdir()) / f"smarttestudo-test-domain-{number}").open("w") as lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                continue
            yield number
            return
    pytest.fail("all ROS domains are taken by other test runs")


@pytest.fixture(scope="session")
def domain() -> Iterator[int]:
    """A domain that no other test run on this machine has."""
    with free_domain() as number:
        yield number


@pytest.fixture(scope="session")
def other_domain(domain: int) -> Iterator[int]:
    """One more."""
    with free_domain() as number:
        yield number


@pytest.fixture
def robot(domain: int, tmp_path: Path) -> Iterator[SmallRobot]:
    if importlib.util.find_spec("rclpy") is None:
        pytest.skip("ROS 2 (rclpy) is not installed")
    small_robot = SmallRobot(domain, tmp_path)
    yield small_robot
    small_robot.end()
