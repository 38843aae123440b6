# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Errors are a line, and say how to get what is missing."""

from __future__ import annotations

import platform
import sys
from pathlib import Path

import pytest
import tomli
from packaging.requirements import Requirement

from smarttestudo.cli.finding_text import finding_lines
from smarttestudo.domain.errors import TestudoError, how_to_get_ros
from smarttestudo.domain.finding import Finding, Severity, Span

NAME = "n" * 1_000_000
PROJECT = tomli.loads(Path(__file__).parents[2].joinpath("pyproject.toml").read_text(encoding="utf-8"))


@pytest.mark.parametrize("system", ["linux", "darwin"])
@pytest.mark.parametrize("machine", ["x86_64", "aarch64", "armv7l"])
@pytest.mark.parametrize("python", [(3, 10), (3, 13), (3, 14), (3, 15)])
def test_the_extra_ros_is_offered_where_it_has_ros_alone(
    monkeypatch: pytest.MonkeyPatch, system: str, machine: str, python: tuple[int, int]
) -> None:
    requirements = map(Requirement, PROJECT["project"]["optional-dependencies"]["ros"])
    here = {"sys_platform": system, "platform_machine": machine, "python_version": ".".join(map(str, python))}
    installed = {one.name for one in requirements if one.marker is None or one.marker.evaluate(dict(here))}
    monkeypatch.setattr(sys, "platform", system)
    monkeypatch.setattr(platform, "machine", lambda: machine)
    monkeypatch.setattr(sys, "version_info", (*python, 0))
    remedy = how_to_get_ros()
    assert ("'.[ros]'" in remedy) == ("ros-rclpy" in installed)
    assert ("the extra ros is empty here" in remedy) == ("ros-rclpy" not in installed)


def test_a_message_about_a_name_of_a_megabyte_is_a_line() -> None:
    error = TestudoError(f"the topic {NAME} is twice in it", place="a.mcap", remedy="name it once")
    finding = Finding(
        code="a",
        severity=Severity.ERROR,
        message=f"the rule {NAME} is twice in it",
        path="a.adirf",
        span=Span(line=1, column=1, end_line=1, end_column=2),
        hint=f"name {NAME} once",
    )
    for line in (str(error), *finding_lines(finding, ["text"])):
        assert len(line) < 1200
    assert str(error).startswith("a.mcap: error: the topic nnn")
    assert str(error).endswith("nnn is twice in it; name it once")
