# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What is said to those who have no ROS 2."""

from __future__ import annotations

import platform
import sys
from pathlib import Path

import pytest
import tomli
from packaging.requirements import Requirement

from smarttestudo.domain.packages import how_to_get_ros

PROJECT = tomli.loads(Path(__file__).parents[2].joinpath("pyproject.toml").read_text(encoding="utf-8"))


@pytest.mark.parametrize("system", ["linux", "darwin"])
@pytest.mark.parametrize("machine", ["x86_64", "aarch64", "armv7l"])
@pytest.mark.parametrize("python", [(3, 10), (3, 13), (3, 14), (3, 15)])
def test_the_extra_ros_is_offered_where_it_has_ros_alone(
    monkeypatch: pytest.MonkeyPatch, system: str, machine: str, python: tuple[int, int]
) -> None:
    requirements = map(Requirement, PROJECT["project"]["optional-dependencies"]["ros"])
    here = {
        "sys_platform": system,
        "platform_machine": machine,
        "python_version": ".".join(map(str, python)),
    }
    installed = {one.name for one in requirements if one.marker is None or one.marker.evaluate(dict(here))}
    monkeypatch.setattr(sys, "platform", system)
    monkeypatch.setattr(platform, "machine", lambda: machine)
    monkeypatch.setattr(sys, "version_info", (*python, 0))
    remedy = how_to_get_ros()
    assert ("'.[ros]'" in remedy) == ("ros-rclpy" in installed)
    assert ("the extra ros is empty here" in remedy) == ("ros-rclpy" not in installed)
