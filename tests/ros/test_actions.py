# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rules set parameters of real nodes, call real services and notify real servers, and all is as it was."""

from __future__ import annotations

import json
import signal
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from actions.http_servers import served, waited_for
from ros.ros_processes import LINE_TIMEOUT_S, Process, SmallRobot
from smarttestudo.cli.main import main
from smarttestudo.domain.action import ActionDecision, ActionEvent
from smarttestudo.loop.decision_log import read_all_decisions

PROFILE = """\
allow_calls = ["/dock", "/light", "/wipe", "/hang", "/nowhere"]
allow_parameters = { "/camera" = ["quality", "gain", "picky", "nothing"] }
"""
FAR = 'Rule "Far" If CheckValue /level data > 5 Then'


class Acted:
    """A camera, and runs beside it with one file of decisions."""

    def __init__(self, robot: SmallRobot, folder: Path) -> None:
        self.robot = robot
        self.folder = folder
        self.camera = robot.acted()
        self.camera.line_with("ready")
        self.log = folder / "decisions.jsonl"
        (folder / "profile.toml").write_text(PROFILE, encoding="utf-8")

    def run(self, body: str, *arguments: str) -> Process:
        run = self.robot.runtime(
            f"begin SetFrequency /level 10 {body} end",
            *("--profile", str(self.folder / "profile.toml"), "--decisions", str(self.log)),
            *("--restore-file", str(self.folder / "before.json"), *arguments),
        )
        run.line_with("Relaying")
        return run

    def level(self, level: float) -> None:
        self.camera.ask("level", level)

    def events(self) -> list[str]:
        actions = [one for one in read_all_decisions(self.log) if isinstance(one, ActionDecision)]
        return [f"{one.action}: {one.event.value}: {one.detail[:60]}" for one in actions]

    def until(self, holds: Callable[[], bool]) -> None:
        end_s = time.monotonic() + LINE_TIMEOUT_S
        while not holds():
            assert time.monotonic() < end_s, self.events()
            time.sleep(0.05)

    def until_event(self, text: str) -> None:
        self.until(lambda: any(text in event for event in self.events()))

    def until_it_is(self, name: str, value: object) -> None:
        self.until(lambda: self.camera.ask("get", name) == value)


@pytest.fixture
def acted(robot: SmallRobot, tmp_path: Path) -> Acted:
    return Acted(robot, tmp_path)


@pytest.mark.contract
def test_a_rule_sets_calls_and_notifies_and_the_end_gives_back(acted: Acted) -> None:
    with served() as server:
        run = acted.run(
            f"{FAR} SetParameter /camera quality 40 SetParameter /camera gain 1 Call /dock "
            'Notify "far" EndIf',
            *("--notify", f"http://127.0.0.1:{server.server_port}/"),
        )
        diagnostics = acted.robot.diagnostics()
        acted.level(9)
        acted.until_it_is("quality", 40)
        acted.until_it_is("gain", 1.0)
        acted.until(lambda: acted.camera.ask("calls") == ["dock"])
        diagnostics.line_with("far")
        acted.level(0)
        acted.until_it_is("quality", 90)
        acted.until_it_is("gain", 0.5)
        assert waited_for(server, 2)
        begun, ended = server.bodies  # type: ignore[attr-defined]
        assert (begun["event"], begun["text"], begun["rule"]) == ("begin", "far", "Far")
        assert ended["event"] == "end"
        assert ended["lasted_s"] > 0
        acted.level(9)
        acted.until_it_is("quality", 40)
        run.signal(signal.SIGINT)
        assert run.exit_code() == 0
    assert acted.camera.ask("get", "quality") == 90
    assert acted.camera.ask("get", "gain") == 0.5
    assert json.loads((acted.folder / "before.json").read_text())["parameters"] == []
    assert any(event.startswith("Call /dock: done: docked") for event in acted.events())
    assert "\x1b[2J" not in "".join(run.output)
    assert max(map(len, run.output)) < 3000


# Each has 5 s for its answer, once: where others have the processors, that is too little.
@pytest.mark.calm
def test_what_refuses_vanishes_hangs_or_is_not_there_is_said_and_costs_nothing_else(acted: Acted) -> None:
    acted.run(
        f"{FAR} SetParameter /camera picky 2 SetParameter /camera nothing 2 Call /hang Call /light true "
        "Call /nowhere Call /wipe true Call /wipe SetParameter /camera quality 40 "
        "Call /elsewhere SetParameter /camera other 1 EndIf"
    )
    acted.level(9)
    for event in (
        "SetParameter /camera picky 2: failed: refused: no; $(rm -rf /)",
        "SetParameter /camera nothing 2: failed: the node has no such parameter",
        "Call /light true: failed: the bulb is broken",
        "Call /wipe true: failed: its type is std_srvs/srv/Empty: write nothing",
        "Call /wipe: done",
        "SetParameter /camera quality 40: done: it was 90",
        "Call /elsewhere: not allowed",
        "SetParameter /camera other 1: not allowed",
        "Call /hang: failed: the node did not answer within 5 s",
        "Call /nowhere: failed: no node offers this service",
    ):
        acted.until_event(event)
    acted.camera.ask("hide")
    acted.level(0)
    acted.until_event("SetParameter /camera quality: failed: the node did not answer within 5 s")
    acted.camera.ask("show")
    # It has come back as it begins, which is not what was set.
    acted.until(lambda: json.loads((acted.folder / "before.json").read_text())["parameters"] == [])
    assert acted.camera.ask("get", "quality") == 90


def test_what_somebody_else_set_meanwhile_is_left_alone_and_said(acted: Acted) -> None:
    acted.run(f"{FAR} SetParameter /camera quality 40 EndIf")
    acted.level(9)
    acted.until_it_is("quality", 40)
    acted.camera.ask("set", "quality", 55)
    acted.level(0)
    acted.until_event("SetParameter /camera quality: left alone: it is 55, which was not set here")
    assert acted.camera.ask("get", "quality") == 55


def test_rules_that_are_pushed_widen_nothing(acted: Acted) -> None:
    acted.run("")
    remote = acted.robot.remote()
    remote.line_with("ready")
    body = "Call /elsewhere SetParameter /camera other 1 Call /dock"
    rules = f"begin SetFrequency /level 10 {FAR} {body} EndIf end"
    assert remote.ask("set", {"rules_text": rules}) == []
    acted.level(9)
    acted.until_event("Call /dock: done")
    events = acted.events()
    assert "Call /elsewhere: not allowed: " in events
    assert "SetParameter /camera other 1: not allowed: " in events
    assert acted.camera.ask("calls") == ["dock"]


def test_a_replay_of_the_inputs_decides_line_for_line_alike_and_does_nothing(acted: Acted) -> None:
    inputs = acted.folder / "inputs"
    run = acted.run(
        f'{FAR} SetParameter /camera quality 40 Call /dock Notify "far" EndIf', "--record-inputs", str(inputs)
    )
    for level in (9, 0, 9, 0):
        acted.level(level)
        acted.until_it_is("quality", 40 if level else 90)
    run.signal(signal.SIGINT)
    assert run.exit_code() == 0
    calls = acted.camera.ask("calls")
    again = acted.folder / "again.jsonl"
    assert main(["replay", str(inputs), "--decisions", str(again)]) == 0
    assert main(["replay", str(inputs), "--expect", str(acted.log)]) == 0
    lines = [json.loads(line) for line in acted.log.read_text().splitlines()]
    outcomes = {event.value for event in ActionEvent if event.is_outcome}
    decided = [line for line in lines if line.get("event") not in outcomes]
    assert [json.loads(line) for line in again.read_text().splitlines()] == decided
    assert len(decided) < len(lines)
    assert acted.camera.ask("calls") == calls


def test_a_dry_run_decides_and_does_nothing(acted: Acted) -> None:
    run = acted.run(f'{FAR} SetParameter /camera quality 40 Call /dock Notify "far" EndIf', "--dry-actions")
    acted.level(9)
    for what in ("SetParameter /camera quality 40", "Call /dock", 'Notify "far"'):
        acted.until_event(f"{what}: dry")
    run.signal(signal.SIGTERM)
    assert run.exit_code() == 0
    assert (acted.camera.ask("get", "quality"), acted.camera.ask("calls")) == (90, [])


def test_after_20_kills_it_is_what_it_was(acted: Acted) -> None:
    rules = f"{FAR} SetParameter /camera quality 40 SetParameter /camera gain 0.25 EndIf"
    acted.level(9)
    for number in range(20):
        run = acted.run(rules)
        # Some are killed before they have set anything, some in the middle, some after.
        if number % 4 == 0:
            acted.until_it_is("quality", 40)
        else:
            time.sleep(number * 0.04)
        run.signal(signal.SIGKILL)
        run.exit_code()
    acted.level(0)
    run = acted.run(rules)
    acted.until_it_is("quality", 90)
    acted.until_it_is("gain", 0.5)
    acted.until(lambda: json.loads((acted.folder / "before.json").read_text())["parameters"] == [])


def test_after_100_changes_of_the_rules_it_is_what_it_was(acted: Acted) -> None:
    run = acted.run(f"{FAR} SetParameter /camera quality 40 EndIf")
    path = Path(next(word for word in acted.folder.glob("rules*.adirf")))
    acted.level(9)
    acted.until_it_is("quality", 40)
    remote = acted.robot.remote()
    remote.line_with("ready")
    for number in range(100):
        body = "" if number % 3 == 2 else f"{FAR} SetParameter /camera quality {number} EndIf"
        path.write_text(f"begin SetFrequency /level 10 {body} end", encoding="utf-8")
        succeeded, message = remote.ask("reload")
        assert succeeded, message
    path.write_text("begin SetFrequency /level 10 end", encoding="utf-8")
    assert remote.ask("reload")[0]
    acted.until_it_is("quality", 90)
    acted.until(lambda: json.loads((acted.folder / "before.json").read_text())["parameters"] == [])
    begun = [event for event in acted.events() if ActionEvent.BEGIN.value in event]
    assert len(begun) < 100
    run.signal(signal.SIGINT)
    assert run.exit_code() == 0
    assert acted.camera.ask("get", "quality") == 90
