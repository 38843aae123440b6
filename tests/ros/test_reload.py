# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rules that change while a robot runs, and a robot without rules."""

from __future__ import annotations

import hashlib
import json
import os
from pathlib import Path
from typing import Any

import pytest

from ros.ros_processes import SmallRobot
from ruler.ruler_server import served

IMU = {"type": "sensor_msgs/msg/Imu", "hz": 50}
CLOCK = {"type": "rosgraph_msgs/msg/Clock", "hz": 10}
STAY = "the last valid rules stay in force"


def sha256(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()


def replace_text(path: Path, text: str) -> None:
    """Write a new file under the old name, as many editors do."""
    new = path.with_suffix(".new")
    new.write_text(text, encoding="utf-8")
    new.replace(path)


def test_500_reloads_of_good_and_bad_files_cost_a_full_topic_no_message(robot: SmallRobot) -> None:
    texts = [
        "begin SetFrequency /count Full end",
        "begin SetFrequency /count Full SetFrequency /imu 5 end",
        "begin SetFrequency /cou",
        "begin SetFrequency /count Full If CheckValue /count rate > 0 Then SetFrequency /imu 9 EndIf end",
        "",
    ]
    runtime = robot.runtime(texts[0])
    counted = robot.counter(robot.folder / "rules0.adirf", texts, 500).result()
    assert (counted["succeeded"], counted["broken"]) == (300, [])
    assert counted["heard"] >= 50
    runtime.line_with("rules reloaded")
    assert "Traceback" not in "".join(runtime.output)


def test_reloads_of_two_thousand_rules_cost_a_full_topic_no_message(robot: SmallRobot) -> None:
    def many(rate: int) -> str:
        blocks = [
            f"If CheckValue /odom pose_x > {place} Then SetFrequency /imu {rate} EndIf"
            for place in range(2000)
        ]
        return "\n".join(["begin SetFrequency /count Full", *blocks, "end"])

    runtime = robot.runtime(many(5))
    counter = robot.counter(robot.folder / "rules0.adirf", [], 0)
    counter.line_with("counting")
    for rate in (6, 7, 8):
        replace_text(robot.folder / "rules0.adirf", many(rate))
        assert sha256(many(rate)) in runtime.line_with("rules reloaded, hash")
    counter.say("stop")
    counted = counter.result()
    assert counted["broken"] == []
    assert counted["heard"] >= 50
    assert "Traceback" not in "".join(runtime.output)


@pytest.mark.contract
def test_a_file_that_is_edited_on_the_page_is_followed_once_it_is_saved(robot: SmallRobot) -> None:
    folder = robot.folder / "rules"
    folder.mkdir()
    good = "begin\n  SetFrequency /imu 10\nend\n"
    (folder / "a.adirf").write_text(good, encoding="utf-8")
    runtime = robot.testudo_run("--rules", str(folder))
    runtime.line_with("/imu: 10 Hz (default)")
    with served(folder) as page:
        base_hash = page.get("/api/file?name=a.adirf").json["hash"]
        root_hash = page.get("/api/project").json["root_hash"]
        for length in range(1, len(good)):
            draft = {"content": good[:length], "beside": "", "base_hash": base_hash}
            ids = {"id": f"{length}", "known_ids": [f"{length - 1}"]}
            asked = {"name": "a.adirf", "root_hash": root_hash, **ids, "draft": draft}
            assert page.put("/api/draft", asked).status == 200
        # The run looks at its folder after all that.
        (folder / "b.adirf").write_text("begin SetFrequency /scan 5 end", encoding="utf-8")
        runtime.line_with("/scan: 5 Hz (reload)")
        said = "".join(runtime.output)
        assert "/imu: 10 Hz →" not in said
        assert "error" not in said
        saved = {"name": "a.adirf", "text": good.replace("10", "30"), "base_hash": base_hash}
        assert page.put("/api/file", {**saved, "draft_ids": [f"{len(good) - 1}"]}).status == 200
    runtime.line_with("/imu: 10 Hz → 30 Hz (reload)")


@pytest.mark.contract
def test_a_file_that_changes_is_followed_and_a_bad_one_is_told_once(robot: SmallRobot) -> None:
    folder = robot.folder / "rules"
    folder.mkdir()
    path, good = folder / "a.adirf", "begin\n  SetFrequency /imu 10\nend\n"
    path.write_text(good, encoding="utf-8")
    runtime = robot.testudo_run("--rules", str(folder))
    runtime.line_with("/imu: 10 Hz (default)")
    replace_text(path, good[: len(good) // 2])
    assert f"{path}:2:3: error: " in (line := runtime.line_with("error"))
    assert STAY in line
    replace_text(path, "")
    assert f"{path}:1:1: error: " in runtime.line_with("error")
    path.touch()
    replace_text(path, good.replace("10", "20"))
    assert sha256(good.replace("10", "20")) in runtime.line_with("rules reloaded, hash")
    runtime.line_with("/imu: 10 Hz → 20 Hz (reload)")
    replace_text(folder / "b.adirf", "begin SetFrequency /scan 5 end")
    runtime.line_with("/scan: 5 Hz (reload)")
    (folder / "b.adirf").unlink()
    runtime.line_with("/scan: no longer relayed (reload)")
    assert sum(STAY in line for line in runtime.output) == 2


def test_rules_whose_file_name_is_not_utf_8_are_followed_and_told(robot: SmallRobot) -> None:
    folder = robot.folder / "rules"
    folder.mkdir()
    path, text = folder / os.fsdecode(b"r\xe9gles.adirf"), "begin SetFrequency /imu 10 end"
    path.write_text(text, encoding="utf-8")
    runtime = robot.testudo_run("--rules", str(folder), "--allow-writing-rules")
    runtime.line_with("/imu: 10 Hz (default)")
    remote, shown = robot.remote(), f"{folder}/r?gles.adirf"
    assert remote.ask("get", "writable_rules_file") == shown
    assert json.loads(remote.ask("get", "rules_in_force"))["files"] == [{"name": shown, "text": text}]
    replace_text(path, "begin")
    assert f"{folder}/r\\udce9gles.adirf:1:6: error: " in runtime.line_with(STAY)
    success, message = remote.ask("reload")
    assert (success, message.startswith(f"{shown}:1:6: error: ")) == (False, True)
    replace_text(path, text.replace("10", "20"))
    runtime.line_with("/imu: 10 Hz → 20 Hz (reload)")
    assert "Traceback" not in "".join(runtime.output)


@pytest.mark.contract
def test_a_pushed_text_goes_back_unless_its_hash_is_confirmed(robot: SmallRobot) -> None:
    in_file, pushed = "begin SetFrequency /imu 10 end", "begin SetFrequency /imu 30 end"
    runtime, remote = robot.runtime(in_file), robot.remote()
    assert remote.ask("set", {"rules_text": pushed}) == []
    assert remote.ask("get", "rules_hash") == sha256(pushed)
    runtime.line_with("/imu: 10 Hz → 30 Hz (reload)")
    runtime.line_with("pushed rules not confirmed within 10 s")
    runtime.line_with("/imu: 30 Hz → 10 Hz (reload)")
    assert remote.ask("get", "rules_hash") == sha256(in_file)
    assert remote.ask("get", "rules_text") == ""

    (refused,) = remote.ask("set", {"rules_text": "begin SetFrequency /imu end"})
    assert refused.startswith("rules_text:1:25: error: ")
    (refused,) = remote.ask("set", {"confirm_hash": sha256(pushed)})
    assert refused.startswith("confirm_hash: error: ")
    (refused,) = remote.ask("set", {"rules_hash": "0" * 64})
    assert refused.startswith("parameter rules_hash: error: ")

    assert remote.ask("set", {"rules_text": pushed, "confirm_hash": sha256(pushed)}) == []
    runtime.line_with("pushed rules confirmed")
    assert remote.ask("get", "rules_text") == pushed
    success, message = remote.ask("reload")
    assert (success, message) == (True, f"rules reloaded, hash {sha256(in_file)}")
    runtime.line_with("the pushed rules are no longer in force")
    (robot.folder / "rules0.adirf").unlink()
    success, message = remote.ask("reload")
    assert not success
    assert message.startswith(f"{robot.folder / 'rules0.adirf'}: error: there is no such file")


@pytest.mark.contract
def test_without_rules_everything_is_relayed_until_there_are_some(robot: SmallRobot) -> None:
    path, decisions = robot.folder / "rules" / "rules.adirf", robot.folder / "decisions.jsonl"
    path.parent.mkdir()
    robot.source(imu=IMU, clock=CLOCK, _hidden=IMU)
    operator = robot.operator(imu=IMU)
    runtime = robot.testudo_run("--rules", str(path.parent), "--decisions", str(decisions))
    said = runtime.line_with("relaying everything at Full until there are rules")
    assert "the folder holds no rule files" in said
    runtime.line_with("/imu: Full (fallback)")
    operator.line_with("heard")
    robot.source(late=IMU)
    runtime.line_with("/late: Full (fallback)")
    replace_text(path, "begin SetFrequency /imu 10 end")
    runtime.line_with("/late: no longer relayed (reload)")
    runtime.line_with("/imu: Full → 10 Hz (reload)")
    told = [json.loads(line) for line in decisions.read_text(encoding="utf-8").splitlines()]
    assert {one["topic"] for one in told} == {"/imu", "/late"}
    assert [one["reason"] for one in told if one["topic"] == "/imu"] == ["fallback", "reload"]


@pytest.mark.contract
def test_rules_with_an_error_are_said_at_the_start_and_none_at_all_are_rules_too(robot: SmallRobot) -> None:
    wrong = robot.runtime("begin SetFrequency /imu fast end")
    assert "rules0.adirf:1:25: error: " in wrong.line_with("relaying everything at Full")
    none = robot.testudo_run("--ros-args", "-r", "__node:=other")
    assert "no rules are given; name a rule file with --rules" in none.line_with(
        "relaying everything at Full"
    )


def rules_told(robot: SmallRobot, *, with_problem: bool) -> dict[str, Any]:
    nodes = robot.nodes_told(lambda told: ("problem" in told["/smarttestudo"]["rules"]) == with_problem)
    rules: dict[str, Any] = nodes["/smarttestudo"]["rules"]
    return rules


def test_files_that_became_bad_are_told_in_the_status_until_they_are_good(robot: SmallRobot) -> None:
    good = "begin SetFrequency /imu 10 end"
    runtime = robot.runtime(good)
    path = robot.folder / "rules0.adirf"
    runtime.line_with("/imu: 10 Hz (default)")
    rules_told(robot, with_problem=False)
    replace_text(path, "begin bad end")
    runtime.line_with(STAY)
    told = rules_told(robot, with_problem=True)
    assert (told["sha256"], told["origin"]) == (sha256(good), "files")
    assert str(told["problem"]).startswith(f"{path}:1:7: error: ")
    replace_text(path, good.replace("10", "20"))
    runtime.line_with("rules reloaded")
    rules_told(robot, with_problem=False)


def test_doubtful_rules_are_in_force_and_their_first_warning_is_logged(robot: SmallRobot) -> None:
    doubtful = "begin SetFrequency /imu 10 SetFrequency /imu 20 SetFrequency /imu 30 end"
    runtime = robot.runtime(doubtful)
    path = robot.folder / "rules0.adirf"
    assert (line := runtime.line_with("warning:")).endswith(
        "(the first of 2 warnings); testudo check shows all\n"
    ), line
    assert f"{path}:1:7: warning: " in line
    replace_text(path, doubtful.replace("30", "40"))
    runtime.line_with("warning:")
    remote = robot.remote()
    assert remote.ask("set", {"rules_text": doubtful}) == []
    assert "rules_text:1:7: warning: " in runtime.line_with("warning:")
