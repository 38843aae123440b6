# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The systemd unit: its command is run here, systemd itself is not."""

from __future__ import annotations

import configparser
import re
import shlex
import shutil
import signal
import subprocess
from pathlib import Path

from docs.code_blocks import blocks_of
from ros.ros_processes import SmallRobot
from ros_package.workspace import ROOT

UNIT = ROOT / "extras" / "smarttestudo.service"
ENVIRONMENT = ROOT / "extras" / "smarttestudo.env"


def command() -> list[str]:
    """What systemd would start."""
    unit = configparser.ConfigParser(interpolation=None)
    unit.optionxform = str  # type: ignore[assignment]
    unit.read_string(UNIT.read_text(encoding="utf-8"))
    return [word.replace("$$", "$") for word in shlex.split(unit["Service"]["ExecStart"])]


def test_its_command_starts_the_runtime_of_a_workspace_and_sigterm_ends_it(
    robot: SmallRobot, installed: Path
) -> None:
    rules = robot.folder / "rules.adirf"
    rules.write_text("begin SetFrequency /imu 10 end", encoding="utf-8")
    runtime = robot.command(
        *command(),
        ROS_SETUP=str(installed.parent / "local_setup.bash"),
        SMART_TESTUDO=str(installed / "lib" / "smarttestudo" / "smart_testudo"),
        SMART_TESTUDO_ARGUMENTS=f"--rules {rules} --ros-args -r __ns:=/tb3_0",
    )
    runtime.line_with("[tb3_0.smarttestudo]: /imu: 10 Hz (default)")
    runtime.signal(signal.SIGTERM)
    assert runtime.exit_code() == 0


def test_the_example_of_its_environment_has_all_that_the_command_needs() -> None:
    needed = set(re.findall(r"\$\{(\w+)\}", " ".join(command())))
    given = set(re.findall(r"^(\w+)=", ENVIRONMENT.read_text(encoding="utf-8"), flags=re.MULTILINE))
    assert needed
    assert needed <= given


def test_a_link_finds_its_files_from_any_folder() -> None:
    blocks = {block.language: block.text for block in blocks_of("docs/systemd.md") if "link/" in block.text}
    named = re.findall(r": \"([^\"]*)\"", blocks["json5"])
    copied = next(line for line in blocks["sh"].splitlines() if "ca.pem" in line).split()
    folder = copied[-1]
    assert len(named) == 3
    assert all(path.startswith(folder) and path.removeprefix(folder) in copied for path in named)
    (arguments,) = blocks["text"].splitlines()
    assert f"{folder}robot.json5" in arguments
    assert arguments in ENVIRONMENT.read_text(encoding="utf-8")


def test_systemd_has_nothing_to_say_against_it() -> None:
    verify = shutil.which("systemd-analyze")
    if verify is None:
        return
    done = subprocess.run([verify, "verify", UNIT], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
