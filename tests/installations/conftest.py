# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from docs.code_blocks import blocks_of
from installations.environments import (
    ROOT,
    Environment,
    copy_checkout,
    does,
    make_environment,
    make_wheel,
    ros_packages,
    with_python3,
)
from made_once import made_once
from ros.conftest import data_path, domain, robot
from ros_package.conftest import installed

__all__ = ["data_path", "domain", "installed", "robot"]

MakeEnvironment = Callable[..., Environment]


@pytest.fixture(scope="session")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> str:
    (built,) = made_once(tmp_path_factory, "wheel", make_wheel).glob("*.whl")
    return str(built)


@pytest.fixture
def desk(tmp_path: Path) -> Path:
    """A folder of the test's own, with the examples."""
    return Path(shutil.copytree(ROOT / "examples", tmp_path / "desk"))


@pytest.fixture
def environment(tmp_path_factory: pytest.TempPathFactory, desk: Path) -> MakeEnvironment:
    """Makes environments, each once for all tests; its commands run in ``desk``."""

    def make(name: str, *requirements: str) -> Environment:
        def fill(folder: Path) -> None:
            make_environment(folder, *requirements)

        return Environment(folder=made_once(tmp_path_factory, f"with-{name}", fill), desk=desk)

    return make


@pytest.fixture
def bare(environment: MakeEnvironment, wheel: str) -> Environment:
    """The standard library alone."""
    return environment("nothing", wheel)


@pytest.fixture
def with_rclpy(environment: MakeEnvironment, installed: Path) -> Environment:
    """A robot's workspace that colcon built, with a Python that has rclpy and nothing else."""
    return replace(environment("rclpy", *ros_packages()), workspace=installed)


@pytest.fixture
def with_link(environment: MakeEnvironment, wheel: str) -> Environment:
    return environment("link", f"{wheel}[link]")


@pytest.fixture
def checkout_with_studio(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A checkout in which somebody installed what the documentation's first page says."""

    def install(folder: Path) -> None:
        copy_checkout(folder)
        block = next(block for block in blocks_of("docs/index.md") if block.language == "sh")
        for line in block.commands[:-1]:
            does(["sh", "-ec", line], cwd=folder, variables=with_python3())

    return made_once(tmp_path_factory, "checkout-with-studio", install)


@pytest.fixture
def with_studio(checkout_with_studio: Path, desk: Path) -> Environment:
    return Environment(folder=checkout_with_studio / "testudo-venv", desk=desk)


@pytest.fixture
def with_fleet(environment: MakeEnvironment, wheel: str) -> Environment:
    return environment("fleet", f"{wheel}[fleet]")


@pytest.fixture
def with_metrics(environment: MakeEnvironment, wheel: str) -> Environment:
    """A robot that Prometheus asks."""
    return environment("metrics", f"{wheel}[metrics]", *ros_packages())


@pytest.fixture
def with_ros(environment: MakeEnvironment, wheel: str) -> Environment:
    return environment("ros", f"{wheel}[ros]")
