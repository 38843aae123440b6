# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a live run tells, and what a live robot measures."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import pytest

from ros.ros_processes import Process, SmallRobot
from smarttestudo.cli.main import main
from smarttestudo.rules.profile_file import load_profile

IMU = "sensor_msgs/msg/Imu"
RULES = """begin
    KeepAtLeast /imu 20
    SetFrequency /imu 30
    SetFrequency /scan Off
    SetFrequency /estop Full
end
"""
GREENWAVE_KEYS = {
    "frame_rate_node",
    "frame_rate_msg",
    "current_delay_from_realtime_ms",
    "expected_frequency",
    "tolerance",
}
OK, ERROR, STALE = 0, 2, 3
LINES = 120


def diagnostics_when(listener: Process, holds: Callable[[dict[str, Any]], bool]) -> dict[str, Any]:
    """The first diagnostics for which ``holds``: what is discovered late comes later."""
    for _ in range(LINES):
        statuses: dict[str, Any] = json.loads(listener.line_with("diagnostics ").removeprefix("diagnostics "))
        if holds(statuses):
            return statuses
    raise AssertionError(f"not within {LINES} diagnostics; the last: {statuses}")


def has_settled(statuses: dict[str, Any]) -> bool:
    imu = statuses["/testudo/imu"]
    is_measured: bool = imu["level"] == OK and imu["values"]["frame_rate_node"] != "N/A"
    return is_measured and bool(statuses["smarttestudo"]["level"] == ERROR)


@pytest.mark.contract
def test_diagnostics_and_top_tell_what_is_relayed_and_what_is_not(robot: SmallRobot) -> None:
    listener = robot.diagnostics()
    robot.operator(imu={"type": IMU})
    robot.runtime(RULES, "--budget", "1")
    robot.source(imu={"type": IMU, "hz": 50})
    statuses = diagnostics_when(listener, has_settled)

    node, imu = statuses["smarttestudo"], statuses["/testudo/imu"]
    assert node["message"] == "the floors alone are more than the budget"
    assert {one["hardware_id"] for one in statuses.values()} == {"/smarttestudo"}
    assert (imu["values"]["target"], imu["values"]["reason"]) == ("20 Hz", "budget")
    assert imu["values"].keys() >= {"expected_frequency", *GREENWAVE_KEYS}
    assert (statuses["/testudo/scan"]["level"], statuses["/testudo/scan"]["message"]) == (OK, "Off")
    assert statuses["/testudo/estop"]["level"] == STALE
    assert statuses["/testudo/estop"]["message"] == "no publisher"

    top = robot.testudo("top", "--once", "--json", "--timeout", "40")
    assert top.exit_code() == 0
    status = json.loads("".join(top.output))["nodes"]["/smarttestudo"]
    assert (status["budget_kb_per_s"], status["floors_break_budget"]) == (1, True)
    assert status["topics"]["/imu"]["target_hz"] == 20
    assert status["topics"]["/imu"]["relayed"] > 0
    silent = {topic: status["topics"][topic]["silent"] for topic in ("/scan", "/estop")}
    assert silent == {"/scan": "Off", "/estop": "no publisher"}


def test_top_without_a_smarttestudo_says_so_in_one_line(robot: SmallRobot) -> None:
    top = robot.testudo("top", "--once", "--timeout", "0.1")
    assert top.exit_code() == 1
    (line,) = top.output
    assert line.startswith("/testudo/status: error: no status was received within 0.1 s; ")


def test_a_profile_of_a_running_robot_is_one_that_check_takes(robot: SmallRobot) -> None:
    rules, profile = robot.folder / "rules.adirf", robot.folder / "profile.toml"
    rules.write_text("begin SetFrequency /imu 10 SetFrequency /name Full end", encoding="utf-8")
    robot.source(imu={"type": IMU, "hz": 50}, name={"type": "std_msgs/msg/String", "texts": ["tb3"]})
    robot.runtime("begin SetFrequency /imu 10 end").line_with("/imu: sensor_msgs/msg/Imu")
    arguments = ("--seconds", "3", "--timeout", "40", "-o", str(profile))
    measuring = robot.testudo("profile", *arguments)
    assert measuring.exit_code() == 0, "".join(measuring.output)
    assert measuring.output == []
    assert load_profile(profile).topic("/imu").type_name == IMU
    assert [topic for topic in load_profile(profile).topics if topic.startswith("/testudo")] == []
    assert main(["check", str(rules), "--profile", str(profile)]) == 0
