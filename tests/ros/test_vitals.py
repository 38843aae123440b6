# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rules that read the robot's computer and its link, on a real robot, and again from the recorded inputs."""

from __future__ import annotations

import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from ros.ros_processes import Process, SmallRobot

IMU: dict[str, Any] = {"type": "sensor_msgs/msg/Imu", "hz": 50}
OF_MACHINE = """\
begin
  SetFrequency /imu 10
  Rule "Known" If (CheckValue @machine memory >= 0 AND CheckValue @machine disk_free > 0)
  Then SetFrequency /imu 5 EndIf
  Rule "Busy" Priority 1 If (CheckValue @machine cpu > 40) Then SetFrequency /imu 20 EndIf
end
"""
OF_LINK = """\
begin
  SetFrequency /imu 5
  Rule "Seen" If (CheckValue @link connected = true) Then SetFrequency /imu 20 EndIf
  Rule "Long unseen" Priority 1 If (CheckValue @link age > 15) Then SetFrequency /imu 2 EndIf
end
"""
BUSY = "while True: pass"


def assert_same_again(robot: SmallRobot, run: Process, folder: Path) -> None:
    """The run, which is ended, decided what its recorded inputs decide."""
    run.signal(signal.SIGINT)
    assert run.exit_code() == 0, "".join(run.output)
    again = robot.testudo("replay", str(folder / "inputs"), "--decisions", str(folder / "again.jsonl"))
    assert again.exit_code() == 0, "".join(again.output)
    live, replayed = ((folder / name).read_text("utf-8") for name in ("live.jsonl", "again.jsonl"))
    assert replayed == live


def recorded_in(folder: Path) -> list[str]:
    return ["--decisions", str(folder / "live.jsonl"), "--record-inputs", str(folder / "inputs")]


@pytest.mark.contract
def test_a_busy_computer_decides_live_and_in_a_replay_of_the_same(robot: SmallRobot, tmp_path: Path) -> None:
    robot.source(imu=IMU)
    run = robot.runtime(OF_MACHINE, *recorded_in(tmp_path))
    busy: list[subprocess.Popen[bytes]] = []
    try:
        # At first nothing is known, and more is relayed.
        run.line_with("/imu: 20 Hz (unknown")
        busy = [subprocess.Popen([sys.executable, "-c", BUSY]) for _ in range(2)]
        run.line_with("(block: Busy)")
    finally:
        for process in busy:
            process.kill()
            process.wait()
    assert_same_again(robot, run, tmp_path)
    inputs = (tmp_path / "inputs/inputs.jsonl").read_text("utf-8")
    assert '"event":"vitals"' in inputs
    assert '"topic":"@machine"' not in inputs
    assert '"@machine cpu"' in (tmp_path / "live.jsonl").read_text("utf-8")


@pytest.mark.contract
def test_whether_an_operator_is_there_decides_live_and_in_a_replay_of_the_same(
    robot: SmallRobot, operators: SmallRobot, endpoint: str, tmp_path: Path
) -> None:
    robot.source(imu=IMU)
    run = robot.runtime(OF_LINK, "--link", endpoint, "--robot", "tb3", *recorded_in(tmp_path))
    run.line_with("/imu: 20 Hz → 5 Hz (default)")
    receiver = operators.receiver(endpoint)
    run.line_with("/imu: 5 Hz → 20 Hz (block: Seen)")
    receiver.end()
    run.line_with("(block: Long unseen)")
    assert_same_again(robot, run, tmp_path)


def test_a_run_without_a_link_says_once_that_nothing_is_known_of_it(robot: SmallRobot) -> None:
    robot.source(imu=IMU)
    run = robot.runtime(OF_LINK)
    run.line_with("the rules read @link, which is unknown without a link")
    run.line_with("/imu: 20 Hz (unknown")
