# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rules for all topics of a kind, some of which appear while a robot runs."""

from __future__ import annotations

import signal
from pathlib import Path
from typing import Any

import pytest

from ros.ros_processes import SmallRobot, on_every_data_path

HZ = 20
TEXT = {"type": "std_msgs/msg/String", "hz": HZ}
RULES = """\
begin
  SetFrequency /camera/* Full
  SetFrequency /count 10
  Rule "Charging"
  If (CheckValue /battery_state power_supply_status = POWER_SUPPLY_STATUS_UNKNOWN)
  Then SetFrequency /camera/* 2 EndIf
end
"""
FULL = "begin SetFrequency /camera/* Full end"


def number_of(arrival: list[Any]) -> int:
    """Which message of its source arrived, from 0 on."""
    return int(arrival[1].split()[0])


@pytest.mark.calm
@on_every_data_path
def test_a_topic_that_appears_reaches_the_operator_within_a_second(robot: SmallRobot, data_path: str) -> None:
    runtime = robot.runtime(FULL, "--data-path", data_path)
    runtime.line_with("Relaying 0 topics")
    listened: dict[str, Any] = {"camera/b": {**TEXT, "messages": 20}}
    operator = robot.operator(**listened)
    later = {"camera/b": TEXT, "camera/_hidden": TEXT, "radar/b": TEXT}
    source = robot.source(**{"camera/a": TEXT}, **{name: {**TEXT, "later": True} for name in later})
    # Both nodes are known to the run by now: what Fast DDS takes to find a process, up to 3 s, is not ours.
    runtime.line_with("/camera/a: Full (reload)")
    source.say(f"create {' '.join(later)}")
    runtime.line_with("/camera/b: Full (reload)")
    operator.line_with("heard")
    arrivals = operator.result()["camera/b"]
    missed_s = number_of(arrivals[0]) / HZ
    assert missed_s < 1.0
    source.end()
    assert not [line for line in runtime.output if "_hidden" in line or "radar" in line]
    assert "Traceback" not in "".join(runtime.output)


@pytest.mark.contract
def test_what_was_known_is_recorded_so_that_the_inputs_decide_alike(
    robot: SmallRobot, tmp_path: Path
) -> None:
    live, replayed, inputs = (tmp_path / name for name in ("live.jsonl", "replayed.jsonl", "inputs"))
    runtime = robot.runtime(RULES, "--decisions", str(live), "--record-inputs", str(inputs))
    robot.source(count=TEXT, **{"camera/a": TEXT})
    runtime.line_with("/camera/a: Full (reload)")
    battery = robot.source(battery_state={"type": "sensor_msgs/msg/BatteryState", "hz": 10})
    runtime.line_with("/camera/a: Full → 2 Hz (block: Charging)")
    other = robot.source(**{"camera/b": TEXT})
    runtime.line_with("/camera/b: 2 Hz (reload: Charging)")
    battery.end()
    other.end()
    runtime.line_with("/camera/b: no publisher left")
    runtime.signal(signal.SIGINT)
    assert runtime.exit_code() == 0
    again = robot.testudo("replay", str(inputs), "--decisions", str(replayed))
    assert again.exit_code() == 0, "".join(again.output)
    assert replayed.read_text("utf-8") == live.read_text("utf-8")


def test_two_hundred_topics_that_appear_together_are_relayed_after_a_few_compilations(
    robot: SmallRobot,
) -> None:
    runtime = robot.runtime(FULL)
    runtime.line_with("Relaying 0 topics")
    robot.source(**{f"camera/c{number}": {**TEXT, "hz": 1} for number in range(200)})
    runtime.line_with("/camera/c199: Full (reload)")
    assert sum("matched by patterns" in line for line in runtime.output) <= 10
