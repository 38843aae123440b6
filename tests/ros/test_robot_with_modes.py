# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The rules of ``examples/robot_with_modes.adirf`` on real nodes."""

from __future__ import annotations

import json
import signal
import time
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from link.zenoh.ends import free_endpoint
from ros.live_incidents import record_of
from ros.ros_domains import free_domain
from ros.ros_processes import LINE_TIMEOUT_S, SmallRobot
from smarttestudo.cli.main import main
from smarttestudo.domain.action import ActionEvent

EXAMPLE = Path(__file__).parents[2] / "examples" / "robot_with_modes.adirf"
SHORTER = {
    "For 5 s": "For 1 s",
    "For 10 s": "For 1 s",
    "Within 10 s": "Within 2 s",
    "Before 20 s After 5 s": "Before 2 s After 1 s",
}
"""The same rules in less time."""
QUIET_MACHINE = {"@machine cpu > 90": "@machine memory < 0"}
QUIET_LINK = {"@link used > 90": "@machine memory < 0"}
"""What others do on this machine is no matter of these tests."""
MACHINE_HOLDS = {"@machine cpu > 90": "@machine memory >= 0"}
LINK_HOLDS = {"@link used > 90": "@link connected = true"}
PROFILE = """\
allow_calls = ["/lidar/reset"]

[allow_parameters]
"/camera_driver" = ["jpeg_quality"]
"""
NODES = {
    "sensors": ("sensors", "left"),
    "lidar": ("diagnostics", "lidar front"),
    "battery": ("diagnostics", "battery"),
    "driver": ("driver",),
    "controller": ("controller",),
    "planner": ("logger", "planner_server"),
    "navigator": ("navigator",),
}


def replaced(text: str, *changes: dict[str, str]) -> str:
    for change in changes:
        for old, new in change.items():
            assert old in text
            text = text.replace(old, new)
    return text


class Day:
    """A robot with modes, beside it a run by its rules that is linked to an operator."""

    def __init__(self, robot: SmallRobot, folder: Path) -> None:
        self.robot = robot
        self.incidents = folder / "incidents"
        self.decisions = folder / "decisions.jsonl"
        self.inputs = folder / "inputs"
        self.nodes = {name: robot.node_of_modes(*words) for name, words in NODES.items()}
        for node in self.nodes.values():
            node.line_with("ready")
        self.goal("send", "abort")
        (folder / "profile.toml").write_text(PROFILE, encoding="utf-8")
        self.rules = Path(robot.rule_file(self.example(QUIET_MACHINE, QUIET_LINK)))
        self.run = robot.testudo_run(
            *("--rules", str(self.rules), "--profile", str(folder / "profile.toml")),
            *("--decisions", str(self.decisions), "--record-inputs", str(self.inputs)),
            *("--incidents", str(self.incidents), "--restore-file", str(folder / "restore.json")),
        )
        self.mark = 0
        self.says("/navigate_to_pose/_action/status: action_msgs", "/controller_server/transition_event: ")
        self.until_rates({"/camera/left": 2, "/scan": 2, "/diagnostics": 0.5, "/arm/state": 1})

    @staticmethod
    def example(*changes: dict[str, str]) -> str:
        return replaced(EXAMPLE.read_text(encoding="utf-8"), *changes, SHORTER)

    def ask(self, name: str, *request: Any) -> Any:
        """Ask a node; what the run says from now on counts."""
        self.mark = len(self.run.output)
        return self.nodes[name].ask(*request)

    def goal(self, *ways: str) -> None:
        for way in ways:
            self.nodes["navigator"].ask(way)

    def follow(self, *changes: dict[str, str]) -> None:
        """Have the run follow the example with these changes."""
        self.mark = len(self.run.output)
        self.rules.write_text(self.example(*changes), encoding="utf-8")
        remote = self.robot.remote()
        remote.line_with("ready")
        assert remote.ask("reload")[0]

    def says(self, *texts: str) -> None:
        """Wait until the run has said each of these, in any order."""
        for text in texts:
            self._wait_until(partial(self._has_said, text), text)

    def _has_said(self, text: str) -> bool:
        return any(text in line for line in self.run.output[self.mark :])

    def until_rates(self, rates_hz: Mapping[str, float]) -> None:
        """Wait until the last decisions of these topics are these rates."""
        self._wait_until(lambda: rates_hz.items() <= self._rates_hz().items(), f"{rates_hz}")

    def _rates_hz(self) -> dict[str, float]:
        return {line["topic"]: line["to_hz"] for line in lines(self.decisions) if "topic" in line}

    def said(self, text: str) -> int:
        return sum(text in line for line in self.run.output)

    def recorded(self, name: str, count: int) -> list[dict[str, Any]]:
        """The incidents of this name, once there are so many that are whole."""
        self._wait_until(lambda: len(self._folders(name)) >= count, f"{count} incidents {name}")
        return [record_of(folder) for folder in self._folders(name)]

    def _wait_until(self, holds: Callable[[], bool], text: str) -> None:
        end_s = time.monotonic() + LINE_TIMEOUT_S
        while not holds():
            assert time.monotonic() < end_s, f"{text}: not in\n{''.join(self.run.output)}"
            time.sleep(0.02)

    def _folders(self, name: str) -> list[Path]:
        return sorted(self.incidents.glob(f"[0-9]*-{name}"))


@pytest.fixture(scope="module")
def day(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Day]:
    folder = tmp_path_factory.mktemp("day")
    with free_domain() as domain:
        robot = SmallRobot(domain, folder)
        try:
            yield Day(robot, folder)
        finally:
            robot.end()


def test_all_cameras_follow_the_mode_and_so_does_one_that_appears(day: Day) -> None:
    day.ask("sensors", "mode", "docking")
    day.says("/camera/left: 2 Hz → 10 Hz (block: Docking)")
    day.nodes["right"] = day.robot.node_of_modes("camera", "right")
    day.says("/camera/right: 10 Hz (reload: Docking)")
    day.ask("sensors", "mode", "driving")
    day.says("/camera/left: 10 Hz → 2 Hz (default)", "/camera/right: 10 Hz → 2 Hz (default)")


def test_the_scan_follows_the_distance_in_five_steps(day: Day) -> None:
    day.ask("sensors", "distance", 1.75)
    day.says("/scan: 2 Hz → 12.8 Hz (default)")
    day.ask("sensors", "distance", 0.4)
    day.says("/scan: 12.8 Hz → 20 Hz (default)")
    day.ask("sensors", "distance", 5.0)
    day.says("/scan: 20 Hz → 2 Hz (default)")


def test_a_constant_of_the_messages_type_lowers_a_rate(day: Day) -> None:
    day.ask("sensors", "charging", True)
    day.says("/scan: 2 Hz → 0.5 Hz (block: Charging)")
    day.ask("sensors", "charging", False)
    day.says("/scan: 0.5 Hz → 2 Hz (default)")


def test_an_emergency_stop_is_notified_while_it_lasts(day: Day) -> None:
    notice = 'Notify "The emergency stop is pressed": '
    diagnostics = day.robot.diagnostics()
    day.ask("sensors", "estop", True)
    day.says("/scan: 2 Hz → Full (block: Emergency stop)", f"{notice}begin (Emergency stop)")
    diagnostics.line_with("The emergency stop is pressed")
    day.ask("sensors", "estop", False)
    day.says("/scan: Full → 2 Hz (default)", f"{notice}end after")
    diagnostics.end()


def test_two_aborts_in_a_row_are_two_incidents_and_one_from_before_the_start_is_none(day: Day) -> None:
    before = len(day.recorded("goal_aborted", 0))
    for count in (1, 2):
        day.goal("send", "abort")
        incidents = day.recorded("goal_aborted", before + count)
        assert len(incidents) == before + count
        assert incidents[-1]["values"] == {"/navigate_to_pose/_action/status goal": 6.0}
    assert not any(one.get("moments") for one in incidents)


def test_a_goal_that_a_newer_one_replaces_is_no_failure(day: Day) -> None:
    before = len(day.recorded("goal_aborted", 0))
    # The last one says that the others have been heard of.
    day.goal("send", "send", "send", "succeed", "send", "abort")
    incidents = day.recorded("goal_aborted", before + 1)
    assert len(incidents) == before + 1
    assert not incidents[-1].get("moments")


def test_an_error_beside_another_publisher_is_one_incident_and_one_call(day: Day) -> None:
    day.ask("lidar", "level", 2)
    day.says(
        "Call /lidar/reset: begin (Lidar error)",
        "Call /lidar/reset: done: reset",
        "/diagnostics: 0.5 Hz → Full (block: Anything in error)",
    )
    # Ten messages of each publisher, in any order.
    heard = day.robot.operator(
        span_s=2.0, d={"type": "diagnostic_msgs/msg/DiagnosticArray", "topic": "/diagnostics"}
    )
    heard.line_with("heard 1")
    day.ask("lidar", "level", 0)
    day.says("/diagnostics: Full → 0.5 Hz (default)")
    (incident,) = day.recorded("lidar_error", 1)
    assert "/camera/left" not in incident["topics"]
    assert all(incident["topics"][topic]["messages"] for topic in ("/scan", "/diagnostics"))
    assert not incident.get("moments")
    assert day.nodes["driver"].ask("resets") == 1
    assert day.said("Call /lidar/reset: begin") == 1


def test_a_fatal_line_is_of_one_node(day: Day) -> None:
    day.ask("planner", "fatal", "no way")
    day.nodes["controller"].ask("fatal", "the wheel; $(rm -rf /) is gone")
    (incident,) = day.recorded("controller_fatal", 1)
    assert incident["values"] == {"/rosout level": 50.0, "/rosout name": "controller_server"}
    assert incident["topics"]["/rosout"]["messages"] >= 2
    assert not incident.get("moments")


def test_a_lifecycle_node_that_goes_inactive_is_an_incident(day: Day) -> None:
    for count in (1, 2):
        day.nodes["controller"].ask("deactivate")
        incidents = day.recorded("controller_inactive", count)
        assert len(incidents) == count
        day.nodes["controller"].ask("activate")
    assert incidents[-1]["values"] == {"/controller_server/transition_event goal_state.label": "inactive"}


def test_the_machine_sets_a_parameter_which_is_given_back(day: Day) -> None:
    day.follow(MACHINE_HOLDS, QUIET_LINK)
    change = "SetParameter /camera_driver jpeg_quality"
    day.says("/camera/left: 2 Hz → 0.5 Hz (block: Machine at its limit)", f"{change} 40: done: it was 90")
    assert day.nodes["driver"].ask("quality") == 40
    day.follow(QUIET_MACHINE, QUIET_LINK)
    day.says("/camera/left: 0.5 Hz → 2 Hz (", f"{change}: done")
    assert day.nodes["driver"].ask("quality") == 90


def test_the_link_lowers_a_rate(day: Day, operators: SmallRobot) -> None:
    endpoint = free_endpoint()
    rules = day.example(QUIET_MACHINE, LINK_HOLDS)
    run = day.robot.runtime(rules, "--link", endpoint, "--robot", "ada", "--ros-args", "-r", "__node:=linked")
    run.line_with("/camera/left: ")
    receiver = operators.receiver(endpoint)
    run.line_with("Hz → 1 Hz (block: Link is narrow)")
    receiver.end()
    run.line_with("1 Hz → 2 Hz (default)")
    run.end()


def test_a_replay_of_its_inputs_decides_line_for_line_alike(day: Day, tmp_path: Path) -> None:
    day.ask("sensors", "mode", "docking")
    day.says("/camera/left: 2 Hz → 10 Hz (block: Docking)")
    day.run.signal(signal.SIGINT)
    assert day.run.exit_code() == 0
    assert "Traceback" not in "".join(day.run.output)
    replayed = tmp_path / "again.jsonl"
    assert main(["replay", str(day.inputs), "--decisions", str(replayed)]) == 0
    outcomes = {event.value for event in ActionEvent if event.is_outcome}
    decided = [line for line in lines(day.decisions) if line.get("event") not in outcomes]
    assert lines(replayed) == decided


def lines(path: Path) -> list[dict[str, Any]]:
    return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]
