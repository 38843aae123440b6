# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A part of one file, seen wherever a run tells of itself."""

from __future__ import annotations

import json

import pytest

from link.openmetrics.scraping import Samples
from ros.ros_processes import SmallRobot
from ros.test_metrics import port_of, scraped_until
from ros.test_telling import diagnostics_when

IMU = "sensor_msgs/msg/Imu"
RULES = "begin SetFrequency /imu Full end"


def has_section(found: Samples) -> bool:
    return any(name == "testudo_large_messages_total" for name, _ in found)


@pytest.mark.contract
def test_its_option_counter_and_section_are_there(robot: SmallRobot) -> None:
    shown = robot.runtime_with_own_part("--help")
    assert shown.exit_code() == 0
    text = " ".join("".join(shown.output).split())
    assert "--large-from KB count messages of so many KB as large (default: 0.1)" in text

    listener = robot.diagnostics()
    robot.operator(imu={"type": IMU})
    running = robot.runtime_with_own_part(
        "--rules", robot.rule_file(RULES), "--openmetrics", "0", "--large-from", "0.25"
    )
    robot.source(imu={"type": IMU, "hz": 50})

    def seen(found: Samples) -> float:
        return max(number for (name, _), number in found.items() if name == "testudo_large_messages_total")

    scraped_until(port_of(running), lambda found: has_section(found) and seen(found) > 10)
    statuses = diagnostics_when(
        listener, lambda found: int(found["smarttestudo"]["values"].get("large_seen", "0")) > 10
    )
    assert statuses["smarttestudo"]["values"]["large_from_kb"] == "0.250"

    top = robot.testudo("top", "--once", "--json", "--timeout", "40")
    assert top.exit_code() == 0
    section = json.loads("".join(top.output))["nodes"]["/smarttestudo"]["large"]
    assert section.keys() == {"from_kb", "seen"}
    assert section["from_kb"] == 0.25
    assert section["seen"] > 10


def test_a_value_that_its_option_cannot_have_is_refused_with_its_place(robot: SmallRobot) -> None:
    refused = robot.runtime_with_own_part(
        "--rules", robot.rule_file(RULES), "--ros-args", "-p", "large_from_kb:=-1.0"
    )
    assert refused.exit_code() != 0
    said = "".join(refused.output)
    assert "parameter large_from_kb: error: '-1.0' is not a number of KB from 0 to 1000000" in said
