# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""One ROS domain for each test run."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from link.zenoh.ends import free_endpoint
from ros.ros_domains import free_domain
from ros.ros_processes import SmallRobot


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
def in_domain(domain: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Nodes of this process are in the domain."""
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")


@pytest.fixture
def data_path(pytestconfig: pytest.Config) -> str:
    """How runtimes relay that name no data path; a test may be parametrized with others."""
    asked: str = pytestconfig.getoption("--data-path")
    return asked


@pytest.fixture
def robot(domain: int, tmp_path: Path, data_path: str) -> Iterator[SmallRobot]:
    small_robot = SmallRobot(domain, tmp_path, data_path=data_path)
    yield small_robot
    small_robot.end()


@pytest.fixture
def operators(robot: SmallRobot, other_domain: int, tmp_path: Path) -> Iterator[SmallRobot]:
    """Processes at the operator's, where no topic of the robot's domain is seen."""
    folder = tmp_path / "operators"
    folder.mkdir()
    there = SmallRobot(other_domain, folder)
    yield there
    there.end()


@pytest.fixture
def endpoint() -> str:
    """Where nobody listens yet."""
    return free_endpoint()
