# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A command line that a robot with physics cannot follow costs one line."""

from __future__ import annotations

import sys

import pytest

from smarttestudo.cli.main import main


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["simulate", "--teleop"], "--teleop: error: only a robot with physics has that; add --physics"),
        (
            ["simulate", "--robot", "waffle"],
            "--robot: error: only a robot with physics has that; add --physics",
        ),
        (
            ["simulate", "--physics", "--robot", "quadrotor", "--cover-lidar", "3"],
            "--cover-lidar: error: the quadrotor has no LiDAR; leave it out",
        ),
        (
            ["simulate", "--physics", "--teleop", "--mission", "errands.toml"],
            "--teleop: error: keys and a mission cannot both drive; leave one out",
        ),
        (
            ["simulate", "--physics", "--teleop"],
            "--teleop: error: standard input is no terminal; publish on /cmd_vel instead",
        ),
        (
            ["simulate", "--physics", "--battery", "101"],
            "--battery: error: '101' is not a percentage from 0 to 100; see 'testudo simulate --help'",
        ),
        (
            ["demo", "--physics"],
            "--physics: error: a robot with physics drives in real time; add --live",
        ),
    ],
)
def test_options_that_do_not_go_together_are_one_line(
    arguments: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(arguments) == 2
    assert capsys.readouterr() == ("", f"{said}\n")


@pytest.mark.parametrize("command", [["simulate", "--physics"], ["demo", "--live", "--physics"]])
def test_without_mujoco_a_line_says_how_to_install_it(
    command: list[str], capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    # What Python keeps of a package that is not there.
    monkeypatch.setitem(sys.modules, "mujoco", None)
    monkeypatch.setenv("MUJOCO_GL", "disable")
    assert main(command) == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(
        "error: --physics needs the package mujoco; in the checkout of SmartTestudo, run: "
    )
    assert "pip install '.[physics]'" in line
