# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""An incident whose recording is not what its record says any more."""

from __future__ import annotations

import json
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from bags.bag_factory import BagContent, write_bag
from pacing.reckoning.ros_messages import ODOMETRY, odometry, planar
from replays.test_replay_bounds import recorded
from smarttestudo.cli.main import main

RULES = """begin
    SetFrequency /odom 2
    Rule "Far" If CheckValue /odom pose_x > 3 Then Record "far" Before 2 s After 2 s EndIf
end
"""


@pytest.fixture
def incident(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> Path:
    """One of 80 messages."""

    def drives(stamp_ns: int, t_s: float) -> bytes:
        return odometry(stamp_ns, planar(t_s, 0, 0))

    content = recorded("/odom", ODOMETRY, 20, 10, drives)
    messages = tuple(replace(one, stamp_ns=one.stamp_ns + 1_000_000) for one in content.messages)
    write_bag(tmp_path / "bag", BagContent(content.topics, messages))
    (tmp_path / "rules.adirf").write_text(RULES)
    command = ["replay", str(tmp_path / "bag"), "--rules", str(tmp_path / "rules.adirf")]
    folder = tmp_path / "incidents"
    assert main([*command, "--output", str(tmp_path / "out"), "--incidents", str(folder)]) == 0
    capsys.readouterr()
    (found,) = folder.iterdir()
    return found


def told_of(incident: Path, capsys: pytest.CaptureFixture[str]) -> str:
    assert main(["incidents", "show", str(incident.parent), incident.name]) == 0
    told = capsys.readouterr().err
    assert main(["incidents", "show", str(incident.parent), incident.name, "--json"]) == 0
    again = capsys.readouterr()
    assert again.err == told
    assert json.loads(again.out)["incident"] == incident.name
    copy = incident.parent.parent / "copy"
    assert main(["incidents", "export", str(incident.parent), incident.name, "--output", str(copy)]) == 0
    assert capsys.readouterr().err == told
    return told


def recording(incident: Path) -> Path:
    (file,) = incident.glob("*.mcap")
    return file


def test_of_a_whole_one_nothing_is_said(incident: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert told_of(incident, capsys) == ""


def test_one_that_was_cut_off_is_not_taken_for_whole(
    incident: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = recording(incident)
    file.write_bytes(file.read_bytes()[:5000])
    told = told_of(incident, capsys)
    assert "cut off or damaged" in told
    assert "/odom: the recording holds " in told


def test_an_altered_byte_is_noticed(incident: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = recording(incident)
    data = bytearray(file.read_bytes())
    data[len(data) // 4] ^= 1
    file.write_bytes(data)
    assert "damaged chunks: 1; " in told_of(incident, capsys)


def test_a_record_that_was_edited_is_not_what_its_recording_holds(
    incident: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = incident / "incident.json"
    record = json.loads(file.read_text())
    held = record["topics"]["/odom"]["messages"]
    record["topics"]["/odom"]["messages"] = 7
    file.write_text(json.dumps(record))
    told = told_of(incident, capsys)
    assert told == f"note: /odom: the recording holds {held} messages, the record says 7\n"


def test_a_recording_that_is_none_is_said(incident: Path, capsys: pytest.CaptureFixture[str]) -> None:
    recording(incident).unlink()
    assert "note: the recording cannot be read: " in told_of(incident, capsys)


def test_a_robot_without_the_packages_of_recordings_shows_it_all_the_same(
    incident: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("incident_content", "reader", "bag_files", "metadata"):
        monkeypatch.delitem(sys.modules, f"smarttestudo.bags.{name}", raising=False)
    monkeypatch.setitem(sys.modules, "ruamel.yaml", None)
    assert told_of(incident, capsys) == (
        "note: the recording was not compared with its record: reading it needs the package ruamel\n"
    )
