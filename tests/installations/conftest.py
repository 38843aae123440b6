# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from installations.environments import ROOT, Environment, copy_checkout, make_environment, ros_packages
from made_once import made_once
from ros.conftest import domain, endpoint, robot
from ros_package.conftest import installed

__all__ = ["domain", "endpoint", "installed", "robot"]

MakeEnvironment = Callable[..., Environment]


@pytest.fixture(scope="session")
def checkout(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return made_once(tmp_path_factory, "checkout", copy_checkout)


@pytest.fixture
def environment(checkout: Path, tmp_path_factory: pytest.TempPathFactory, tmp_path: Path) -> MakeEnvironment:
    """Makes environments, each once for all tests; its commands run in a folder of the test's own."""
    desk = tmp_path / "desk"
    shutil.copytree(ROOT / "examples", desk)

    def make(name: str, *requirements: str) -> Environment:
        folder = made_once(
            tmp_path_factory,
            f"with-{name}",
            lambda path: make_environment(path, checkout, *requirements),
        )
        return Environment(folder=folder, desk=desk)

    return make


@pytest.fixture
def bare(environment: MakeEnvironment) -> Environment:
    """The standard library alone."""
    return environment("nothing", ".")


@pytest.fixture
def with_rclpy(environment: MakeEnvironment, installed: Path) -> Environment:
    """A robot's workspace that colcon built, with a Python that has rclpy and nothing else."""
    return replace(environment("rclpy", *ros_packages()), workspace=installed)


@pytest.fixture
def with_link(environment: MakeEnvironment) -> Environment:
    return environment("link", ".[link]")


@pytest.fixture
def with_studio(environment: MakeEnvironment) -> Environment:
    return environment("studio", ".[studio]")


@pytest.fixture
def with_metrics(environment: MakeEnvironment) -> Environment:
    """A robot that Prometheus asks."""
    return environment("metrics", ".[metrics]", *ros_packages())


@pytest.fixture
def with_ros(environment: MakeEnvironment) -> Environment:
    return environment("ros", ".[ros]")
