# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""One server of the examples for all tests that change nothing in them, and the ROS domains of servers."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from ros.ros_domains import free_domain
from ros.ros_processes import SmallRobot
from ruler.ruler_server import EXAMPLES, Page, served


@pytest.fixture(scope="session", autouse=True)
def ruler_domain() -> Iterator[int]:
    """Where the servers look for robots: nobody else is there."""
    with free_domain() as number, pytest.MonkeyPatch.context() as environment:
        environment.setenv("ROS_DOMAIN_ID", str(number))
        environment.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
        yield number


@pytest.fixture(scope="session")
def examples_page(ruler_domain: int) -> Iterator[Page]:
    with served(EXAMPLES, opened="warehouse.adirf") as page:
        yield page


@pytest.fixture(scope="session")
def robot_domain() -> Iterator[int]:
    """Where robots are: the server of the examples is never told of one that has just ended."""
    with free_domain() as number:
        yield number


@pytest.fixture
def robot(
    ros: None, robot_domain: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Iterator[SmallRobot]:
    """Processes that the server of the test hears."""
    monkeypatch.setenv("ROS_DOMAIN_ID", str(robot_domain))
    small_robot = SmallRobot(robot_domain, tmp_path)
    yield small_robot
    small_robot.end()
