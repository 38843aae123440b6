# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a live run decided is decided again from what it saw."""

from __future__ import annotations

import json
import signal
from pathlib import Path
from typing import Any

import pytest

from ros.ros_processes import Process, SmallRobot

TOPICS = {
    "odom": {"type": "nav_msgs/msg/Odometry", "hz": 25},
    "imu": {"type": "sensor_msgs/msg/Imu", "hz": 100},
}
ZONE = """\
begin
  SetFrequency odom 10
  SetFrequency /imu 5
  Rule "Zone" If (CheckValue odom pose_x > 3) Then SetFrequency /imu 50 EndIf
end
"""
SILENCE = 'begin Rule "Silent" If (CheckValue odom age > 1) Then SetFrequency /odom 20 EndIf end'
ATTEMPTS = 10


def lines(path: Path) -> list[dict[str, Any]]:
    return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]


def drive(
    robot: SmallRobot, rules: str, *arguments: str, recorder: Process | None = None
) -> tuple[Process, Process]:
    """A runtime that saw the robot enter the zone and leave it, as the recorder did, and the source."""
    runtime = robot.runtime(rules, *arguments)
    source = robot.source(**TOPICS)
    runtime.line_with("/imu: 50 Hz → 5 Hz (default)")
    if recorder is not None:
        recorder.hears_more()
    for place, decision in (("move", "5 Hz → 50 Hz (block: Zone)"), ("home", "50 Hz → 5 Hz (default)")):
        source.say(place)
        runtime.line_with(f"/imu: {decision}")
        if recorder is not None:
            recorder.hears_more()
    return runtime, source


@pytest.mark.contract
def test_the_decisions_of_a_live_run_come_out_of_its_recorded_inputs_line_for_line(
    robot: SmallRobot, tmp_path: Path
) -> None:
    live, replayed, inputs = (tmp_path / name for name in ("live.jsonl", "replayed.jsonl", "inputs"))
    runtime, source = drive(robot, ZONE + SILENCE, "--decisions", str(live), "--record-inputs", str(inputs))
    source.end()
    runtime.line_with("/odom: 10 Hz → 20 Hz (block: Silent)")
    runtime.signal(signal.SIGINT)
    assert runtime.exit_code() == 0
    again = robot.testudo("replay", str(inputs), "--decisions", str(replayed))
    assert again.exit_code() == 0, "".join(again.output)
    assert replayed.read_text("utf-8") == live.read_text("utf-8")


@pytest.mark.contract
def test_the_level_of_a_diagnostic_holds_live_and_in_a_replay_of_the_same(
    robot: SmallRobot, tmp_path: Path
) -> None:
    rules = 'begin SetFrequency /imu 5 Rule "Fault" If (CheckValue /diagnostics status[0].level >= 2) '
    rules += "Then SetFrequency /imu 50 EndIf end"
    live, replayed, inputs = (tmp_path / name for name in ("live.jsonl", "replayed.jsonl", "inputs"))
    runtime = robot.runtime(rules, "--decisions", str(live), "--record-inputs", str(inputs))
    source = robot.source(
        diagnostics={"type": "diagnostic_msgs/msg/DiagnosticArray", "hz": 20}, imu=TOPICS["imu"]
    )
    runtime.line_with("/imu: 50 Hz → 5 Hz (default)")
    source.say("break diagnostics")
    runtime.line_with("/imu: 5 Hz → 50 Hz (block: Fault)")
    runtime.signal(signal.SIGINT)
    assert runtime.exit_code() == 0
    again = robot.testudo("replay", str(inputs), "--decisions", str(replayed))
    assert again.exit_code() == 0, "".join(again.output)
    assert replayed.read_text("utf-8") == live.read_text("utf-8")


def test_over_an_ordinary_recording_they_are_the_same_within_50_ms(robot: SmallRobot, tmp_path: Path) -> None:
    rules = tmp_path / "zone.adirf"
    rules.write_text(ZONE, encoding="utf-8")
    for attempt in range(ATTEMPTS):
        bag, out, live, replayed = (tmp_path / f"{name}{attempt}" for name in ("bag", "out", "live", "again"))
        recorder = robot.recorder(bag, **TOPICS)
        runtime, source = drive(robot, ZONE, "--decisions", str(live), recorder=recorder)
        recorder.result()
        for process in (source, runtime):
            process.end()
        again = robot.testudo(
            *("replay", str(bag), "--rules", str(rules), "--output", str(out), "--decisions", str(replayed))
        )
        assert again.exit_code() == 0, "".join(again.output)
        if are_same_within_50_ms(lines(live), lines(replayed)):
            return
    pytest.fail("machine too slow: recorder and runtime did not get messages within 50 ms of each other")


def are_same_within_50_ms(live: list[dict[str, Any]], replayed: list[dict[str, Any]]) -> bool:
    """Whether the times are near; the decisions must be the same. Recorder and runtime began apart."""
    live, replayed = ([one for one in log if "start" not in one] for log in (live, replayed))
    if any(one["reason"] == "unknown" for one in (*live, *replayed)):
        # One of them stood still so long that it took the source for silent.
        return False
    live = live[: len(replayed)]
    assert [step(one) for one in live] == [step(one) for one in replayed]
    assert [one["rule"] for one in replayed] == [None, "Zone", None]
    return all(
        abs(one["stamp_ns"] - other["stamp_ns"]) < 50_000_000
        for one, other in zip(live[1:], replayed[1:], strict=True)
    )


def step(decision: dict[str, Any]) -> tuple[Any, ...]:
    return tuple(decision[key] for key in ("topic", "from_hz", "to_hz", "reason", "rule"))
