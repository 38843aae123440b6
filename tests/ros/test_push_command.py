# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo push``: rules to a running robot, tried, kept and written, on its graph and over a link."""

from __future__ import annotations

import hashlib
from pathlib import Path

import pytest

from ros.ros_processes import Process, SmallRobot

RULES = "begin\n  SetFrequency /imu 10\nend\n"
FASTER = "begin\n  SetFrequency /imu 20\nend\n"
CHANGE = "  default: /imu 10 → 20 Hz\n"


@pytest.fixture(params=["on the graph", "over the link"])
def arguments(request: pytest.FixtureRequest, endpoint: str) -> list[str]:
    named = ["--robot", "tb3", "--timeout", "60"]
    return named if request.param == "on the graph" else [*named, "--connect", endpoint]


@pytest.fixture
def runtime(robot: SmallRobot, endpoint: str) -> Process:
    runtime = robot.runtime(RULES, "--link-listen", endpoint, "--robot", "tb3", "--allow-writing-rules")
    runtime.line_with("Relaying")
    return runtime


def pushed(robot: SmallRobot, text: str, *arguments: str) -> tuple[int, list[str]]:
    path = robot.folder / "new.adirf"
    path.write_text(text, encoding="utf-8")
    command = robot.testudo("push", str(path), *arguments)
    return command.exit_code(), command.output


@pytest.mark.contract
def test_rules_are_tried_kept_and_written(
    robot: SmallRobot, runtime: Process, arguments: list[str], tmp_path: Path
) -> None:
    code, lines = pushed(robot, FASTER, "--keep", *arguments)
    sha256 = hashlib.sha256(FASTER.encode()).hexdigest()
    assert (code, lines[0]) == (0, CHANGE)
    assert lines[-1] == f"kept until its runtime ends or its rule file changes, hash {sha256}\n"
    runtime.line_with("pushed rules confirmed")
    code, lines = pushed(robot, FASTER, "--write", *arguments)
    assert code == 0
    assert lines[0] == f"tb3:/smarttestudo follows these rules already, hash {sha256}\n"
    written = next(path for path in tmp_path.glob("rules*.adirf"))
    assert lines[1] == f"written to {written}; what it held is in {written}.previous\n"
    assert written.read_text(encoding="utf-8") == FASTER


def test_rules_that_nobody_keeps_are_taken_back_and_that_is_said(
    robot: SmallRobot, runtime: Process, arguments: list[str]
) -> None:
    code, lines = pushed(robot, FASTER, *arguments)
    before = hashlib.sha256(RULES.encode()).hexdigest()
    assert (code, lines[0]) == (0, CHANGE)
    assert lines[-1] == f"taken back: tb3:/smarttestudo follows other rules again, hash {before}\n"
    runtime.line_with("pushed rules not confirmed within 10 s")


def test_what_cannot_be_pushed_is_one_line_or_a_finding_and_changes_nothing(
    robot: SmallRobot, runtime: Process, arguments: list[str]
) -> None:
    code, lines = pushed(robot, RULES.replace("10", "fast"), *arguments)
    assert (code, "new.adirf:2:21: error[" in lines[0]) == (1, True)
    code, lines = pushed(robot, FASTER + "//" + 70_000 * "-", *arguments)
    assert (code, len(lines)) == (1, 2)
    assert "new.adirf: error: 70035 bytes are too many to check while messages are waiting" in lines[1]
    code, lines = pushed(robot, FASTER, *arguments, "--robot", "nobody")
    assert (code, len(lines)) == (2, 1)
    assert "there is no robot 'nobody', but tb3; name one of these with --robot" in lines[0]
    assert not any("rules pushed" in line for line in runtime.output)
